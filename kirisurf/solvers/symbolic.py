"""What the pattern of a sparse matrix alone decides about its factorization."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from kirisurf.solvers.dense_front import tile_marks
from kirisurf.solvers.elimination_tree import Fronts, find_fronts
from kirisurf.solvers.team import n_cores

_WIDTH = 3  # unknowns of a vertex
_SHARED_FLOPS = 2e8  # a smaller factorization takes a few milliseconds, less than other threads are worth
_N_SUBTREES = 8  # at least so many, so that two cores end at about the same time
_MOST_WORKERS = 2  # more are untried

# One addition of a child's update: tile, columns and rows of the target, then of the source; ranges are (begin, end).
Addition = tuple[int, int, int, int, int, int, int, int, int, int]


class Symbolic:
    """What the pattern alone decides: order, fronts, and where every number goes. Made once per pattern.

    It lends its workspace to the factorizations, one at a time: not for threads that factor at once.

    Parameters
    ----------
    n : int
        Number of vertices; the matrix is (3n, 3n), and vertex v has the unknowns 3v, 3v + 1, 3v + 2.
    rows, columns : (nb,) int
        Vertex pair of every block, each pair once, in whichever order.

    Attributes
    ----------
    n_fronts : int
    n_nonzeros : int
        Entries of the lower factor, with the zeros that the fronts store.
    n_flops : float
        Multiplications and additions of a factorization.
    factor_bytes : int
        What a `Cholesky` holds.
    stack_bytes : int
        What the update matrices take during a factorization.
    order : (3n,) int
        Unknown at each position of the elimination order.
    starts : list of int
        Front i has the pivots from starts[i] up to starts[i + 1].
    rows : list of (m_i,) int
        Positions below the pivots of a front that it updates.
    subtrees : list of (first, last)
        Ranges of fronts that can be eliminated side by side.
    top : list of int
        The fronts above them.
    """

    def __init__(self, n: int, rows: np.ndarray, columns: np.ndarray) -> None:
        rows, columns = np.asarray(rows, dtype=np.int64), np.asarray(columns, dtype=np.int64)
        fronts = find_fronts(n, np.concatenate([rows, columns]), np.concatenate([columns, rows]))
        self.order = (_WIDTH * fronts.order[:, None] + np.arange(_WIDTH)).ravel()
        self.starts = (_WIDTH * fronts.starts).tolist()
        self.rows = [(_WIDTH * r[:, None] + np.arange(_WIDTH)).ravel() for r in fronts.rows]
        self.n_fronts = len(self.rows)
        k, m = np.diff(self.starts), np.array([len(r) for r in self.rows], dtype=np.int64)
        self.pivot_sizes: list[int] = k.tolist()
        self.row_sizes: list[int] = m.tolist()
        self._offsets: list[int] = np.concatenate([[0], np.cumsum(k * (k + m))]).tolist()
        self.n_nonzeros = int((k * (k + 1) // 2 + k * m).sum())
        flops = k**3 / 3.0 + k * k * m + k * m * m
        self.n_flops = float(flops.sum())
        self.factor_bytes = 8 * self._offsets[-1]
        self.marks = [tile_marks(size) for size in self.row_sizes]
        self._connect(fronts)
        self._place_entries(fronts, rows, columns)
        self._share(fronts.parents, flops)
        self._place_updates()
        self._spare: list[np.ndarray] = []

    def _connect(self, fronts: Fronts) -> None:
        self.children: list[list[int]] = [[] for _ in range(self.n_fronts)]
        self.panel_additions: list[list[Addition]] = [[] for _ in range(self.n_fronts)]
        self.update_additions: list[list[Addition]] = [[] for _ in range(self.n_fronts)]
        for i, parent in enumerate(fronts.parents.tolist()):
            if parent >= 0:
                self.children[parent].append(i)
                first, last = fronts.starts[parent : parent + 2].tolist()
                additions = _additions(
                    fronts.rows[i], first, last, fronts.rows[parent], self.marks[i], self.marks[parent]
                )
                self.panel_additions[i], self.update_additions[i] = additions

    def _place_entries(self, fronts: Fronts, rows: np.ndarray, columns: np.ndarray) -> None:
        """Find the place in the panels of every entry of the lower half of the permuted matrix."""
        n, starts = len(fronts.order), fronts.starts
        position = np.argsort(fronts.order)
        row, column = position[rows], position[columns]
        turned = row < column
        row, column = np.maximum(row, column), np.minimum(row, column)
        front = np.searchsorted(starts, column, side="right") - 1
        chosen = np.argsort(2 * front + turned, kind="stable")
        row, column, front, turned = (a[chosen] for a in (row, column, front, turned))
        # One sorted key over all fronts finds the place of a row in the list of its front.
        lengths = np.array([len(r) for r in fronts.rows], dtype=np.int64)
        owner = np.repeat(np.arange(self.n_fronts), lengths)
        keys = owner * n + np.concatenate([*fronts.rows, np.zeros(0, dtype=np.int64)])
        place = np.searchsorted(keys, front * n + row) - (np.cumsum(lengths) - lengths)[front]
        n_pivots = np.diff(starts)
        local = row - starts[front]
        local = np.where(local < n_pivots[front], local, n_pivots[front] + place)
        height = _WIDTH * (n_pivots + lengths)[front]
        # int32: a panel of so many numbers would take 16 GB
        self._corners = (_WIDTH * ((column - starts[front]) * height + local)).astype(np.int32)
        self._chosen = chosen.astype(np.int32)
        # of each front the blocks as they are, then those to be transposed
        self._entries: list[int] = np.searchsorted(2 * front + turned, np.arange(2 * self.n_fronts + 1)).tolist()

    def _share(self, parents: np.ndarray, flops: np.ndarray) -> None:
        """Choose the subtrees that are eliminated side by side, the largest first, and the fronts above them."""
        total, first = flops.copy(), np.arange(self.n_fronts)
        for i, parent in enumerate(parents.tolist()):
            if parent >= 0:
                total[parent] += total[i]
                first[parent] = min(first[parent], first[i])
        subtrees = np.flatnonzero(parents < 0).tolist() if self.n_flops > _SHARED_FLOPS else []
        while subtrees:
            largest = max(subtrees, key=lambda i: total[i])
            if total[largest] * _N_SUBTREES <= self.n_flops:
                break
            subtrees.remove(largest)
            subtrees += self.children[largest]
        subtrees.sort(key=lambda i: (-total[i], i))
        self.subtrees: list[tuple[int, int]] = [(int(first[i]), i) for i in subtrees]
        inside = np.zeros(self.n_fronts, dtype=bool)
        for begin, end in self.subtrees:
            inside[begin : end + 1] = True
        self.top: list[int] = np.flatnonzero(~inside).tolist()
        self.n_workers = min(_MOST_WORKERS, n_cores()) if self.subtrees else 1

    def _place_updates(self) -> None:
        sizes = [_n_stored(marks) for marks in self.marks]
        self.update_offsets = [0] * self.n_fronts
        lane = 0
        for first, last in self.subtrees:
            lane = max(lane, self._first_fit(range(first, last), sizes))
        # Nobody knows which subtree ends first: all of them leave their last update to the fronts above.
        end = self._first_fit([*sorted(last for _, last in self.subtrees), *self.top], sizes)
        # Kept from one factorization to the next: fresh memory would be cleared by the system page by page.
        self.stack = np.empty(end)
        self.lanes = [np.empty(lane) for _ in range(self.n_workers)]
        self.stack_bytes = self.stack.nbytes + sum(a.nbytes for a in self.lanes)

    def _first_fit(self, fronts: list[int] | range, sizes: list[int]) -> int:
        """Give each update an offset, such that those that live at the same time are apart; return their end."""
        live: list[tuple[int, int, int]] = []  # sorted (start, end, front)
        most = 0
        for i in fronts:
            start = 0
            for begin, end, _ in live:
                if begin - start >= sizes[i]:
                    break
                start = max(start, end)
            self.update_offsets[i] = start
            most = max(most, start + sizes[i])
            live = sorted(
                [entry for entry in live if entry[2] not in self.children[i]] + [(start, start + sizes[i], i)]
            )
        return most

    def lend(self) -> np.ndarray:
        """Return storage for a factor; that of an earlier one costs no clearing of pages."""
        return self._spare.pop() if self._spare else np.empty(self._offsets[-1])

    def take_back(self, storage: np.ndarray) -> None:
        """Keep the storage of a factor that is no longer wanted."""
        self._spare = [storage]

    def panels(self, storage: np.ndarray) -> list[np.ndarray]:
        """Cut the storage of a factor into the fronts' columns, (k + m, k) each, Fortran-ordered."""
        shapes = zip(self._offsets, self.pivot_sizes, self.row_sizes, strict=False)
        return [storage[offset : offset + k * (k + m)].reshape(k, k + m).T for offset, k, m in shapes]

    def fill(self, i: int, panel: np.ndarray, blocks: np.ndarray) -> None:
        """Write the entries of the matrix that belong to front i, and zeros elsewhere."""
        flat = panel.T.reshape(-1)
        flat.fill(0.0)
        step = np.arange(_WIDTH)
        # (row, column) of a block at [..., row, column], as the data of the blocks has it
        offsets = step[:, None] + step * len(panel)
        for j, places in ((2 * i, offsets), (2 * i + 1, offsets.T)):
            begin, end = self._entries[j : j + 2]
            flat[self._corners[begin:end, None, None] + places] = blocks[self._chosen[begin:end]]


