"""Cut lines of any tessellation: hinges of the width that was asked for, with a kerf as without one."""

from __future__ import annotations

import numpy as np
import pytest
from shapely import LineString, MultiLineString, MultiPoint, Point, Polygon, get_num_geometries

from kirisurf.contours import contours, signed_area, welded_points
from kirisurf.cuts import Cuts, cuts
from kirisurf.derive import derive_tessellation
from kirisurf.errors import ParameterError
from kirisurf.kerf import clearance, compensated_contours
from kirisurf.loops import Loops
from tests.kirisurf.patterns import NAMES, bent, pattern

KERF = 0.013


def length(line: np.ndarray) -> float:
    return float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum())


def tips(lines: Cuts) -> list[tuple[int, np.ndarray]]:
    """(slit, end point) of every end that is not where the whole slit ends."""
    return [
        (k, short[end])
        for k, (short, full) in enumerate(zip(lines.slits, lines.whole, strict=True))
        for end in (0, -1)
        if not np.array_equal(short[end], full[end])
    ]


def remaining(lines: Cuts, rim: MultiLineString, kerf: float) -> np.ndarray:
    """Material between every tip and what is nearest to it: another slit, or the rim of the finished part."""
    others = [
        MultiLineString([s.tolist() for j, s in enumerate(lines.slits) if j != k]) for k, _ in enumerate(lines.slits)
    ]
    return np.array(
        [min(Point(at).distance(others[k]) - kerf, Point(at).distance(rim) - kerf / 2) for k, at in tips(lines)]
    )


@pytest.mark.parametrize("name", NAMES)
def test_every_slit_is_cut_once_and_every_hinge_has_its_ligament(name: str) -> None:
    tessellation = pattern(name)
    points = bent(tessellation, 0.03)
    lines = cuts(tessellation, points, 0.03)
    a, b = points[tessellation.edge_pairs[:, 0]].swapaxes(0, 1)
    n_hinges = int(tessellation.slit_ends.sum())
    assert len(lines.hinges) == len(tips(lines)) == n_hinges > 0
    assert sum(map(length, lines.whole)) == pytest.approx(np.linalg.norm(b - a, axis=1).sum(), rel=1e-12)
    assert sum(map(length, lines.slits)) == pytest.approx(sum(map(length, lines.whole)) - 0.03 * n_hinges, abs=1e-12)
    sheet = Polygon(lines.outline, lines.openings)
    assert sheet.area == pytest.approx(sum(Polygon(points[tile]).area for tile in tessellation.tiles))


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("kerf", [2e-4, KERF])
def test_the_cut_sheet_is_one_piece_and_its_hinges_hold_all_of_it(name: str, kerf: float) -> None:
    tessellation = pattern(name)
    lines = cuts(tessellation, bent(tessellation, 0.03), 0.03, kerf)
    rings = [np.vstack([loop, loop[:1]]) for loop in (lines.outline, *lines.openings)]
    saw = MultiLineString([line.tolist() for line in (*lines.slits, *rings)]).buffer(kerf / 2)
    left = Polygon(lines.outline, lines.openings).difference(saw)
    assert get_num_geometries(left) == 1
    assert get_num_geometries(left.difference(MultiPoint(lines.hinges).buffer(0.025))) == tessellation.n_tiles


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("is_bent", [False, True])
def test_hinges_keep_their_width_with_a_kerf(name: str, is_bent: bool) -> None:
    tessellation = pattern(name)
    points = bent(tessellation, 0.03) if is_bent else tessellation.contracted
    plain, made = cuts(tessellation, points, 0.03), cuts(tessellation, points, 0.03, KERF)
    rim = MultiLineString([np.vstack([loop, loop[:1]]).tolist() for loop in (plain.outline, *plain.openings)])
    before, after = remaining(plain, rim, 0.0), remaining(made, rim, KERF)
    assert (after > before - 1e-9).all()
    if name == "rectangle" and not is_bent:
        assert after == pytest.approx(np.full(len(after), 0.03), abs=1e-12)
    assert made.narrowed == 0 and made.warnings == ()


