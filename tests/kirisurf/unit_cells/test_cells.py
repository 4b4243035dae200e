"""Laws of every unit cell: congruent tiles, areas, no overlap, Euler's theorem, and whether it moves."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from kirisurf.derive import n_outer_loops
from kirisurf.errors import ParameterError
from kirisurf.pattern import tile_pattern
from kirisurf.tessellation import Tessellation
from kirisurf.tessellation_names import TESSELLATIONS
from kirisurf.unit_cell import UnitCell, quad_cell
from kirisurf.unit_cells import catalog, find_cell
from kirisurf.unit_cells.checks import check_cell
from kirisurf.unit_cells.hexagon import STRETCH as HEXAGON
from kirisurf.unit_cells.hexagon import hexagon_cell
from kirisurf.unit_cells.islamic_quad import STRETCH as ISLAMIC_QUAD
from kirisurf.unit_cells.islamic_quad import islamic_quad_cell
from kirisurf.unit_cells.islamic_triangle import STRETCH as ISLAMIC_TRIANGLE
from kirisurf.unit_cells.islamic_triangle import islamic_triangle_cell
from kirisurf.unit_cells.kagome import STRETCH as KAGOME
from kirisurf.unit_cells.kagome import kagome_cell

NAMES = [entry.name for entry in catalog()]
TURNING = {"quad": (quad_cell, np.pi / 4), "kagome": (kagome_cell, np.pi / 3), "hexagon": (hexagon_cell, np.pi / 6)}
CELLS = {
    **{name: find_cell(name) for name in NAMES},
    **{f"{name} {part}": make(part * most) for name, (make, most) in TURNING.items() for part in (0.2, 0.6)},
    "islamic-quad 0.2": islamic_quad_cell(0.2),
    "islamic-quad 0.8": islamic_quad_cell(0.8),
    "islamic-triangle 0.2": islamic_triangle_cell(0.2),
    "islamic-triangle 0.9": islamic_triangle_cell(0.9),
}
every_cell = pytest.mark.parametrize("cell", CELLS.values(), ids=CELLS.keys())


def sheet(cell: UnitCell, columns: int = 3, rows: int = 3) -> Tessellation:
    return tile_pattern(cell, np.ones((columns, rows), bool))


def area(p: np.ndarray) -> float:
    q = np.roll(p, -1, axis=0)
    return 0.5 * float((p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]).sum())


def union(points: np.ndarray, t: Tessellation) -> tuple[float, float]:
    """Sum of the tiles' areas, and the area that they cover."""
    shapes = [shapely.Polygon(points[tile]) for tile in t.tiles]
    assert all(shape.is_valid for shape in shapes)
    return sum(shape.area for shape in shapes), shapely.union_all(shapes).area


@every_cell
def test_tiles_are_congruent_in_both_states(cell: UnitCell) -> None:
    for tile in cell.tiles:
        # all distances and the sense: the same triangle whatever three corners are taken
        a, b = cell.contracted[tile], cell.deployed[tile]
        gap = np.linalg.norm(a[:, None] - a, axis=-1) - np.linalg.norm(b[:, None] - b, axis=-1)
        assert np.abs(gap).max() < 1e-12
        assert area(a) == pytest.approx(area(b), abs=1e-12)
        assert area(a) > 0


@every_cell
def test_tiles_and_openings_fill_the_contracted_cell(cell: UnitCell) -> None:
    assert cell.area == pytest.approx(1, abs=1e-12)
    filled = sum(area(cell.contracted[tile]) for tile in cell.tiles) + sum(area(opening) for opening in cell.openings)
    assert filled == pytest.approx(cell.area, abs=1e-12)


@every_cell
def test_tiles_overlap_in_neither_state(cell: UnitCell) -> None:
    t = sheet(cell)
    for points in (t.contracted, t.deployed):
        total, covered = union(points, t)
        assert covered == pytest.approx(total, abs=1e-9)


@every_cell
def test_the_checks_of_files_pass(cell: UnitCell) -> None:
    check_cell(cell, ["tile"] * len(cell.tiles), ["opening"] * len(cell.openings), "cell")


@every_cell
@pytest.mark.parametrize("shape", [(3, 3), (2, 4)])
def test_sheets_obey_euler_in_both_states(cell: UnitCell, shape: tuple[int, int]) -> None:
    t = sheet(cell, *shape)
    sides = len(t.tiles.indices)
    assert t.n_vertices - sides + t.n_tiles + len(t.holes) == 1
    # contracted: slits are one edge; a disk but for the openings that stay
    staying = int((t.openings.sizes > 0).sum())
    assert t.n_welded - (sides - len(t.edge_pairs)) + t.n_tiles + staying == 1
    assert n_outer_loops(t) == 1 + staying


