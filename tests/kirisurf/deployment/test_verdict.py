"""The words of a verdict: what is not known of a barrier is not left out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kirisurf.deployment.stability import Barrier, Minimum
from kirisurf.deployment.verdict import Kind, Verdict, _rests


def rest(fraction: float, energy: float) -> Minimum:
    return Minimum(np.zeros((1, 2)), energy, fraction, fraction, 0.0, fraction == 0)


MINIMA = (rest(0.0, 0.0), rest(0.25, 3e-4), rest(0.5, 2e-4), rest(1.0, 1e-4))
TOPS = tuple(Barrier(k, top, 0.0, top - MINIMA[k + 1].energy, top - MINIMA[k].energy, True)
             for k, top in enumerate((5e-4, 4e-4, 7e-4)))  # fmt: skip


@pytest.mark.parametrize(
    ("known", "words"),
    [
        ((0, 1, 2), "behind barriers of 0.0005, 0.0001, 0.0005"),
        ((1, 2), "behind barriers of more than 0.0003, 0.0001, 0.0005"),
        ((0, 2), "behind barriers of 0.0005, unknown height, 0.0005"),
        ((0,), "behind barriers of 0.0005, unknown height, unknown height"),
        ((), "behind barriers of more than 0.0003, unknown height, unknown height"),
    ],
)
def test_every_barrier_stands_at_its_place_or_is_said_to_be_unknown(known: tuple[int, ...], words: str) -> None:
    barriers = tuple(TOPS[k] for k in known)
    assert _rests(MINIMA, barriers) == f"it rests flat, open to 25 %, open to 50 %, open to 100 %, {words}"
    verdict = Verdict(Kind.MULTISTABLE, "", 0.0, MINIMA, barriers, 0.0, (), 0, False)
    assert verdict.barrier == (7e-4 if len(known) == 3 else None)


def test_a_barrier_that_is_no_saddle_is_about_as_high() -> None:
    barriers = (TOPS[0], replace(TOPS[1], is_saddle=False), TOPS[2])
    assert _rests(MINIMA, barriers).endswith("behind barriers of 0.0005, about 0.0001, 0.0005")


def test_of_many_barriers_the_highest_that_is_known_is_named() -> None:
    many = tuple(rest(k / 6, 1e-4 * (k % 2)) for k in range(7))
    tops = tuple(replace(TOPS[0], below=k, opening=1e-4 * (k + 1)) for k in range(6))
    assert _rests(many, tops).endswith("behind barriers of up to 0.0006")
    assert _rests(many, tops[:2]).endswith("behind barriers of up to 0.0002, as far as they are known")
    assert _rests(many, ()).endswith("behind barriers of unknown height")


def test_states_that_nothing_is_known_between_are_listed_alone() -> None:
    level = (rest(0.0, 0.0), rest(1.0, 0.0))
    assert _rests(level, ()) == "it rests flat, open to 100 %"