@pytest.mark.parametrize("name", NAMES)
def test_the_part_keeps_its_size_with_a_kerf(name: str) -> None:
    tessellation = pattern(name)
    points = bent(tessellation, 0.03)
    plain, made = cuts(tessellation, points, 0.03), cuts(tessellation, points, 0.03, KERF)
    rings = [LineString(np.vstack([loop, loop[:1]])) for loop in (made.outline, *made.openings)]
    left = Polygon(made.outline, made.openings)
    for ring in rings:
        left = left.difference(ring.buffer(KERF / 2))
    nominal = Polygon(plain.outline, plain.openings)
    # nothing of the part is lost; the tip of a mitre at most stays in an inner corner, where a round cutter cannot go
    assert left.symmetric_difference(nominal).area < 1e-3 * nominal.area
    assert nominal.difference(left).area < 1e-6 * nominal.area
    assert len(made.openings) == len(plain.openings) == (name == "opening")
    assert signed_area(made.outline) > 0 and all(signed_area(loop) < 0 for loop in made.openings)


def test_hinges_that_would_swallow_a_slit_are_narrowed_and_counted() -> None:
    tessellation = pattern("rectangle")
    points = bent(tessellation, 0.12)
    assert cuts(tessellation, points).narrowed == 0
    lines = cuts(tessellation, points, 0.2)
    assert 0 < lines.narrowed < len(lines.hinges)
    assert all(length(line) > 0 for line in lines.slits)
    (said,) = lines.warnings
    assert f"{lines.narrowed} of {len(lines.hinges)} hinges are narrower than 0.2" in said
    assert 0 < lines.narrowest < 0.2


@pytest.mark.parametrize("kerf", [-0.01, 0.03, 1.0, float("nan")])
def test_a_kerf_as_wide_as_a_hinge_is_refused(kerf: float) -> None:
    tessellation = pattern("rectangle")
    with pytest.raises(ParameterError, match=r"--kerf: expected .* less than the hinge width 0.03, got"):
        cuts(tessellation, tessellation.contracted, 0.03, kerf)


def test_a_kerf_that_fills_an_opening_is_refused() -> None:
    square = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    small = (0.4 + 0.1 * square)[::-1]
    assert compensated_contours(square, (small,), 0.05)[0] == pytest.approx(1.05 * (square - 0.5) + 0.5)
    assert signed_area(compensated_contours(square, (small,), 0.05)[1][0]) == pytest.approx(-(0.05**2))
    with pytest.raises(ParameterError, match="designed openings"):
        compensated_contours(square, (small,), 0.2)


def test_clearance_follows_its_formula() -> None:
    east, north, oblique = np.array([1.0, 0]), np.array([0, 1.0]), np.array([0.5, np.sqrt(0.75)])
    assert clearance(east, [], 0.2) == pytest.approx(0.1)
    assert clearance(east, [("rim", north), ("rim", -north)], 0.2) == pytest.approx(0.1)
    assert clearance(east, [("slit", north)], 0.2) == pytest.approx(0.2)
    assert clearance(east, [("slit", oblique)], 0.2) == pytest.approx(0.2 / np.sqrt(0.75))
    assert clearance(east, [("tip", oblique)], 0.2) == pytest.approx(0.1 / np.sin(np.radians(30)))
    assert clearance(east, [("tip", -east)], 0.2) == pytest.approx(0.1)


def test_contours_of_a_sheet_with_an_opening() -> None:
    tessellation = pattern("opening")
    points = welded_points(tessellation, tessellation.contracted)
    outline, others = contours(tessellation)
    assert signed_area(points[outline]) == pytest.approx(16.0)
    assert [signed_area(points[loop]) for loop in others] == pytest.approx([-2.0])


def test_tiles_that_touch_in_a_point_are_said() -> None:
    corners = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1], [2, 1], [2, 2], [1, 2]])
    two = derive_tessellation(corners, corners, Loops.from_lists([[0, 1, 2, 3], [2, 4, 5, 6]]), np.arange(7))
    lines = cuts(two, corners, 0.1)
    assert lines.slits == () and lines.bare == 1
    assert lines.warnings == (
        "1 hinges lie between openings: their tiles touch in a point only, and fall apart when cut.",
    )
    assert signed_area(lines.outline) + sum(map(signed_area, lines.openings)) == pytest.approx(2.0)
    for name in NAMES:
        assert cuts(pattern(name), pattern(name).contracted).warnings == ()