@every_cell
def test_holes_lie_on_the_left_and_close_but_for_their_openings(cell: UnitCell) -> None:
    t = sheet(cell)
    assert len(t.holes) == len(t.hole_tiles) == len(t.openings) > 0
    for hole, opening in zip(t.holes, t.openings, strict=True):
        assert area(t.deployed[hole]) > 1e-6
        staying = area(t.contracted[t.tiles.indices[opening]]) if len(opening) else 0.0
        assert area(t.contracted[hole]) == pytest.approx(staying, abs=1e-12)
    open_area = sum(area(t.contracted[t.tiles.indices[opening]]) for opening in t.openings if len(opening))
    each = {round(area(opening), 12) for opening in cell.openings} or {0.0}
    assert len(each) == 1
    assert open_area == pytest.approx(each.pop() * (t.openings.sizes > 0).sum(), abs=1e-10)


@every_cell
def test_signed_angles_sum_to_a_full_turn_round_every_ring(cell: UnitCell) -> None:
    t = sheet(cell)
    for points in (t.contracted, t.deployed):
        before, after = (points[t.corners[:, k]] - points[t.corners[:, 1]] for k in (0, 2))
        cross = after[:, 0] * before[:, 1] - after[:, 1] * before[:, 0]
        angles = np.arctan2(cross, (after * before).sum(axis=1)) % (2 * np.pi)
        np.testing.assert_allclose([angles[ring].sum() for ring in t.rings], 2 * np.pi, atol=1e-10)


@pytest.mark.parametrize(
    ("name", "tiles", "holes", "rings", "corners"),
    [
        ("quad", 4, 4, {4}, {4}),
        ("kagome", 8, 4, {6}, {6}),
        ("hexagon", 4, 2, set(), {12}),
        ("islamic-quad", 8, 8, {3}, {6}),
        ("islamic-triangle", 6, 6, {2, 3}, {8}),
        ("rotating-rectangles", 4, 4, {4}, {4}),
        ("right-triangles", 8, 4, {4, 8}, {4, 8}),
        ("trihexagonal", 3, 3, {4}, {4}),
        ("truncated-square", 2, 2, set(), {8}),
    ],
)
def test_what_a_cell_holds(name: str, tiles: int, holes: int, rings: set[int], corners: set[int]) -> None:
    cell = find_cell(name)
    assert len(cell.tiles) == tiles
    t = sheet(cell, 4, 4)
    assert set(t.rings.sizes.tolist()) == rings
    assert set(t.holes.sizes.tolist()) == corners
    # holes per cell: what one more cell adds far from the rim
    more = [len(sheet(cell, *shape).holes) for shape in ((5, 5), (5, 4), (4, 5), (4, 4))]
    assert more[0] - more[1] - more[2] + more[3] == holes


@pytest.mark.parametrize("cells", [1, 2, 4])
def test_counts_of_kagome_sheets(cells: int) -> None:
    t = sheet(kagome_cell(), cells, cells)
    n = 2 * cells
    assert t.n_tiles == 2 * n * n
    assert t.n_welded == (n + 1) ** 2
    assert len(t.rings) == len(t.holes) == (n - 1) ** 2
    assert (t.openings.sizes == 0).all()


def test_hexagons_keep_a_third_of_the_sheet_open_and_sum_to_eight_pi() -> None:
    assert sum(area(opening) for opening in hexagon_cell().openings) == pytest.approx(1 / 3, abs=1e-12)
    t = sheet(hexagon_cell(0.3))
    assert len(t.rings) == 0
    assert set(t.openings.sizes.tolist()) == {6}
    # the twelve tile corners at the six contracted vertices of an opening
    before, after = (t.deployed[t.corners[:, k]] - t.deployed[t.corners[:, 1]] for k in (0, 2))
    angles = np.arctan2(after[:, 0] * before[:, 1] - after[:, 1] * before[:, 0], (after * before).sum(axis=1))
    for opening in t.openings:
        starts = t.tiles.indices[opening]
        around = np.isin(t.weld[t.corners[:, 1]], t.weld[starts])
        assert around.sum() == 12
        assert angles[around].sum() == pytest.approx(8 * np.pi, abs=1e-10)


@pytest.mark.parametrize(("name", "share", "straight"), [("islamic-quad", 1 / 3, 0.0), ("islamic-triangle", 0, 1 / 8)])
def test_islamic_tiles_are_not_convex(name: str, share: float, straight: float) -> None:
    t = sheet(find_cell(name))
    before, after = (t.contracted[t.corners[:, k]] - t.contracted[t.corners[:, 1]] for k in (0, 2))
    angles = np.arctan2(after[:, 0] * before[:, 1] - after[:, 1] * before[:, 0], (after * before).sum(axis=1))
    angles = angles % (2 * np.pi)
    if share:
        assert (angles > np.pi + 1e-9).mean() == pytest.approx(share)
    assert (angles > np.pi + 1e-9).any()
    assert (np.abs(angles - np.pi) < 1e-9).mean() == pytest.approx(2 * straight)


@pytest.mark.parametrize("part", [0.0, 0.3, 1.0])
@pytest.mark.parametrize("name", TURNING)
def test_stretch_follows_the_formula(name: str, part: float) -> None:
    make, most = TURNING[name]
    c = {"quad": 1.0, "kagome": np.sqrt(3), "hexagon": 1 / np.sqrt(3)}[name]
    expected = np.cos(part * most) + c * np.sin(part * most)
    np.testing.assert_allclose(make(part * most).stretches, expected, atol=1e-12)
    if part == 1:
        top = {"quad": np.sqrt(2), "kagome": KAGOME[1], "hexagon": HEXAGON[1]}[name]
        assert expected == pytest.approx(top, abs=1e-12)
        # no rotation stretches further
        assert expected == pytest.approx(np.sqrt(1 + c * c), abs=1e-12)


