"""The vertices of the tiles round every hole."""

from __future__ import annotations

import numpy as np

from kirisurf.loops import Loops
from kirisurf.tessellation import Tessellation


def surrounding_vertices(tessellation: Tessellation) -> Loops:
    """Return the vertices of the tiles round every hole, each once (12 round a quad hole).

    Examples
    --------
    >>> from kirisurf.pattern import quad_pattern
    >>> surrounding_vertices(quad_pattern(2, 2)).sizes.tolist()
    [12, 12, 12, 12, 12, 12, 12, 12, 12]
    """
    tiles, ring = tessellation.tiles, tessellation.hole_tiles
    sizes = tiles.sizes[ring.indices]
    hole = np.repeat(ring.owners, sizes)
    local = np.arange(len(hole)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    vertex = tiles.indices[np.repeat(tiles.offsets[ring.indices], sizes) + local]
    key = np.unique(hole * tessellation.n_vertices + vertex)
    hole, vertex = np.divmod(key, max(tessellation.n_vertices, 1))
    counts = np.bincount(hole, minlength=len(ring))
    return Loops(np.r_[0, np.cumsum(counts)].astype(np.int64), vertex.astype(np.int64))
