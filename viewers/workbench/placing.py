"""Placing: a pattern turned and sized by a hand; it is laid anew while the hand moves, and fitted when it lets go."""

from __future__ import annotations

import math

from kirisurf.spec import FitSpec
from viewers.workbench import options
from viewers.workbench.session import Session

NEAR = 20.0
"""Pixels from the middle within which a drag would size a pattern too wildly."""


class Placing:
    """What a hand that drags asks of a session.

    Parameters
    ----------
    session : Session
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._wanted: tuple[FitSpec, bool] | None = None

    def drag(self, degrees: float | int, ratio: float | int, ended: bool) -> str:
        """Turn and size the pattern of the state by a drag so far, and return in words what comes of it.

        Raises
        ------
        ParameterError
            Where that pattern cannot be.
        """
        wanted = options.resized(options.turned(self._session.state.spec, degrees), ratio)
        self._wanted = (wanted, ended)
        self.follow()
        if wanted.cells is not None:
            return f"{wanted.cells[0]} \u00d7 {wanted.cells[1]} unit cells"
        return f"{wanted.tiles} tiles, orientation {wanted.orientation}\N{DEGREE SIGN}"

    def follow(self) -> bool:
        """Ask for what the hand wants, where the engine is free for it; whether something was asked."""
        if self._wanted is None:
            return False
        spec, ended = self._wanted
        if ended:
            self._wanted = None
            self._session.do(self._session.state.with_spec(spec))
            if not self._session.state.is_live:
                self._session.preview(spec)
            return True
        if self._session.is_previewing:
            return False
        self._wanted = None
        self._session.preview(spec)
        return True

    @property
    def hint(self) -> str:
        """What a drag does to the pattern as it is."""
        if self._session.state.spec.cells is None:
            return "Drag on the right picture: round the middle turns the pattern, away from it makes larger tiles."
        return (
            "Drag on the right picture: away from the middle makes larger tiles "
            "(a layout trimmed to the outline can also be turned)."
        )


def turn_and_ratio(
    first: tuple[float, float], last: tuple[float, float], middle: tuple[float, float]
) -> tuple[float, float]:
    """Return the angle between two places about a middle (degrees, counter-clockwise) and the ratio of distances.

    Places are in pixels, from the upper left corner.

    Examples
    --------
    >>> turn_and_ratio((100.0, 0.0), (0.0, -200.0), (0.0, 0.0))
    (90.0, 2.0)
    """
    (ax, ay), (bx, by) = ((x - middle[0], middle[1] - y) for x, y in (first, last))
    angle = math.degrees(math.atan2(by, bx) - math.atan2(ay, ax))
    ratio = math.hypot(bx, by) / max(math.hypot(ax, ay), NEAR)
    return (angle + 180.0) % 360.0 - 180.0, max(ratio, 0.05)