def _n_stored(marks: list[int]) -> int:
    return sum((marks[-1] - first) * (last - first) for first, last in pairwise(marks))


def _additions(
    rows: np.ndarray, first: int, last: int, above: np.ndarray, marks: list[int], marks_above: list[int]
) -> tuple[list[Addition], list[Addition]]:
    """Split the lower half of an update into rectangles that are contiguous in the front above.

    Returns
    -------
    tuple of list
        Additions into the panel and into the update matrix of the front above.
    """
    n_inside = int(np.searchsorted(rows, last))
    inside, outside = rows[:n_inside] - first, np.searchsorted(above, rows[n_inside:])
    place = np.concatenate([inside, outside])
    breaks = np.diff(place, prepend=-2) != 1
    # A rectangle lies in one tile here and in one there.
    breaks[np.asarray(marks[:-1]) // _WIDTH] = True
    cuts = n_inside + np.searchsorted(outside, np.asarray(marks_above[:-1]) // _WIDTH)
    breaks[cuts[cuts < len(rows)]] = True
    begins = np.flatnonzero(breaks)
    ends = np.append(begins[1:], len(rows))
    runs = np.stack([place[begins], place[begins] + ends - begins, begins, ends], axis=1) * _WIDTH
    source = np.searchsorted(marks, runs[:, 2], side="right") - 1
    n_runs = int(np.searchsorted(begins, n_inside))
    in_update = runs[n_runs:]
    target = np.searchsorted(marks_above, in_update[:, 0], side="right") - 1
    in_panel = runs.copy()
    in_panel[n_runs:, :2] += _WIDTH * (last - first)
    panel = _rectangles(in_panel, n_runs, [0] * n_runs, [0], source.tolist(), marks)
    update = _rectangles(in_update, len(in_update), target.tolist(), marks_above, source[n_runs:].tolist(), marks)
    return panel, update


def _rectangles(
    runs: np.ndarray, n: int, targets: list[int], target_marks: list[int], sources: list[int], source_marks: list[int]
) -> list[Addition]:
    """Pair the first n runs, as columns, with all that follow, as rows."""
    found: list[Addition] = []
    numbers = runs.tolist()
    for j, t, u in zip(range(n), targets, sources, strict=False):
        a, b = target_marks[t], source_marks[u]
        c0, c1, d0, d1 = numbers[j]
        # rows count from the first column of a tile, as its own do
        found += [
            (t, c0 - a, c1 - a, r0 - a, r1 - a, u, d0 - b, d1 - b, s0 - b, s1 - b) for r0, r1, s0, s1 in numbers[j:]
        ]
    return found
