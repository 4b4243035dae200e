"""Sound designs pass, every planted fault fails its row, and a row that checks nothing fails the design."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from analysis.certificate import certify
from analysis.limits import LIMITS, ROWS, TARGET_ROWS
from kirisurf.errors import ParameterError, UnusableError
from kirisurf.loops import Loops
from kirisurf.pattern import quad_pattern

RIGID = ("length", "angle", "planarity", "isometry", "closure")


def failed(certificate) -> set[str]:
    return {sentence.split(":")[0] for sentence in certificate.failures}


def test_rows_have_the_names_and_order_of_the_interface(flat_design):
    design = flat_design()
    names = (
        "length, angle, planarity, isometry, closure, opening_min, intersections, overlap_contracted, "
        "gap_contracted, loop, boundary, contracted_boundary, min_edge, distance_rms, distance_max, reach_rms, "
        "reach_max, coverage, coverage_strict"
    )
    assert ", ".join(certify(design.deployed, design.contracted, design.tiles).rows) == names == ", ".join(ROWS)


@pytest.mark.parametrize("angle", [0.05, 0.6, np.pi / 4])
def test_flat_pattern_is_sound(flat_design, angle):
    design = flat_design(3, 2, angle)
    certificate = certify(design.deployed, design.contracted, design.tiles)
    assert certificate.passed, certificate.failures
    assert all(certificate.rows[name] <= 1e-13 for name in RIGID)
    assert certificate.rows["opening_min"] == pytest.approx(2 * angle)
    assert certificate.rows["loop"] is None
    assert all(certificate.rows[name] is None for name in TARGET_ROWS)
    assert certificate.edge_length == pytest.approx(0.5)


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_rows_do_not_depend_on_frame_scale_or_side(flat_design, grid_surface, rotation, scale):
    design, target = flat_design(), grid_surface(n=5, size=2.4)
    target = type(target).from_arrays(target.vertices + np.array([0, 0, 0.05]), target.faces)
    shift = scale * np.array([30.0, -20.0, 10.0])
    moved = type(target).from_arrays(scale * target.vertices @ rotation.T + shift, target.faces)
    one = certify(design.deployed, design.contracted, design.tiles, target)
    # the sheet seen from behind: a contracted layout mirrored in the plane
    mirrored = scale * design.contracted * np.array([-1.0, 1.0]) + 7 * scale
    two = certify(scale * design.deployed @ rotation.T + shift, mirrored, design.tiles, moved)
    assert one.passed, one.failures
    assert two.passed, two.failures
    for name in ROWS:
        if one.rows[name] is not None:
            assert two.rows[name] == pytest.approx(one.rows[name], rel=1e-6, abs=1e-11), name


def test_contracted_state_may_lie_in_any_plane(flat_design, rotation):
    design = flat_design()
    tilted = np.c_[design.contracted, np.zeros(len(design.contracted))] @ rotation.T + 5.0
    certificate = certify(design.deployed, tilted, design.tiles)
    assert certificate.passed, certificate.failures


def test_rows_do_not_depend_on_numbering(flat_design):
    design = flat_design()
    rng = np.random.default_rng(1)
    order = rng.permutation(len(design.deployed))
    place = np.argsort(order)
    tiles = [np.roll(place[tile], 1) for tile in design.tiles]
    # a vertex that no tile uses changes nothing
    extra = np.array([[9.0, 9.0, 9.0]])
    deployed = np.concatenate([design.deployed[order], extra])
    contracted = np.concatenate([design.contracted[order], extra[:, :2]])
    certificate = certify(deployed, contracted, Loops.from_lists([tiles[k] for k in rng.permutation(len(tiles))]))
    assert certificate.passed, certificate.failures
    assert certificate.rows["opening_min"] == pytest.approx(1.2)


def _move(points: np.ndarray, vertex: int, by: tuple[float, ...]) -> np.ndarray:
    moved = np.array(points)
    moved[vertex] += by
    return moved


def _lonely(design) -> int:
    """A vertex of one tile only, at a slit edge."""
    count = np.bincount(design.tiles.indices)
    return int(next(v for v in design.tessellation.edge_pairs.ravel() if count[v] == 1))


def length(design):
    return {"deployed": _move(design.deployed, _lonely(design), (1e-7, 2e-7, 0))}


def angle(design):
    inner = design.tessellation.corners[design.tessellation.rings.indices[0], 1]
    return {"deployed": _move(design.deployed, inner, (1e-7, 2e-7, 0))}


def planarity(design):
    return {"deployed": _move(design.deployed, _lonely(design), (0, 0, 1e-7))}


def isometry(design):
    return {"contracted": design.contracted * (1 + 1e-8)}


def closure(design):
    return {"contracted": _move(design.contracted, _lonely(design), (1e-7, 0))}


def closure_beyond_welding(design):
    return {"contracted": _move(design.contracted, _lonely(design), (1e-3, 0))}


def closure_at_given_weld(design):
    return {"contracted": _move(design.contracted, _lonely(design), (1e-3, 0)), "weld": design.tessellation.weld}


def opening_min_negative(design):
    turned = quad_pattern(3, 3, -0.1)
    return {"deployed": np.pad(turned.deployed, ((0, 0), (0, 1))), "tiles": turned.tiles}


def opening_min_closed(design):
    return {"deployed": np.pad(design.contracted, ((0, 0), (0, 1)))}


def intersections_rolled_up(design):
    x, y, _ = design.deployed.T
    radius = np.ptp(x) / (2.4 * np.pi)
    return {"deployed": np.stack([radius * np.cos(x / radius), y, radius * np.sin(x / radius)], axis=1)}


def intersections_in_one_plane(design):
    pattern = quad_pattern(3, 3, -0.6)
    return {"deployed": np.pad(pattern.deployed, ((0, 0), (0, 1))), "tiles": pattern.tiles}


def overlap_contracted(design):
    corner = design.tiles[0]
    contracted = np.array(design.contracted)
    contracted[corner] += 0.01
    return {"contracted": contracted, "weld": design.tessellation.weld}


def gap_contracted_missing_tile(design):
    middle = design.contracted.mean(axis=0)
    inner = min(
        range(len(design.tiles)), key=lambda k: np.linalg.norm(design.contracted[design.tiles[k]].mean(axis=0) - middle)
    )
    return {"tiles": Loops.from_lists([tile for k, tile in enumerate(design.tiles) if k != inner])}


def gap_contracted_open_slit(design):
    middle = design.tessellation.rings.indices[0]
    vertex = design.tessellation.corners[middle, 1]
    tile = design.tiles[int(design.tiles.owners[middle])]
    toward = design.contracted[tile].mean(axis=0) - design.contracted[vertex]
    return {"contracted": _move(design.contracted, vertex, tuple(0.3 * toward))}


def min_edge(design):
    a, b = design.tiles[0][:2]
    return {"deployed": _move(design.deployed, a, tuple(0.999 * (design.deployed[b] - design.deployed[a])))}


def pieces(design):
    n = len(design.deployed)
    return {
        "deployed": np.concatenate([design.deployed, design.deployed + 50.0]),
        "contracted": np.concatenate([design.contracted, design.contracted + 50.0]),
        "tiles": Loops.from_lists([*design.tiles, *(tile + n for tile in design.tiles)]),
    }


def flipped(design):
    contracted, corner = np.array(design.contracted), design.tiles[0]
    contracted[corner] = contracted[np.roll(corner[::-1], 1)]
    return {"contracted": contracted, "weld": design.tessellation.weld}


def flatness(design):
    return {"contracted": _move(np.pad(design.contracted, ((0, 0), (0, 1))), 3, (0, 0, 1e-6))}


FAULTS = [
    length,
    angle,
    planarity,
    isometry,
    closure,
    closure_beyond_welding,
    closure_at_given_weld,
    opening_min_negative,
    opening_min_closed,
    intersections_rolled_up,
    intersections_in_one_plane,
    overlap_contracted,
    gap_contracted_missing_tile,
    gap_contracted_open_slit,
    min_edge,
    pieces,
    flipped,
    flatness,
]


@pytest.mark.parametrize("fault", FAULTS, ids=lambda f: f.__name__)
def test_planted_fault_fails_its_row(flat_design, fault: Callable):
    design = flat_design()
    sound = {"deployed": design.deployed, "contracted": design.contracted, "tiles": design.tiles}
    assert certify(**sound).passed
    certificate = certify(**(sound | fault(design)))
    row = next(name for name in LIMITS if fault.__name__.startswith(name))
    assert row in failed(certificate), certificate.failures
    assert not certificate.passed


def test_planted_fault_is_located(flat_design):
    design = flat_design()
    certificate = certify(_move(design.deployed, 5, (0, 0, 0.1)), design.contracted, design.tiles)
    tile = int(design.tiles.owners[np.flatnonzero(design.tiles.indices == 5)[0]])
    sentence = next(s for s in certificate.failures if s.startswith("planarity"))
    assert f"tile {tile}" in sentence
    assert "expected at most 1e-09, got 0." in sentence


def _plane(grid_surface, size: float, height: float):
    target = grid_surface(n=9, size=size)
    return type(target).from_arrays(target.vertices + np.array([0, 0, height]), target.faces)


@pytest.mark.parametrize(
    ("rows", "size", "height"),
    [
        ({"distance_rms", "distance_max"}, 2.2, 1.0),
        ({"reach_rms", "reach_max"}, 30.0, 0.0),
        ({"coverage", "coverage_strict"}, 6.0, 0.0),
    ],
)
def test_wrong_target_fails_its_rows(flat_design, grid_surface, rows, size, height):
    design = flat_design()
    near = certify(design.deployed, design.contracted, design.tiles, _plane(grid_surface, 2.2, 0.0))
    assert near.passed, near.failures
    assert rows <= failed(certify(design.deployed, design.contracted, design.tiles, _plane(grid_surface, size, height)))


def test_collapsed_sheet_is_found_by_what_it_does_not_cover(flat_design, grid_surface):
    design = flat_design()
    small = certify(design.deployed * 0.2, design.contracted * 0.2, design.tiles, _plane(grid_surface, 2.2, 0.0))
    assert failed(small) == {"reach_rms", "reach_max", "coverage", "coverage_strict"}


def test_sheet_collapsed_to_a_line_fails_and_does_not_raise(flat_design, grid_surface):
    design = flat_design()
    line = design.deployed * np.array([1.0, 0, 0])
    certificate = certify(line, design.contracted, design.tiles, _plane(grid_surface, 2.2, 0.0))
    assert {"isometry", "reach_max", "coverage"} <= failed(certificate)


def test_single_tile_checks_nothing_and_fails():
    square = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    certificate = certify(np.pad(square, ((0, 0), (0, 1))), square, Loops.from_lists([[0, 1, 2, 3]]))
    assert [name for name in ("length", "angle", "closure", "opening_min") if certificate.rows[name] is not None] == []
    assert failed(certificate) == {"length", "angle", "closure", "opening_min"}
    assert all("could not be checked" in sentence for sentence in certificate.failures)


def test_target_that_is_no_disk_cannot_be_covered(flat_design, grid_surface):
    design, target = flat_design(), grid_surface(n=9, size=2.2)
    ring = target.faces[np.abs(target.vertices[target.faces].mean(axis=1)[:, :2]).max(axis=1) > 0.6]
    used, faces = np.unique(ring, return_inverse=True)
    annulus = type(target).from_arrays(target.vertices[used], faces.reshape(-1, 3))
    certificate = certify(design.deployed, design.contracted, design.tiles, annulus)
    assert certificate.rows["coverage"] is None
    assert failed(certificate) == {"coverage", "coverage_strict"}


def test_tiles_that_make_no_sheet_fail_with_the_reason(flat_design):
    design = flat_design()
    # three tiles along one edge
    tiles = Loops.from_lists([*design.tiles, design.tiles[0]])
    certificate = certify(design.deployed, design.contracted, tiles)
    assert {"topology", "length", "angle", "overlap_contracted"} <= failed(certificate)


def test_self_crossing_contracted_tile_fails_overlap(flat_design):
    design = flat_design()
    contracted = np.array(design.contracted)
    a, b = design.tiles[7][:2]
    contracted[[a, b]] = contracted[[b, a]]
    certificate = certify(design.deployed, contracted, design.tiles, weld=design.tessellation.weld)
    assert certificate.rows["overlap_contracted"] is None
    assert {"overlap_contracted", "gap_contracted", "isometry"} <= failed(certificate)


def test_distance_to_the_smooth_surface_stands_beside(flat_design, grid_surface):
    class Plane:
        formula = "z = 0.125"

        def project(self, points):
            foot = points * np.array([1.0, 1, 0]) + np.array([0, 0, 0.125])
            return foot, np.tile([0.0, 0, 1], (len(points), 1)), np.zeros((len(points), 3, 3))

    design, target = flat_design(), grid_surface(n=9, size=2.2, smooth=Plane())
    certificate = certify(design.deployed, design.contracted, design.tiles, target)
    assert certificate.rows["distance_max"] == pytest.approx(0, abs=1e-12)
    assert certificate.extra["distance_smooth_rms"] == pytest.approx(0.25)
    assert certificate.passed
    exact = certify(design.deployed, design.contracted, design.tiles, target, limits={"distance_smooth_max": 1e-9})
    assert failed(exact) == {"distance_smooth_max"}


def test_limits_are_data(flat_design):
    design = flat_design()
    strict = certify(design.deployed, design.contracted, design.tiles, limits={"opening_min": 1.3})
    assert failed(strict) == {"opening_min"}
    with pytest.raises(ParameterError, match="expected names among"):
        certify(design.deployed, design.contracted, design.tiles, limits={"lenght": 1.0})


def _hexagon_ring():
    """Six hexagons round an opening, hinged in a chain: no ring of angles, one designed opening."""
    corner = np.exp(1j * np.pi / 3 * np.arange(6))
    centers = np.sqrt(3) * np.exp(1j * (np.pi / 6 + np.pi / 3 * np.arange(6)))
    points = (centers[:, None] + corner).ravel()
    same = np.abs(points[:, None] - points) < 1e-9
    # the inner corner of every shared side is a hinge, the outer one is cut
    inner = np.abs(points) < 1.01
    number = np.array([np.flatnonzero(same[k])[0] if inner[k] else k for k in range(36)])
    used, tiles = np.unique(number, return_inverse=True)
    plane = np.stack([points[used].real, points[used].imag], axis=1)
    return np.pad(plane, ((0, 0), (0, 1))), plane, Loops.from_lists(tiles.reshape(6, 6))


def test_designed_opening_is_closed_by_eight_pi_and_its_loop():
    deployed, contracted, tiles = _hexagon_ring()
    certificate = certify(deployed, contracted, tiles)
    assert certificate.rows["angle"] <= 1e-13
    assert certificate.rows["loop"] <= 1e-13
    assert certificate.rows["gap_contracted"] == pytest.approx(1 / 6)
    # the sheet is contracted in both states, which is all that is wrong with it
    assert failed(certificate) == {"opening_min"}


def test_designed_opening_that_does_not_close_fails_loop():
    deployed, contracted, tiles = _hexagon_ring()
    # one copy of an outer slit end: the tile's angle at the opening changes, so that its sides turn too far
    outer = int(np.flatnonzero(np.abs(np.linalg.norm(contracted, axis=1) - 2) < 1e-9)[0])
    torn = _move(deployed, outer, tuple(1e-3 * np.cross([0, 0, 1], deployed[outer])))
    assert {"loop", "angle", "isometry"} <= failed(certify(torn, contracted, tiles))
    # the contracted state itself is as before: the loop is that of the deployed tiles
    assert "loop" not in failed(certify(deployed, contracted, tiles))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"deployed": np.zeros((3, 2))}, "deployed vertices: expected shape"),
        ({"contracted": np.zeros((3, 2))}, "contracted vertices: expected shape"),
        ({"tiles": Loops.from_lists([])}, "expected at least one"),
        ({"tiles": Loops.from_lists([[0, 1, 999]])}, "expected vertex numbers"),
        ({"tiles": Loops.from_lists([[0, 1]])}, "at least 3 vertices"),
        ({"tiles": Loops.from_lists([[0, 1, 1]])}, "one twice in tile 0"),
        ({"weld": np.zeros(3, int)}, "weld: expected shape"),
    ],
)
def test_arrays_that_do_not_fit_are_refused(flat_design, change, message):
    design = flat_design()
    with pytest.raises(UnusableError, match=message):
        certify(**({"deployed": design.deployed, "contracted": design.contracted, "tiles": design.tiles} | change))


def test_not_finite_is_refused(flat_design):
    design = flat_design()
    with pytest.raises(UnusableError, match="expected finite numbers"):
        certify(_move(design.deployed, 2, (np.nan, 0, 0)), design.contracted, design.tiles)


def test_tiles_that_overlap_in_the_plane_of_the_deployed_sheet_are_counted() -> None:
    """No crossing in space shows tiles of one plane that overlap, nor neighbors that overlap beside their hinge."""
    pattern = quad_pattern(2, 2, 0.5)
    flat = np.c_[pattern.deployed, np.zeros(pattern.n_vertices)]
    assert certify(flat, pattern.contracted, pattern.tiles).rows["intersections"] == 0
    count = np.bincount(pattern.tiles.indices, minlength=pattern.n_vertices)
    tip = int(np.flatnonzero(count == 1)[0])
    own = next(k for k, tile in enumerate(pattern.tiles) if tip in tile)
    neighbor = next(k for k, tile in enumerate(pattern.tiles) if k != own and set(tile) & set(pattern.tiles[own]))
    moved = flat.copy()
    moved[tip] = flat[pattern.tiles[neighbor]].mean(axis=0)
    turn = np.linalg.qr(np.random.default_rng(0).standard_normal((3, 3)))[0]
    for points in (moved, moved @ turn.T):
        assert certify(points, pattern.contracted, pattern.tiles).rows["intersections"] >= 1
