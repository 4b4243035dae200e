"""The topology of a target surface, in numbers and in words, and the condition that it is a disk.

A kirigami sheet is one flat piece without designed holes: it can cover a surface that is one piece
with one boundary loop and no handles (a disk), and no other without a cut.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Bool, Int

from kirisurf.arrays import frozen
from kirisurf.connectivity import (
    Edges,
    aspects,
    boundary_loop_sizes,
    crack_vertices,
    fans_per_vertex,
    orientation,
    pieces_of_faces,
)
from kirisurf.errors import UnusableError
from kirisurf.gate import check_indices, flat_faces
from kirisurf.surface import Surface

SLIVER_ASPECT = 1e4
"""Longest side over height from which a face is called a sliver."""

_FEW = 5


@dataclass(frozen=True, eq=False)
class TopologyReport:
    """What a surface is, counted.

    Attributes
    ----------
    name : str
    n_vertices, n_faces : int
        Isolated vertices are counted.
    component_sizes : tuple of int
        Faces of every connected piece (joined by edges or single vertices), largest first.
    boundary_sizes : tuple of int
        Edges of every boundary loop, most first; meaningful where the surface is manifold.
    euler_characteristic : int
        Vertices in use - edges + faces.
    genus : int or None
        Number of handles of an orientable manifold surface of one piece; None for others.
    nonmanifold_edges, nonmanifold_vertices : int
        Edges with more than two faces; vertices where several fans of faces meet.
    is_orientable : bool
    flipped_faces : (f,) bool
        Faces to turn over for a consistent orientation; as few as possible in each piece.
    isolated_vertices, degenerate_faces, duplicate_faces, slivers, cracks : int
        Vertices in no face; faces without area or with a repeated vertex; faces beyond the first with
        the same vertices; faces thinner than 1 : 10 000; boundary vertices on the inside of another
        boundary edge (T-junctions).
    problems, warnings : tuple of str
        Sentences: what keeps the surface from being used, and what to do; what is only worth knowing.
    """

    name: str
    n_vertices: int
    n_faces: int
    component_sizes: tuple[int, ...]
    boundary_sizes: tuple[int, ...]
    euler_characteristic: int
    genus: int | None
    nonmanifold_edges: int
    nonmanifold_vertices: int
    is_orientable: bool
    flipped_faces: Bool[np.ndarray, " f"]
    isolated_vertices: int
    degenerate_faces: int
    duplicate_faces: int
    slivers: int
    cracks: int
    problems: tuple[str, ...] = field(default=())
    warnings: tuple[str, ...] = field(default=())

    @property
    def is_disk(self) -> bool:
        """True where nothing keeps the surface from being covered by a flat sheet."""
        return not self.problems

    @property
    def sentences(self) -> tuple[str, ...]:
        """The report in words: what it is, then problems, then warnings."""
        return (self.summary, *self.problems, *self.warnings)

    @property
    def summary(self) -> str:
        """One sentence of counts."""
        pieces, loops = len(self.component_sizes), len(self.boundary_sizes)
        parts = [
            f"{self.n_vertices} vertices",
            f"{self.n_faces} faces",
            "one piece" if pieces == 1 else f"{pieces} pieces",
            "closed" if not loops else "one boundary loop" if loops == 1 else f"{loops} boundary loops",
        ]
        if self.genus is not None:
            parts.append({0: "no handles", 1: "one handle"}.get(self.genus, f"{self.genus} handles"))
        return f"{self.name}: {', '.join(parts)}."


def examine(surface: Surface) -> TopologyReport:
    """Count the pieces, boundary loops and handles of a surface and say what is wrong with it.

    Uses the Euler characteristic V - E + F = 2 - 2 g - b of an orientable surface of one piece with g
    handles and b boundary loops.

    Raises
    ------
    UnusableError
        Where a face names a vertex that does not exist.

    Examples
    --------
    >>> import numpy as np
    >>> square = Surface.from_arrays([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]], "square")
    >>> examine(square).summary
    'square: 4 vertices, 2 faces, one piece, one boundary loop, no handles.'
    """
    faces, n = surface.faces, len(surface.vertices)
    check_indices(faces, n, surface.name)
    edges = Edges.of(faces, n)
    used = np.bincount(faces.ravel(), minlength=n) > 0
    pieces = pieces_of_faces(faces, n)
    sizes = np.sort(np.bincount(pieces))[::-1] if len(faces) else np.zeros(0, np.int64)
    boundary = edges.ends[edges.face_count == 1]
    nonmanifold_edges = int((edges.face_count > 2).sum())
    nonmanifold_vertices = int((fans_per_vertex(faces, edges, n) > 1).sum())
    orientable, flipped = orientation(edges, len(faces))
    flat = flat_faces(surface.vertices, faces) if np.isfinite(surface.vertices).all() else np.zeros(len(faces), bool)
    aspect = aspects(surface.vertices, faces)
    repeated = (faces == np.roll(faces, 1, axis=1)).any(axis=1)
    ordered = np.sort(faces, axis=1)
    duplicates = len(faces) - len(np.unique(ordered, axis=0))
    euler = int(used.sum()) - len(edges.ends) + len(faces)
    loops = boundary_loop_sizes(boundary)
    manifold = not nonmanifold_edges and not nonmanifold_vertices
    genus = (2 - len(loops) - euler) // 2 if manifold and orientable and len(sizes) == 1 else None
    report = TopologyReport(
        name=surface.name,
        n_vertices=n,
        n_faces=len(faces),
        component_sizes=tuple(int(s) for s in sizes),
        boundary_sizes=loops,
        euler_characteristic=euler,
        genus=genus,
        nonmanifold_edges=nonmanifold_edges,
        nonmanifold_vertices=nonmanifold_vertices,
        is_orientable=orientable,
        flipped_faces=frozen(flipped, bool),
        isolated_vertices=int(n - used.sum()),
        degenerate_faces=int((repeated | flat).sum()),
        duplicate_faces=duplicates,
        slivers=int(((aspect > SLIVER_ASPECT) & ~flat & ~repeated).sum()),
        cracks=crack_vertices(surface.vertices, boundary),
    )
    return replace(report, problems=_problems(report), warnings=_warnings(report))


def require_disk(surface: Surface) -> Surface:
    """Return the surface with consistently oriented faces, if a flat sheet can cover it.

    Raises
    ------
    UnusableError
        Where it is closed, in several pieces, not manifold, not orientable, has several boundary
        loops or handles, or faces without area: with the reason and what to do.
    """
    report = examine(surface)
    if report.problems:
        raise UnusableError(f"{surface.name}: expected one piece with one boundary loop. {' '.join(report.problems)}")
    return oriented(surface, report)


def oriented(surface: Surface, report: TopologyReport) -> Surface:
    """Return the surface with the faces turned over that its report names; itself where there are none."""
    if not report.flipped_faces.any():
        return surface
    faces = np.where(report.flipped_faces[:, None], surface.faces[:, ::-1], surface.faces)
    return replace(surface, faces=frozen(faces, np.int64))


def face_components(surface: Surface) -> Int[np.ndarray, " f"]:
    """Number of the connected piece of every face, (f,), largest piece (by area) 0."""
    pieces = pieces_of_faces(surface.faces, len(surface.vertices))
    if not len(pieces):
        return pieces
    areas = np.bincount(pieces, weights=surface.face_areas)
    rank = np.empty(len(areas), np.int64)
    rank[np.argsort(-areas, kind="stable")] = np.arange(len(areas))
    return rank[pieces]


def _problems(r: TopologyReport) -> tuple[str, ...]:
    if not r.n_faces:
        return ("The surface has no faces: there is nothing to cover.",)
    found = []
    if r.degenerate_faces:
        found.append(f"{_count(r.degenerate_faces, 'face has', 'faces have')} no area. Try --repair.")
    if r.isolated_vertices:
        found.append(f"{_count(r.isolated_vertices, 'vertex belongs', 'vertices belong')} to no face. Try --repair.")
    if r.duplicate_faces:
        found.append(f"{_count(r.duplicate_faces, 'face is', 'faces are')} there twice. Try --repair.")
    if r.nonmanifold_edges:
        found.append(
            f"The surface branches: at {_count(r.nonmanifold_edges, 'edge', 'edges')} more than two faces meet, "
            "where a sheet could follow only one of them. Remove the inner or extra faces, or try --repair."
        )
    if r.nonmanifold_vertices and not r.nonmanifold_edges:
        found.append(
            f"Parts of the surface touch in a single point at {_count(r.nonmanifold_vertices, 'vertex', 'vertices')}: "
            "no sheet can pass there. Separate the parts, or try --repair."
        )
    if not r.is_orientable:
        found.append(
            "The surface has only one side, as a Moebius strip has: it has no front to lay the sheet on. "
            "Cut it across so that it becomes a strip with two sides."
        )
    if len(r.component_sizes) > 1:
        listed = ", ".join(str(s) for s in r.component_sizes[:_FEW])
        more = ", ..." if len(r.component_sizes) > _FEW else ""
        found.append(
            f"The surface is in {len(r.component_sizes)} separate pieces (of {listed}{more} faces): one sheet covers "
            "one piece. Save one of them by itself, or try --repair, which keeps the largest. If they only look "
            "separate because vertices are not shared, merge them by distance where the surface was made."
        )
    if not r.boundary_sizes:
        found.append(
            "The surface is closed (no boundary): a flat sheet cannot cover it without being cut. "
            "Cut it open or take a part of it (a half, a patch)."
        )
    elif len(r.boundary_sizes) > 1 and len(r.component_sizes) == 1:
        listed = ", ".join(str(s) for s in r.boundary_sizes[:_FEW])
        more = ", ..." if len(r.boundary_sizes) > _FEW else ""
        found.append(
            f"The surface has {len(r.boundary_sizes)} boundary loops (of {listed}{more} edges), one outline and "
            f"{len(r.boundary_sizes) - 1} more: a sheet has a single outline. Fill the holes (--repair does, and keeps "
            "the longest loop), or cut from one loop to the next."
        )
    if r.genus:
        found.append(
            f"The surface has {_count(r.genus, 'handle', 'handles')}, as a cup or a torus has: no flat sheet goes "
            f"round {'it' if r.genus == 1 else 'them'}. Cut through every handle or take a part."
        )
    return tuple(found)


def _warnings(r: TopologyReport) -> tuple[str, ...]:
    found = []
    flips = int(r.flipped_faces.sum())
    if flips:
        found.append(f"{_count(flips, 'face was', 'faces were')} turned over to give the surface one front.")
    if r.slivers:
        found.append(
            f"{_count(r.slivers, 'face is a sliver', 'faces are slivers')}: normals there are uncertain. "
            "Consider --remesh."
        )
    if r.cracks:
        found.append(
            f"{_count(r.cracks, 'vertex lies', 'vertices lie')} on the middle of an edge of other faces (T-junctions): "
            "the surface has cracks there that cannot be seen. Consider --repair or --remesh."
        )
    return tuple(found)


def _count(n: int, one: str, many: str) -> str:
    return f"{n} {one if n == 1 else many}"
