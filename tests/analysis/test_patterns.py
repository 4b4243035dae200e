"""The certificate on every tessellation: regular patterns pass, planted faults fail, openings count as designed."""

from __future__ import annotations

import numpy as np
import pytest

from analysis.certificate import certify
from analysis.openings import find_openings
from kirisurf.errors import UnusableError
from kirisurf.loops import Loops
from kirisurf.unit_cells.catalog import find_cell
from tests.analysis.patterns import NAMES, in_space, regular, windowed

RIGID = ("length", "angle", "planarity", "isometry", "closure")


def failed(certificate) -> set[str]:
    return {sentence.split(":")[0] for sentence in certificate.failures}


@pytest.mark.parametrize("trimmed", [False, True], ids=["whole", "trimmed"])
@pytest.mark.parametrize("name", NAMES)
def test_regular_pattern_is_sound(name, trimmed, rotation):
    pattern = regular(name, 5 if trimmed else 3, trimmed)
    certificate = certify(in_space(pattern.deployed) @ rotation.T, pattern.contracted, pattern.tiles)
    assert certificate.passed, certificate.failures
    assert all(certificate.rows[row] <= 1e-13 for row in RIGID)
    assert (certificate.pieces, certificate.flipped) == (1, 0)
    designed = find_cell(name).openings
    kept = pattern.openings.sizes > 0
    if designed:
        assert certificate.rows["loop"] <= 1e-12
        x, y = designed[0].T
        opening = 0.5 * abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
        area = certificate.rows["gap_contracted"] * _area(pattern)
        assert area == pytest.approx(kept.sum() * opening, rel=1e-9)
    else:
        assert not kept.any()
        assert certificate.rows["loop"] is None
        assert certificate.rows["gap_contracted"] <= 1e-12


def _area(pattern) -> float:
    total = 0.0
    for tile in pattern.tiles:
        x, y = pattern.contracted[tile].T
        total += 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
    return total


def _moved(points: np.ndarray, vertex: int, by: tuple[float, ...]) -> np.ndarray:
    result = np.array(points)
    result[vertex] += by
    return result


def _inner_corner(pattern) -> int:
    """A vertex at a point round which tiles or an opening close."""
    if len(pattern.rings):
        return int(pattern.corners[pattern.rings.indices[0], 1])
    opening = pattern.openings[int(np.flatnonzero(pattern.openings.sizes)[0])]
    return int(pattern.tiles.indices[opening[0]])


def _lonely(pattern) -> int:
    """A vertex of one tile only, with a copy on contraction."""
    count = np.bincount(pattern.tiles.indices)
    copies = np.bincount(pattern.weld)[pattern.weld]
    return int(np.flatnonzero((count == 1) & (copies > 1))[0])


