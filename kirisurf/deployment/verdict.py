"""The verdict: what a sheet does between flat and deployed, in one sentence with its numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from itertools import pairwise

import numpy as np

from kirisurf.deployment.branch import Branch
from kirisurf.deployment.energy import Energy
from kirisurf.deployment.guide import Guide
from kirisurf.deployment.kinematics import is_rigid, most_strained
from kirisurf.deployment.loading import mean_opening
from kirisurf.deployment.minimum import Minimum
from kirisurf.deployment.path import STRAINLESS, Path, PathStatus, ShouldStop
from kirisurf.deployment.stability import Barrier, find_barriers, find_minima

ADMISSIBLE = 0.25
"""Largest strain of a rod on the way, above which a sheet is said to need strain, whatever it does afterwards."""

AT_SHAPE = 0.995
"""Part of its opening from which on the end of a path is the shape."""

_UNKNOWN = "unknown height"
MOST_NAMED = 5
"""Most states of rest that a sentence names one by one."""

OPEN = 0.5
"""Part of its opening from which on a state in which a sheet rests counts as open."""


class Kind(Enum):
    """What a sheet does, in the words of the verdict."""

    FREE = "deploys freely"
    BISTABLE = "snaps over a barrier and stays"
    MULTISTABLE = "rests in several states"
    SPRINGS_BACK = "springs back"
    STRAINED = "needs strain"
    UNKNOWN = "was not followed to the end"


@dataclass(frozen=True, eq=False)
class Verdict:
    """What a sheet does for one lambda.

    Attributes
    ----------
    kind : Kind
    sentence : str
    torsion : float
    minima : tuple of Minimum
        States in which it rests, by growing opening.
    barriers : tuple of Barrier
        Between neighbors among them.
    largest_strain : float
        On the way.
    strained_tiles : tuple of int
        Those strained most, worst first.
    n_mechanisms : int
        Of the deployed sheet.
    rigid : bool
        Rigid tiles lead from flat to deployed.
    """

    kind: Kind
    sentence: str
    torsion: float
    minima: tuple[Minimum, ...]
    barriers: tuple[Barrier, ...]
    largest_strain: float
    strained_tiles: tuple[int, ...]
    n_mechanisms: int
    rigid: bool

    @property
    def barrier(self) -> float | None:
        """Highest barrier from flat to the most open state; None where there is no such state, or not all are known."""
        heights = [b.energy for b in self.barriers]
        return max(heights) - self.minima[0].energy if 0 < len(heights) == len(self.minima) - 1 else None


def judge(
    energy: Energy,
    guide: Guide,
    path: Path,
    still: Path,
    mechanisms: int,
    admissible: float = ADMISSIBLE,
    should_stop: ShouldStop | None = None,
    branches: Sequence[Branch] = (),
) -> Verdict:
    """Return the verdict on a path.

    Parameters
    ----------
    energy : Energy
        That of the path.
    guide : Guide
    path : Path
    still : Path
        The free path without torsion, on which rigid tiles are seen as such.
    mechanisms : int
        Of the deployed sheet.
    admissible : float
        Strain up to which tiles may be strained on the way.
    should_stop : callable, optional
        True ends the search for states in which the sheet rests.
    branches : sequence of Branch
        At the jumps of the path.
    """
    strain, tiles = most_strained(path)
    rigid = is_rigid(still) and still.status is PathStatus.COMPLETE
    if path.status is PathStatus.INTERRUPTED:
        sentence = f"Was not followed to the end: {len(path.fractions)} states were found."
        return Verdict(Kind.UNKNOWN, sentence, energy.torsion, (), (), strain, tiles, mechanisms, rigid)
    # without torsion a sheet of rigid tiles rests wherever it is left, whatever a drive does to it
    along = still if energy.torsion == 0 and rigid else path
    minima = find_minima(energy, guide, along, should_stop, branches)
    if should_stop is not None and should_stop():
        return _cut_short(energy, "states of rest", strain, tiles, mechanisms, rigid)
    barriers = find_barriers(energy, guide, along, minima, branches, should_stop)
    if should_stop is not None and should_stop():
        return _cut_short(energy, "barriers", strain, tiles, mechanisms, rigid)
    kind = _kind(energy, minima, strain, admissible, rigid)
    held = _held(energy, guide, path)
    sentence = _sentence(kind, path, still, minima, barriers, strain, tiles, mechanisms, rigid, admissible, held)
    return Verdict(kind, sentence, energy.torsion, minima, barriers, strain, tiles, mechanisms, rigid)


def _cut_short(energy: Energy, sought: str, strain: float, tiles: tuple[int, ...], n: int, rigid: bool) -> Verdict:
    sentence = f"Was followed to the end, and stopped while {sought} were sought."
    return Verdict(Kind.UNKNOWN, sentence, energy.torsion, (), (), strain, tiles, n, rigid)


def _kind(energy: Energy, minima: tuple[Minimum, ...], strain: float, admissible: float, rigid: bool) -> Kind:
    if strain > admissible:
        return Kind.STRAINED
    if energy.torsion == 0 and rigid:
        return Kind.FREE
    if len(minima) > 2:
        return Kind.MULTISTABLE
    return Kind.BISTABLE if any(m.fraction >= OPEN for m in minima) else Kind.SPRINGS_BACK


def _sentence(
    kind: Kind,
    path: Path,
    still: Path,
    minima: tuple[Minimum, ...],
    barriers: tuple[Barrier, ...],
    strain: float,
    tiles: tuple[int, ...],
    mechanisms: int,
    rigid: bool,
    admissible: float,
    held: str,
) -> str:
    named = f"{'tile' if len(tiles) == 1 else 'tiles'} {', '.join(map(str, tiles))}"
    on_way = f"on the way tiles strain by up to {_percent(strain)}, most in {named}"
    if kind is Kind.FREE:
        steps = f"at most {still.moves.max(initial=0.0):.2g} tile edges apart"
        ways = "1 mechanism" if mechanisms == 1 else f"{mechanisms} mechanisms"
        text = (
            f"Deploys freely: rigid tiles lead from flat to shape in {len(still.fractions)} states {steps}, "
            f"none strained by more than {still.largest_strains.max():.0e}; the deployed sheet has {ways}."
        )
        if path.stretch_energies.max() > STRAINLESS:
            text += f" Moved as it is here it does not go that way: {on_way}."
    elif kind is Kind.STRAINED:
        over = f"more than the admissible {_percent(admissible)}"
        text = f"Needs {_percent(strain)} strain in {named}, {over}; {_rests(minima, barriers)}."
    elif kind is Kind.SPRINGS_BACK:
        way = "rigid tiles lead to the shape without strain" if rigid else on_way
        rest = (
            f"let go at the shape it closes; {_rests(minima, barriers)}"
            if len(minima) > 1
            else "let go anywhere it closes"
        )
        text = f"Springs back: {rest}; {held}, and {way}."
    elif kind is Kind.BISTABLE:
        top, last = barriers[-1] if barriers else None, minima[-1]
        bound = "" if top is None or top.is_saddle else "at most " if path.status is PathStatus.COMPLETE else "about "
        over = f"a barrier of {bound}{top.opening:.2g}" if top else "a barrier that this way does not show"
        back = f", and closes over one of {top.closing:.2g}" if top else ""
        text = f"Snaps over {over} and stays, open to {_percent(last.fraction)} of the shape{back}; {on_way}."
    else:
        text = f"Rests in several states: {_rests(minima, barriers)}; {on_way}."
    if path.status in (PathStatus.UNBALANCED, PathStatus.JUMPED):
        text += f" {path.status.value}"
    return text


def _held(energy: Energy, guide: Guide, path: Path) -> str:
    """What it takes to hold the sheet at the end of the path, and at the shape."""
    share = mean_opening(energy, path.points[-1]) / mean_opening(energy, guide.deployed)
    at_end, at_shape = f"{path.energies[-1]:.2g}", f"{energy.value(guide.deployed):.2g}"
    if share > AT_SHAPE:
        return f"held at the shape it stores an energy of {at_end}"
    return f"held open to {_percent(share)} it stores an energy of {at_end}, at the shape itself {at_shape}"


def _rests(minima: tuple[Minimum, ...], barriers: tuple[Barrier, ...]) -> str:
    if len(minima) > MOST_NAMED:
        low, high = minima[1], minima[-1]
        most = f"of up to {max(b.opening for b in barriers):.2g}" if barriers else "of unknown height"
        rest = ", as far as they are known" if 0 < len(barriers) < len(minima) - 1 else ""
        return (
            f"it rests flat and in {len(minima) - 1} more states, open to between {_percent(low.fraction)} and "
            f"{_percent(high.fraction)}, behind barriers {most}{rest}"
        )
    at = ", ".join("flat" if m.is_flat else f"open to {_percent(m.fraction)}" for m in minima)
    known = {b.below: f"{'' if b.is_saddle else 'about '}{b.opening:.2g}" for b in barriers}
    tops = [known.get(k) or _at_least(*pair) for k, pair in enumerate(pairwise(minima))]
    if all(top == _UNKNOWN for top in tops):
        return f"it rests {at}"
    kinds = "a barrier" if len(tops) == 1 else "barriers"
    return f"it rests {at}, behind {kinds} of {', '.join(tops)}"


def _at_least(closed: Minimum, opened: Minimum) -> str:
    """What is known of a barrier whose top is not: it is no lower than where it leads."""
    rise = opened.energy - closed.energy
    return f"more than {rise:.2g}" if rise > STRAINLESS else _UNKNOWN


def _percent(part: float) -> str:
    digits = 0 if part >= 0.1 else int(np.clip(1 - np.floor(np.log10(max(part, 1e-12) * 100)), 0, 6))
    return f"{100 * part:.{digits}f} %"
