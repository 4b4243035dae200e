"""What a reader hands over: vertices and polygons exactly as the file has them."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float

from kirisurf.arrays import frozen
from kirisurf.errors import UnreadableError
from kirisurf.loops import Loops

_NOT_FINITE = re.compile(rb"^[-+]?1\.#(IND|INF|QNAN|SNAN)\d*$")


@dataclass(frozen=True, eq=False)
class Polygons:
    """Vertices and polygons of a file, neither welded nor triangulated.

    Attributes
    ----------
    vertices : (n, 3) float64
    loops : Loops
        Indices are within range; nothing else is promised.
    notes : tuple of str
        Sentences on what the reader left out.
    """

    vertices: Float[np.ndarray, "n 3"]
    loops: Loops
    notes: tuple[str, ...] = field(default=())


def polygons(
    vertices: np.ndarray, sizes: np.ndarray, indices: np.ndarray, name: str, notes: Iterable[str] = ()
) -> Polygons:
    """Build from the size of every polygon and the indices of all, refusing indices out of range.

    Raises
    ------
    UnreadableError
        Where an index names no vertex: the file is damaged.
    """
    indices = np.asarray(indices, dtype=np.int64)
    n = len(vertices)
    if indices.size and (indices.min() < 0 or indices.max() >= n):
        wrong = int(indices.min()) if indices.min() < 0 else int(indices.max())
        raise UnreadableError(
            f"{name}: expected faces of the {n} vertices in the file (0 to {n - 1}), got vertex {wrong}: it is damaged"
        )
    offsets = np.concatenate([[0], np.cumsum(np.asarray(sizes, dtype=np.int64))])
    return Polygons(frozen(vertices), Loops(frozen(offsets, np.int64), frozen(indices, np.int64)), tuple(notes))


def floats(tokens: Sequence[bytes], name: str, what: str) -> np.ndarray:
    """Convert text tokens to doubles, correctly rounded; (s,) float64.

    Raises
    ------
    UnreadableError
        Where a token is not a number, with a hint at decimal commas.
    """
    _refuse_underscores(tokens, name, f"numbers for {what}")
    try:
        return np.array(list(map(float, tokens)), dtype=np.float64)
    except ValueError:
        if any(b"#" in token for token in tokens):  # how old Microsoft runtimes print what is not finite
            return floats([_NOT_FINITE.sub(b"nan", token).replace(b"#", b"?") for token in tokens], name, what)
        raise UnreadableError(f"{name}: expected numbers for {what}, got {_first_bad(tokens, float)}") from None


def integers(tokens: Sequence[bytes], name: str, what: str) -> np.ndarray:
    """Convert text tokens to integers; (s,) int64. Raises UnreadableError as :func:`floats` does."""
    _refuse_underscores(tokens, name, f"whole numbers for {what}")
    try:
        return np.array(list(map(int, tokens)), dtype=np.int64)
    except (ValueError, OverflowError):
        raise UnreadableError(f"{name}: expected whole numbers for {what}, got {_first_bad(tokens, int)}") from None


def _refuse_underscores(tokens: Sequence[bytes], name: str, expected: str) -> None:
    """Python reads 1_000 as a thousand; in a file it is a slip, and no other program would read it so."""
    if b"_" in b" ".join(tokens):
        wrong = next(token for token in tokens if b"_" in token)
        raise UnreadableError(f"{name}: expected {expected}, got {shown(wrong)}")


def _first_bad(tokens: Sequence[bytes], kind: type) -> str:
    for token in tokens:
        try:
            if abs(kind(token)) > 2**62 and kind is int:
                return shown(token)
        except ValueError:
            hint = " (decimal comma? write 0.5, not 0,5)" if b"," in token else ""
            return shown(token) + hint
    return "something else"


def counted(n: int, one: str, many: str) -> str:
    """Return a number with the words that fit it."""
    return f"{n} {one if n == 1 else many}"


def shown(token: bytes) -> str:
    """Return a short, printable form of bytes from a file, for messages."""
    text = ascii(token[:40].decode("latin-1"))
    return text + (" ..." if len(token) > 40 else "")
