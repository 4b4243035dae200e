"""Topology against surfaces whose pieces, loops and handles are known, and against the Euler characteristic."""

from __future__ import annotations

import numpy as np
import pytest

from kirisurf.connectivity import Edges, fans_per_vertex, separated_fans
from kirisurf.errors import UnusableError
from kirisurf.surface import Surface
from kirisurf.topology import examine, face_components, require_disk


def sheet(n: int = 6, m: int = 6, *, wrap_x: bool = False, wrap_y: bool = False, twist: bool = False) -> Surface:
    """Return a grid of 2 n m triangles, closed up to a tube, torus or Moebius strip."""
    rows, columns = n + (not wrap_y), m + (not wrap_x)
    u, v = np.meshgrid(np.arange(columns) / m, np.arange(rows) / n)
    angle = 2 * np.pi * u
    if twist:
        radius, height = 2 + (v - 0.5) * np.cos(angle / 2), (v - 0.5) * np.sin(angle / 2)
    elif wrap_y:
        radius, height = 2 + np.cos(2 * np.pi * v) / 2, np.sin(2 * np.pi * v) / 2
    else:
        radius, height = 1 + 0 * v, v
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle), height], axis=-1)
    if not wrap_x:
        points = np.stack([u, v, u * v], axis=-1)

    def at(i: int, j: int) -> int:
        if twist and j == m:
            return (rows - 1 - i) * columns
        return (i % rows) * columns + (j % columns)

    faces = [
        corner
        for i in range(n)
        for j in range(m)
        for corner in ((at(i, j), at(i, j + 1), at(i + 1, j + 1)), (at(i, j), at(i + 1, j + 1), at(i + 1, j)))
    ]
    return Surface.from_arrays(points.reshape(-1, 3), np.array(faces), "sheet")


def without(surface: Surface, *faces: int) -> Surface:
    kept = np.delete(surface.faces, faces, axis=0)
    used = np.bincount(kept.ravel(), minlength=len(surface.vertices)) > 0
    return Surface.from_arrays(surface.vertices[used], (np.cumsum(used) - 1)[kept], surface.name)


def joined(*parts: Surface) -> Surface:
    offsets = np.cumsum([0, *[len(p.vertices) for p in parts]])
    faces = np.concatenate([p.faces + k for p, k in zip(parts, offsets, strict=False)])
    return Surface.from_arrays(np.concatenate([p.vertices + 5.0 * k for k, p in enumerate(parts)]), faces, "parts")


TETRAHEDRON = Surface.from_arrays(
    [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]], "tetrahedron"
)
TORUS = sheet(8, 8, wrap_x=True, wrap_y=True)
MOEBIUS = sheet(4, 12, wrap_x=True, twist=True)


@pytest.mark.parametrize(
    ("surface", "pieces", "loops", "genus"),
    [
        (sheet(), 1, 1, 0),
        (sheet(6, 12, wrap_x=True), 1, 2, 0),
        (without(sheet(), 20), 1, 2, 0),
        (TETRAHEDRON, 1, 0, 0),
        (without(TETRAHEDRON, 2), 1, 1, 0),
        (TORUS, 1, 0, 1),
        (without(TORUS, 20), 1, 1, 1),
        (without(TORUS, 20, 70), 1, 2, 1),
        (joined(sheet(), sheet(3, 3)), 2, 2, None),
        (MOEBIUS, 1, 1, None),
    ],
    ids=["disk", "tube", "holed", "sphere", "cup", "torus", "handle", "two holes", "pieces", "moebius"],
)
def test_known_surfaces(surface: Surface, pieces: int, loops: int, genus: int | None) -> None:
    report = examine(surface)
    assert len(report.component_sizes) == pieces
    assert len(report.boundary_sizes) == loops == len(surface.boundary_loops) or surface is MOEBIUS
    assert report.genus == genus
    assert report.is_orientable == (surface is not MOEBIUS)
    assert report.nonmanifold_edges == report.nonmanifold_vertices == 0
    if genus is not None:
        assert report.euler_characteristic == 2 - 2 * genus - loops
    assert report.is_disk == (pieces == 1 and loops == 1 and genus == 0)
    assert sum(report.component_sizes) == report.n_faces == len(surface.faces)


@pytest.mark.parametrize(
    ("surface", "message"),
    [
        (TETRAHEDRON, "closed .no boundary.*Cut it open"),
        (TORUS, "1 handle"),
        (MOEBIUS, "only one side"),
        (joined(sheet(), sheet(3, 3)), r"2 separate pieces \(of 72, 18 faces\).*--repair, which keeps the largest"),
        (without(sheet(), 20), r"2 boundary loops \(of 24, 3 edges\), one outline and 1 more.*Fill the holes"),
        (without(TORUS, 20), "1 handle"),
        (Surface.from_arrays(np.eye(3), np.zeros((0, 3), int)), "no faces"),
    ],
)
def test_what_is_no_disk_is_refused_with_the_reason(surface: Surface, message: str) -> None:
    with pytest.raises(UnusableError, match=message) as caught:
        require_disk(surface)
    assert caught.value.exit_code == 4
    assert str(caught.value).startswith(f"{surface.name}: expected one piece with one boundary loop. The surface")


