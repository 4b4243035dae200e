"""The mesh of a sheet: its area, its tiles, and that these hang together by ligaments and nowhere else."""

from __future__ import annotations

from collections import defaultdict

import numpy as np
import pytest
import shapely
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from kirisurf.contours import welded_points
from kirisurf.cuts import cuts
from kirisurf.elastic.sheet_mesh import sheet_mesh
from kirisurf.errors import ParameterError
from kirisurf.pattern import tile_pattern
from kirisurf.unit_cells.catalog import catalog, find_cell
from tests.kirisurf.patterns import NAMES, bent, pattern

CELLS = tuple(entry.name for entry in catalog())


def sheet(name):
    if name in CELLS:
        made = tile_pattern(find_cell(name), np.ones((2, 2), bool))
        return made, np.array(made.contracted)
    return pattern(name), bent(pattern(name))


@pytest.fixture(scope="module", params=[*CELLS, *NAMES])
def meshed(request):
    tessellation, contracted = sheet(request.param)
    return tessellation, contracted, sheet_mesh(tessellation, contracted, refinement=2)


def owners(mesh) -> dict[int, set[int]]:
    found = defaultdict(set)
    for tile, nodes in zip(mesh.tiles.tolist(), mesh.triangles.tolist(), strict=True):
        for node in nodes:
            found[node].add(tile)
    return found


def test_areas_add_up_and_no_triangle_is_turned_over(meshed):
    tessellation, contracted, mesh = meshed
    places = welded_points(tessellation, contracted)[tessellation.weld]
    tiles = [shapely.Polygon(places[tile]).area for tile in tessellation.tiles]
    assert mesh.areas.min() > 0
    assert np.bincount(mesh.tiles, mesh.areas) == pytest.approx(tiles, rel=1e-11)
    assert np.degrees(mesh.smallest_angle) > 12


def test_middle_nodes_lie_in_the_middle_and_every_node_is_used(meshed):
    _, _, mesh = meshed
    corner = mesh.nodes[mesh.triangles[:, :3]]
    assert np.abs(mesh.nodes[mesh.triangles[:, 3:]] - 0.5 * (corner + np.roll(corner, -1, axis=1))).max() < 1e-12
    assert np.array_equal(np.unique(mesh.triangles), np.arange(len(mesh.nodes)))


def test_vertices_keep_their_places_and_tiles(meshed):
    tessellation, contracted, mesh = meshed
    places = welded_points(tessellation, contracted)[tessellation.weld]
    assert np.abs(mesh.nodes[mesh.vertices] - places).max() < 1e-12
    of = owners(mesh)
    for k, tile in enumerate(tessellation.tiles):
        assert all(k in of[int(mesh.vertices[v])] for v in tile)


def test_tiles_share_the_nodes_of_ligaments_and_no_others(meshed):
    tessellation, _, mesh = meshed
    shared = {node for node, tiles in owners(mesh).items() if len(tiles) > 1}
    ligament = set(np.concatenate(mesh.ligaments).tolist())
    middles = set()
    for nodes in mesh.ligaments:
        sides = {frozenset(pair) for pair in zip(nodes[:-1].tolist(), nodes[1:].tolist(), strict=True)}
        for row in mesh.triangles.tolist():
            for i in range(3):
                if frozenset((row[i], row[(i + 1) % 3])) in sides:
                    middles.add(row[3 + i])
    bare = set(mesh.vertices[tessellation.hinges[:, 1]].tolist()) - ligament
    assert shared == ligament | middles | bare
    assert len(middles) == sum(len(nodes) - 1 for nodes in mesh.ligaments)


def test_ligaments_are_those_of_the_cut_pattern(meshed):
    tessellation, contracted, mesh = meshed
    lines = cuts(tessellation, contracted)
    assert len(mesh.ligaments) == len(lines.hinges)
    assert mesh.bare == lines.bare
    tips = np.concatenate([line[[0, -1]] for line in lines.slits])
    for vertex, tip in mesh.hinges:
        assert np.linalg.norm(tips - mesh.nodes[tip], axis=1).min() < 1e-9
        assert vertex in tessellation.hinges[:, 1]
    found = [np.linalg.norm(mesh.nodes[nodes[-1]] - mesh.nodes[nodes[0]]) for nodes in mesh.ligaments]
    assert mesh.widths == pytest.approx(found, rel=1e-12)


def test_without_its_ligaments_the_sheet_falls_into_its_tiles(meshed):
    _, _, mesh = meshed
    of = owners(mesh)
    kept = {node for node, tiles in of.items() if len(tiles) == 1}
    rows, columns = [], []
    for triangle in mesh.triangles.tolist():
        own = [node for node in triangle if node in kept]
        rows += own[:-1]
        columns += own[1:]
    n = len(mesh.nodes)
    _, labels = connected_components(coo_matrix((np.ones(len(rows)), (rows, columns)), shape=(n, n)), directed=False)
    parts = {int(labels[node]): next(iter(of[node])) for node in kept}
    assert all(parts[int(labels[node])] == next(iter(of[node])) for node in kept)


def test_more_elements_stand_across_a_ligament_when_asked():
    tessellation, contracted = sheet("quad")
    for refinement in (2, 4, 8):
        mesh = sheet_mesh(tessellation, contracted, 0.04, refinement)
        assert min(len(nodes) - 1 for nodes in mesh.ligaments) >= refinement


def test_scale_changes_nothing_but_lengths():
    tessellation, contracted = sheet("kagome")
    one, two = sheet_mesh(tessellation, contracted, 0.02), sheet_mesh(tessellation, 1000 * contracted, 20.0)
    assert len(one.triangles) == len(two.triangles)
    assert two.areas.sum() == pytest.approx(1e6 * one.areas.sum(), rel=1e-9)


def test_wrong_lengths_are_named():
    tessellation, contracted = sheet("quad")
    with pytest.raises(ParameterError, match="--hinge-width"):
        sheet_mesh(tessellation, contracted, 10.0)
    with pytest.raises(ParameterError, match="refinement"):
        sheet_mesh(tessellation, contracted, refinement=0)
