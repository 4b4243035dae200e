"""Undo and redo, as a value: what was, what is, and what was undone."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Generic, TypeVar

T = TypeVar("T")
MOST = 200
"""States that are kept."""


@dataclass(frozen=True)
class History(Generic[T]):
    """States in the order of the user's work.

    Attributes
    ----------
    present : T
    past, future : tuple of T
        The last of `past` is what an undo brings back; the first of `future` what a redo does.

    Examples
    --------
    >>> history = History("a").did("b").did("c").undone()
    >>> history.present, history.redone().present, history.did("d").future
    ('b', 'c', ())
    """

    present: T
    past: tuple[T, ...] = ()
    future: tuple[T, ...] = ()

    def did(self, state: T) -> History[T]:
        """Return the history after one more deed; the same state again is none."""
        if state == self.present:
            return self
        return History(state, (*self.past, self.present)[-MOST:])

    def adjusted(self, state: T) -> History[T]:
        """Return the history with another present that is no deed of its own: a camera, a slider on its way."""
        return replace(self, present=state)

    def undone(self) -> History[T]:
        """Return the history one deed back; itself where there is none."""
        if not self.past:
            return self
        return History(self.past[-1], self.past[:-1], (self.present, *self.future))

    def redone(self) -> History[T]:
        """Return the history with the last undone deed done again; itself where there is none."""
        if not self.future:
            return self
        return History(self.future[0], (*self.past, self.present), self.future[1:])
