"""Our cells against the published tables and sheets of Choi, Dudte and Mahadevan, where they lie beside the project."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from analysis.sheet import coincident, read_sheet
from kirisurf.formats import read_polygons
from kirisurf.pattern import tile_pattern
from kirisurf.tessellation import Tessellation
from kirisurf.unit_cell import UnitCell
from kirisurf.unit_cells import find_cell

# name, folder, tables of faces, end of the other tables' names, digits of the tables
TABLES = [
    ("quad", "square", ["faces_sq"], "sq", 1e-8),
    ("kagome", "triangle", ["faces_tr"], "tr", 1e-8),
    ("hexagon", "hexagon", ["faces_hex"], "hex", 1e-4),
    ("islamic-quad", "islamicquad", ["faces_1_four_fold", "faces_2_four_fold"], "four_fold", 1e-8),
    ("islamic-triangle", "islamictriangle", ["faces_1_hex", "faces_2_hex"], "hex", 1e-8),
]


@pytest.mark.parametrize(("name", "folder", "faces", "end", "digits"), TABLES, ids=[row[0] for row in TABLES])
def test_cells_are_the_published_ones(
    reference: Path, name: str, folder: str, faces: list[str], end: str, digits: float
) -> None:
    tables = reference / "reference" / "choi2019" / "unit_cells" / folder
    cell = find_cell(name)
    shifts = {state: np.loadtxt(tables / f"shift_{end}_{state}.txt") for state in "0D"}
    scale = abs(np.linalg.det(shifts["0"])) ** -0.5
    theirs = []
    for table in faces:
        loops = {state: np.loadtxt(tables / f"{table}_{state}.txt", dtype=int) - 1 for state in "0D"}
        points = {state: scale * np.loadtxt(tables / f"points_{end}_{state}.txt") for state in "0D"}
        theirs += [np.hstack([points["0"][a], points["D"][b]]) for a, b in zip(loops["0"], loops["D"], strict=True)]
    ours = [np.hstack([cell.contracted[tile], cell.deployed[tile]]) for tile in cell.tiles]

    np.testing.assert_allclose(cell.contracted_shifts, scale * shifts["0"], atol=4 * digits)
    np.testing.assert_allclose(cell.deployed_shifts, scale * shifts["D"], atol=4 * digits)
    # one translation in each state lays all their tiles on ours, both states by the same cells
    found = [same_pattern(cell, ours, theirs, start, 10 * digits) for start in places(ours, theirs[0])]
    assert any(found)


def places(ours: list[np.ndarray], tile: np.ndarray) -> list[np.ndarray]:
    """Translations (4,) that lay the first corner of a tile on some corner of ours."""
    return [corner - tile[0] for other in ours if len(other) == len(tile) for corner in other]


def same_pattern(
    cell: UnitCell, ours: list[np.ndarray], theirs: list[np.ndarray], by: np.ndarray, radius: float
) -> bool:
    shifts = np.hstack([cell.contracted_shifts, cell.deployed_shifts])
    hit = set()
    for tile in theirs:
        for k, other in enumerate(ours):
            if len(other) != len(tile):
                continue
            for turn in range(len(tile)):
                gap = np.roll(tile, turn, axis=0) + by - other
                cells = np.round(gap[0, :2] @ np.linalg.inv(cell.contracted_shifts))
                if np.abs(gap - cells @ shifts).max() < radius:
                    hit.add(k)
                    break
            else:
                continue
            break
        else:
            return False
    return hit == set(range(len(ours)))


@pytest.mark.parametrize(
    ("name", "file", "shape"),
    [
        ("quad", "quad_rect_w8_h8_i1_f0_r0", (8, 8)),
        ("kagome", "triangle_rainbow_w2_h2_i4_f0_r0", (2, 2)),
        ("kagome", "triangle_egg_w6_h7_i4_f1_r0", (6, 7)),
        ("hexagon", "hexagon_circle_w5_h3_i3_f0", (5, 3)),
        ("hexagon", "hexagon_rainbow_w4_h2_i4_f1", (4, 2)),
        ("hexagon", "hexagon_wedge_w4_h3_i4_f0", (4, 3)),
        ("islamic-quad", "islamicquad_rect_w3_h3_i4", (3, 3)),
        ("islamic-quad", "islamicquad_wedge_w2_h3_i4", (2, 3)),
        ("islamic-triangle", "islamictriangle_rainbow_w4_h2_i4", (4, 2)),
    ],
)
def test_sheets_have_the_published_combinatorics(reference: Path, name: str, file: str, shape: tuple[int, int]) -> None:
    folder = reference / "reference" / "choi2019" / "2d"
    deployed, tiles = read_polygons(folder / f"{file}_deployed.obj")
    contracted, _ = read_polygons(folder / f"{file}_contracted.obj")
    size = np.median(np.linalg.norm(np.diff(deployed[tiles.edges], axis=1), axis=-1))
    sheet = read_sheet(deployed, contracted[:, :2], tiles, coincident(contracted, 3e-3 * size))
    assert sheet.tessellation is not None
    assert counts(sheet.tessellation) == counts(tile_pattern(find_cell(name), published_mask(name, shape)))


def published_mask(name: str, shape: tuple[int, int]) -> np.ndarray:
    mask = np.ones((*shape, len(find_cell(name).tiles)), bool)
    if name == "hexagon":
        # they close the first column's rings: the right half of one more column on the left
        mask = np.concatenate([np.ones((1, *mask.shape[1:]), bool), mask])
        mask[0, :, [0, 3]] = False
    return mask


def counts(t: Tessellation) -> dict[str, object]:
    return {
        "tiles": t.n_tiles,
        "vertices": t.n_vertices,
        "welded": t.n_welded,
        "slits": len(t.edge_pairs),
        "hinges": len(t.hinges),
        "slit ends": int(t.slit_ends.sum()),
        "holes": sorted(t.holes.sizes.tolist()),
        "tiles round holes": sorted(t.hole_tiles.sizes.tolist()),
        "openings": sorted(t.openings.sizes.tolist()),
        "rings": sorted(t.rings.sizes.tolist()),
    }
