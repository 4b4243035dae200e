"""The state of a workbench: what its user chose. Frozen; every deed is a function from a state to the next."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from kirisurf.errors import ParameterError
from kirisurf.spec import FitSpec
from viewers.workbench import options
from viewers.workbench.pipeline import STAGES, Stage

Coloring = tuple[str, str]
"""(vertex, tile or hole; name of the field)."""

FIRST_SHOWN = frozenset({Stage.TARGET, Stage.FIT, Stage.CONTRACTED, Stage.HOLES})


@dataclass(frozen=True)
class Selection:
    """A picked tile or hole.

    Attributes
    ----------
    kind : str
        tile or hole.
    number : int
    """

    kind: str
    number: int

    def __post_init__(self) -> None:
        if self.kind not in ("tile", "hole") or self.number < 0:
            raise ParameterError(f"selection: expected a tile or a hole by number, got {self.kind} {self.number}")


@dataclass(frozen=True)
class State:
    """What the user of a workbench chose.

    Attributes
    ----------
    spec : FitSpec
        Options of the fit.
    shown : frozenset of Stage
    coloring : (str, str) or None
        Field that colors the sheet; None for plain tiles.
    selection : Selection or None
    share : float
        Deployment: 0 contracted, 1 deployed.
    is_linked : bool
        Whether the two views turn together.
    is_live : bool
        Whether a changed option starts a fit at once.
    """

    spec: FitSpec
    shown: frozenset[Stage] = FIRST_SHOWN
    coloring: Coloring | None = ("hole", "gaussian_curvature")
    selection: Selection | None = None
    share: float = 1.0
    is_linked: bool = True
    is_live: bool = True

    def with_option(self, name: str, value: Any) -> State:
        """Return a state with one option of the fit changed; raises as :func:`options.changed`."""
        return self.with_spec(options.changed(self.spec, name, value))

    def with_spec(self, spec: FitSpec) -> State:
        """Return a state with other options; what was picked on another pattern is picked no more."""
        same = all(getattr(spec, name) == getattr(self.spec, name) for name in ("target", "tessellation", "cells"))
        kept = self.selection if same and spec.tiles == self.spec.tiles else None
        return replace(self, spec=spec, selection=kept)

    def toggled(self, stage: Stage) -> State:
        """Return a state with a stage hidden that was shown, or shown that was hidden."""
        return replace(self, shown=self.shown ^ {stage})

    def colored(self, coloring: Coloring | None) -> State:
        """Return a state colored by a field, or plain; holes that are to be seen are shown."""
        shown = self.shown | {Stage.HOLES} if coloring is not None and coloring[0] == "hole" else self.shown
        return replace(self, coloring=coloring, shown=shown)

    def picked(self, selection: Selection | None) -> State:
        """Return a state with a tile or hole picked; picking it again lets it go."""
        return replace(self, selection=None if selection == self.selection else selection)

    def deployed_to(self, share: float) -> State:
        """Return a state at a share of the way from contracted (0) to deployed (1)."""
        return replace(self, share=min(max(float(share), 0.0), 1.0))

    def linked(self, together: bool) -> State:
        """Return a state whose views turn together, or each by itself."""
        return replace(self, is_linked=together)

    def live(self, at_once: bool) -> State:
        """Return a state in which changed options start a fit at once, or wait to be asked."""
        return replace(self, is_live=at_once)


def all_shown(state: State) -> State:
    """Return a state with every stage shown."""
    return replace(state, shown=frozenset(STAGES))