@pytest.mark.parametrize("name", NAMES)
def test_planted_faults_fail_their_rows(name):
    pattern = regular(name)
    space, flat, tiles = in_space(pattern.deployed), pattern.contracted, pattern.tiles
    scale = certify(space, flat, tiles).edge_length
    # where two open triangles meet point to point, the angles change in the second order only
    torn = _moved(space, _inner_corner(pattern), (2e-3 * scale, 5e-3 * scale, 0))
    assert {"angle", "isometry"} <= failed(certify(torn, flat, tiles))
    longer = _moved(space, int(pattern.edge_pairs[0, 0, 0]), (3e-7 * scale, 4e-7 * scale, 0))
    assert "length" in failed(certify(longer, flat, tiles))
    largest = int(tiles.sizes.argmax())
    if tiles.sizes[largest] > 3:
        raised = _moved(space, int(tiles[largest][0]), (0, 0, 1e-6 * scale))
        assert "planarity" in failed(certify(raised, flat, tiles))
    assert "isometry" in failed(certify(space, flat * (1 + 1e-8), tiles))
    assert "closure" in failed(certify(space, _moved(flat, _lonely(pattern), (1e-7 * scale, 0)), tiles))
    assert "opening_min" in failed(certify(in_space(flat), flat, tiles))
    pushed = np.array(flat)
    pushed[tiles[len(tiles) // 2]] += 0.02 * scale
    found = failed(certify(space, pushed, tiles, weld=pattern.weld))
    assert {"overlap_contracted", "closure"} <= found
    assert "min_edge" in failed(certify(_collapsed(space, tiles), flat, tiles))
    mirrored = np.array(flat)
    mirrored[tiles[0]] = mirrored[np.roll(tiles[0][::-1], 1)]
    assert "flipped" in failed(certify(space, mirrored, tiles, weld=pattern.weld))


def _collapsed(points: np.ndarray, tiles: Loops) -> np.ndarray:
    a, b = tiles[0][:2]
    return _moved(points, int(a), tuple(0.9999 * (points[b] - points[a])))


@pytest.mark.parametrize("name", NAMES)
def test_missing_tile_is_a_gap_unless_openings_are_the_design(name):
    pattern = regular(name, 5)
    middle = pattern.contracted.mean(axis=0)
    centers = np.array([pattern.contracted[tile].mean(axis=0) for tile in pattern.tiles])
    largest = pattern.tiles.sizes == pattern.tiles.sizes.max()
    order = np.argsort(np.linalg.norm(centers - middle, axis=1) + 1e9 * ~largest)
    tiles = Loops.from_lists([tile for k, tile in enumerate(pattern.tiles) if k != order[0]])
    space = in_space(pattern.deployed)
    found = certify(space, pattern.contracted, tiles, openings=False)
    assert "gap_contracted" in failed(found)
    if len(pattern.rings):
        assert "gap_contracted" in failed(certify(space, pattern.contracted, tiles))
    # what is meant passes, and its laws hold: (m + 2) pi, and a chain of sides that closes
    meant = certify(space, pattern.contracted, tiles, openings=True)
    assert meant.passed, meant.failures
    assert meant.rows["loop"] <= 1e-12


def test_openings_among_closed_points_have_both_rows():
    pattern = windowed()
    space = in_space(pattern.deployed)
    assert len(pattern.rings) > 9
    certificate = certify(space, pattern.contracted, pattern.tiles)
    assert certificate.passed, certificate.failures
    found = find_openings(space, pattern)
    windows = (pattern.openings.sizes > 0).sum()
    assert len(found.gaps) == windows == 4
    assert certificate.rows["gap_contracted"] == pytest.approx(windows / pattern.n_tiles)
    assert found.area == pytest.approx(windows * 0.25)
    opening = pattern.openings[int(np.flatnonzero(pattern.openings.sizes)[0])]
    torn = _moved(space, int(pattern.tiles.indices[opening[0]]), (1e-3, 2e-3, 0))
    assert {"loop", "angle"} <= failed(certify(torn, pattern.contracted, pattern.tiles))
    ring = _moved(space, int(pattern.corners[pattern.rings.indices[0], 1]), (1e-3, 2e-3, 0))
    assert "angle" in failed(certify(ring, pattern.contracted, pattern.tiles))


def test_openings_laws_hold_for_their_number_of_sides(rotation):
    for name, sides in (("hexagon", 6), ("truncated-square", 4)):
        pattern = regular(name, 4)
        found = find_openings(in_space(pattern.deployed) @ rotation.T, pattern)
        assert len(found.gaps) == (pattern.openings.sizes == sides).sum() > 0
        assert np.abs(found.angle_residuals).max() <= 1e-13
        assert not len(find_openings(in_space(pattern.deployed), pattern, designed=False).gaps)


def test_prescribed_outlines_are_rows_of_their_own(flat_design):
    design = flat_design(3, 2)
    outline = design.tessellation.outline
    apart = np.zeros(len(outline))
    arguments = (design.deployed, design.contracted, design.tiles)
    plain = certify(*arguments)
    assert plain.rows["boundary"] is None and plain.rows["contracted_boundary"] is None and plain.passed
    sound = certify(*arguments, boundary=(outline, apart), contracted_boundary=(outline[:3], apart[:3]))
    assert sound.passed and sound.rows["boundary"] == sound.rows["contracted_boundary"] == 0
    for name in ("boundary", "contracted_boundary"):
        apart[4] = -1e-7
        wrong = certify(*arguments, **{name: (outline, apart)})
        assert wrong.rows[name] == pytest.approx(2e-7)
        assert failed(wrong) == {name}
        points = design.deployed if name == "boundary" else design.contracted
        place = ", ".join(f"{x:.6g}" for x in points[outline[4]][:2])
        assert f"vertex {outline[4]} ({place}" in wrong.failures[0]
        assert certify(*arguments, **{name: (outline, apart)}, limits={name: 1e-6}).passed


def test_outline_distances_follow_the_numbers_of_the_input(flat_design):
    design = flat_design(2, 2)
    extra = np.full((1, 3), 7.0)
    tiles = Loops.from_lists([tile + 1 for tile in design.tiles])
    outline = design.tessellation.outline + 1
    deployed, contracted = np.r_[extra, design.deployed], np.r_[extra[:, :2], design.contracted]
    apart = np.r_[0.25, np.zeros(len(outline) - 1)]
    certificate = certify(deployed, contracted, tiles, boundary=(outline, apart))
    assert certificate.rows["boundary"] == pytest.approx(0.5)
    assert f"vertex {outline[0]} " in certificate.failures[0]
    with pytest.raises(UnusableError, match="vertices of boundary: expected vertices of tiles, got 0"):
        certify(deployed, contracted, tiles, boundary=([0], [0.0]))


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (([1, 2], [0.0]), "distances of boundary: expected shape"),
        (([1.5], [0.0]), "vertices of boundary: expected integers"),
        (([1], [np.nan]), "distances of boundary: expected finite"),
        (([99999], [0.0]), "vertices of boundary: expected vertices of tiles, got 99999"),
    ],
)
def test_outlines_that_do_not_fit_are_refused(flat_design, given, message):
    design = flat_design(2, 2)
    with pytest.raises(UnusableError, match=message):
        certify(design.deployed, design.contracted, design.tiles, boundary=given)


def test_outline_of_no_vertices_checks_nothing_and_fails(flat_design):
    design = flat_design(2, 2)
    empty = np.zeros(0, np.int64), np.zeros(0)
    assert failed(certify(design.deployed, design.contracted, design.tiles, boundary=empty)) == {"boundary"}