def test_faults_are_counted_each_by_itself() -> None:
    base = sheet()
    fin = np.vstack([base.vertices, [[0.5, 0.5, 3]]])
    inner = base.faces[30]
    branched = examine(Surface.from_arrays(fin, np.vstack([base.faces, [[inner[0], inner[1], len(fin) - 1]]])))
    assert branched.nonmanifold_edges == 1 and "branches: at 1 edge" in " ".join(branched.problems)

    touching = Surface.from_arrays(
        [[0, 0, 0], [1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]], [[0, 1, 2], [0, 3, 4]], "bow tie"
    )
    report = examine(touching)
    assert report.nonmanifold_vertices == 1 and "single point at 1 vertex" in report.problems[0]
    assert len(report.component_sizes) == 1

    twice = examine(Surface.from_arrays(base.vertices, np.vstack([base.faces, base.faces[[3]][:, [2, 0, 1]]])))
    assert twice.duplicate_faces == 1

    alone = examine(Surface.from_arrays(fin, base.faces))
    assert alone.isolated_vertices == 1 and "1 vertex belongs to no face" in alone.problems[0]

    flat = examine(Surface.from_arrays(base.vertices * [1, 0, 1] * [1, 1, 0], base.faces))
    assert flat.degenerate_faces == len(base.faces)


def test_slivers_and_cracks_are_warnings() -> None:
    thin = Surface.from_arrays([[0, 0, 0], [1, 0, 0], [0.5, 1e-6, 0], [0.5, -1, 0]], [[0, 1, 2], [1, 0, 3]], "thin")
    report = examine(thin)
    assert report.is_disk and report.slivers == 1 and "sliver" in report.warnings[0]
    crack = Surface.from_arrays(
        [[0, 0, 0], [2, 0, 0], [1, 1, 0], [1, 0, 0], [0, -1, 0], [2, -1, 0]],
        [[0, 1, 2], [0, 4, 3], [3, 4, 5], [3, 5, 1]],
        "crack",
    )
    report = examine(crack)
    assert report.cracks == 1 and "T-junction" in " ".join(report.warnings)
    assert examine(sheet()).warnings == ()


@pytest.mark.parametrize("seed", range(4))
def test_scrambled_faces_are_turned_back(seed: int) -> None:
    surface = sheet(7, 9)
    random = np.random.default_rng(seed)
    flipped = random.random(len(surface.faces)) < 0.3
    faces = np.where(flipped[:, None], surface.faces[:, ::-1], surface.faces)
    order, names = random.permutation(len(faces)), random.permutation(len(surface.vertices))
    scrambled = Surface.from_arrays(surface.vertices[np.argsort(names)], names[faces][order], "scrambled")
    report = examine(scrambled)
    assert report.is_disk and np.array_equal(report.flipped_faces, flipped[order])
    assert f"{flipped.sum()} faces were turned over" in report.warnings[0]
    turned = require_disk(scrambled)
    assert np.allclose(turned.face_normals, surface.face_normals[order])
    assert not examine(turned).flipped_faces.any()
    assert require_disk(turned) is turned


def test_orientation_of_every_piece_by_itself() -> None:
    base = sheet()
    inside_out = Surface.from_arrays(base.vertices, base.faces[:, ::-1])
    report = examine(joined(base, inside_out))
    assert not report.flipped_faces.any()  # consistent in itself: nothing to turn


def test_numbering_and_motion_change_nothing() -> None:
    surface = without(TORUS, 5, 60, 61)
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    names = np.random.default_rng(2).permutation(len(surface.vertices))
    other = Surface.from_arrays((1e4 * surface.vertices @ turn + 7)[np.argsort(names)], names[surface.faces], "sheet")
    first, second = examine(surface), examine(other)
    assert first.sentences == second.sentences and first.boundary_sizes == second.boundary_sizes


def test_largest_piece_is_the_one_with_most_area() -> None:
    small = sheet(9, 9)
    small = Surface.from_arrays(small.vertices * 0.1, small.faces)
    parts = face_components(joined(small, sheet(2, 2)))
    assert parts.tolist() == [1] * 162 + [0] * 8


def test_fans_against_the_slow_way() -> None:
    random = np.random.default_rng(5)
    for _ in range(20):
        faces = np.array([random.choice(9, 3, replace=False) for _ in range(12)])
        fast = fans_per_vertex(faces, Edges.of(faces, 9), 9)
        for vertex in range(9):
            around = [set(f.tolist()) - {vertex} for f in faces if vertex in f]
            fans = 0
            while around:
                fans += 1
                fan = around.pop()
                while any(found := [other for other in around if other & fan]):
                    for other in found:
                        fan |= other
                        around.remove(other)
            assert fast[vertex] == fans


def test_separated_fans_touch_nowhere() -> None:
    faces = np.array([[0, 1, 2], [0, 3, 4], [0, 4, 5], [6, 7, 0]])
    split, origins = separated_fans(faces, 9)
    assert np.array_equal(origins[split], faces)
    assert origins.tolist() == [0, 0, 0, 1, 2, 3, 4, 5, 6, 7]
    assert (fans_per_vertex(split, Edges.of(split, 10), 10) == 1).all()


def test_seventy_thousand_faces_take_no_time() -> None:
    import time

    surface = sheet(190, 190)
    # seconds of this thread alone: whatever else the machine does has no part in them
    start = time.thread_time()
    assert examine(surface).is_disk
    assert time.thread_time() - start < 2.0
