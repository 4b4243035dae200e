"""Numerical outcomes: the value of a status is the sentence that the user reads."""

from __future__ import annotations

from enum import Enum


class Status(Enum):
    """How a solve ended."""

    CONVERGED = "Converged: every constraint holds, at a minimum of distance, unevenness and displacement together."
    INFEASIBLE = (
        "Locally infeasible: the constraints cannot all be met near the point that was reached. "
        "Try fewer or smaller tiles, a smaller part of the surface, or another opening (--opening)."
    )
    STALLED = (
        "Stalled: the steps became too small before the constraints were met. "
        "Try another number of tiles, another opening (--opening) or another start (--initial)."
    )
    STEP_LIMIT = (
        "Step limit reached before convergence. Allow more steps (--max-steps), or try another start (--initial)."
    )
    TIME_LIMIT = "Time limit reached before convergence. Allow more time (--max-seconds), or fewer tiles."
    INTERRUPTED = "Interrupted: the best point so far was kept."
    NOT_FINITE = "A number that is not finite appeared; the last finite point was kept. Check the target for spikes."
    NOT_CERTIFIED = (
        "The solver met its equations, but the finished sheet fails its certificate. "
        "Read the failing rows; try fewer tiles or another start (--initial)."
    )

    @property
    def exit_code(self) -> int:
        """Exit code of the command line for this outcome."""
        return {"CONVERGED": 0, "STEP_LIMIT": 6, "TIME_LIMIT": 6, "INTERRUPTED": 130}.get(self.name, 5)
