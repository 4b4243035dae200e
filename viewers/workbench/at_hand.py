"""What an engine has at hand between two jobs: the results of the stages that a change leaves as they are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kirisurf.fit_result import FitResult
from kirisurf.ground import Ground
from kirisurf.refit import Begun, can_refit
from kirisurf.spec import FitSpec
from kirisurf.surface import Surface


@dataclass(frozen=True, eq=False)
class AtHand:
    """What was computed last, stage by stage; None from where nothing was."""

    spec: FitSpec
    ground: Ground
    origin: np.ndarray
    notes: tuple[str, ...]
    begun: Begun | None = None
    result: FitResult | None = None
    before: FitResult | None = None
    """A fit by other options, which the solver may go on from."""

    @property
    def surface(self) -> Surface:
        """The target."""
        return self.ground.surface

    @property
    def can_refit(self) -> bool:
        """Whether a fit can go on from another one, and be watched."""
        return self.begun is not None and can_refit(self.surface, self.spec, self.begun.start)
