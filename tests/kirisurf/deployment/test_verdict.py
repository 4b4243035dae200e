"""The words of a verdict: what is not known of a barrier is not left out."""

from __future__ import annotations

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
    ],
)
def test_every_barrier_stands_at_its_place_or_is_said_to_be_unknown(known: tuple[int, ...], words: str) -> None:
    barriers = tuple(TOPS[k] for k in known)
    assert _rests(MINIMA, barriers) == f"it rests flat, open to 25 %, open to 50 %, open to 100 %, {words}"
    verdict = Verdict(Kind.MULTISTABLE, "", 0.0, MINIMA, barriers, 0.0, (), 0, False)
    assert verdict.barrier == (7e-4 if len(known) == 3 else None)
