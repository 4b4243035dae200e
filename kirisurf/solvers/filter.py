"""The filter of a line search: pairs (violation, merit) that a new point must not be worse than."""

from __future__ import annotations


class Filter:
    """Accepts a point that improves violation or merit against every stored pair.

    After Waechter and Biegler, "On the implementation of an interior-point filter line-search algorithm
    for large-scale nonlinear programming" (2006), section 2.3.
    """

    gamma_violation = 1e-5
    gamma_merit = 1e-5

    def __init__(self, largest_violation: float) -> None:
        self._entries: list[tuple[float, float]] = []
        self._largest = largest_violation

    def accepts(self, violation: float, merit: float) -> bool:
        """Is the pair outside of the forbidden region?"""
        if not violation <= self._largest:
            return False
        return all(violation < v or merit < m for v, m in self._entries)

    def improves(self, violation: float, merit: float, old_violation: float, old_merit: float) -> bool:
        """Does the pair improve enough on the current point?"""
        return bool(
            violation <= (1 - self.gamma_violation) * old_violation
            or merit <= old_merit - self.gamma_merit * old_violation
        )

    def add(self, violation: float, merit: float) -> None:
        """Forbid what is not better than this pair."""
        pair = ((1 - self.gamma_violation) * violation, merit - self.gamma_merit * violation)
        self._entries = [e for e in self._entries if e[0] < pair[0] or e[1] < pair[1]] + [pair]

    def clear(self) -> None:
        """Forget everything, as after a change of the merit function."""
        self._entries.clear()