def test_islamic_stretches_follow_from_the_size_of_what_turns() -> None:
    for x in (0.1, 0.5, 0.9):
        np.testing.assert_allclose(islamic_quad_cell(x).stretches, 1 + x, atol=1e-12)
        np.testing.assert_allclose(islamic_triangle_cell(x).stretches, 1 + x, atol=1e-12)
    np.testing.assert_allclose(islamic_quad_cell().stretches, ISLAMIC_QUAD[1], atol=1e-12)
    np.testing.assert_allclose(islamic_triangle_cell().stretches, ISLAMIC_TRIANGLE[1], atol=1e-12)
    for x in (0.0, 1.0, np.nan):
        with pytest.raises(ParameterError, match="between 0 and 1"):
            islamic_quad_cell(x)
        with pytest.raises(ParameterError, match="between 0 and 1"):
            islamic_triangle_cell(x)


@pytest.mark.parametrize("entry", catalog(), ids=NAMES)
def test_a_cell_moves_where_rigid_periodic_motions_exist(entry) -> None:
    """First order: tiles turn and shift, the lattice deforms, hinges hold; three rigid motions are taken off."""
    cell = entry.cell()
    for points in (cell.deployed, cell.contracted):
        assert (n_motions(cell, points) >= 1) == entry.moves


@pytest.mark.parametrize("entry", catalog(), ids=NAMES)
def test_turning_all_tiles_alike_is_a_path_where_a_cell_moves(entry) -> None:
    """Every tile turns by the same part of its whole turn: the hinges hold all the way, or only at both ends."""
    cell = entry.cell()
    gaps = np.array([hinge_gap(cell, part) for part in (0, 0.25, 0.5, 0.75, 1)])
    assert gaps[[0, -1]].max() < 1e-9
    assert (gaps.max() < 1e-9) == entry.moves


def hinges(cell: UnitCell) -> list[tuple[int, int, int, int, np.ndarray]]:
    """(tile, point, other tile, its point, cells from the first to the other), of the middle of a patch."""
    t = sheet(cell)
    at: dict[int, list[tuple[int, int, np.ndarray]]] = {}
    for place, (vertex, owner) in enumerate(zip(t.tiles.indices, t.tiles.owners, strict=True)):
        *where, which = t.cells[owner].tolist()
        local = cell.tiles[which][place - t.tiles.offsets[owner]]
        at.setdefault(int(vertex), []).append((int(which), int(local), np.array(where)))
    found = []
    for first, *others in at.values():
        found += [(*first[:2], *other[:2], other[2] - first[2]) for other in others]
    return found


def n_motions(cell: UnitCell, points: np.ndarray) -> int:
    k = len(cell.tiles)
    rows = []
    for i, a, j, b, step in hinges(cell):
        for axis in range(2):
            row = np.zeros(3 * k + 4)
            for tile, point, sign in ((i, a, 1), (j, b, -1)):
                row[3 * tile + axis] += sign
                row[3 * tile + 2] += sign * (-points[point, 1], points[point, 0])[axis]
            row[3 * k + axis], row[3 * k + 2 + axis] = -step
            rows.append(row)
    # rigid motions: two translations; a rotation turns tiles and lattice together
    return 3 * k + 4 - np.linalg.matrix_rank(np.array(rows), tol=1e-9) - 3


def hinge_gap(cell: UnitCell, part: float) -> float:
    turned = []
    for tile in cell.tiles:
        a, b = ((p[tile] - p[tile].mean(axis=0)) @ (1, 1j) for p in (cell.contracted, cell.deployed))
        turned.append(part * np.angle((a.conj() * b).sum()))
    k = len(cell.tiles)
    rows, known = [], []
    for i, a, j, b, step in hinges(cell):
        row = np.zeros(k + 2)
        row[i] += 1
        row[j] -= 1
        row[k:] = -step
        rows.append(row)
        p, q = cell.contracted[[a, b]] @ (1, 1j)
        known.append(q * np.exp(1j * turned[j]) - p * np.exp(1j * turned[i]))
    rows, known = np.array(rows), np.array(known)
    solution = np.linalg.lstsq(rows, known, rcond=None)[0]
    return float(np.abs(rows @ solution - known).max())


def test_the_catalog_knows_what_the_spec_names() -> None:
    assert tuple(NAMES[: len(TESSELLATIONS)]) == TESSELLATIONS
    assert len(set(NAMES)) == len(NAMES)
    for entry in catalog():
        assert entry.cell().name == entry.name
        assert entry.title
        if entry.file is not None:
            assert entry.file.stem == entry.name
            assert len(find_cell(str(entry.file)).tiles) == len(entry.cell().tiles)


def test_unknown_names_are_refused() -> None:
    with pytest.raises(ParameterError, match="did you mean 'kagome'"):
        find_cell("kagom")
