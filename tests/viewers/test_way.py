"""The computed way of a sheet in the workbench: its states, its label, and when it is left out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import kirisurf
from kirisurf.deploying import deploy_with_collisions, save_deployment
from kirisurf.deployment_folder import deployment_folder, read_way
from kirisurf.runs import Run
from viewers.way import Way
from viewers.workbench.opening import opened_run
from viewers.workbench.poses import Poses
from viewers.workbench.scene import deployed_view

STEPS = 4


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    """A sheet in space with its deployment."""
    design = kirisurf.fit("hypar", cells=(2, 2))
    made = design.save(tmp_path_factory.mktemp("way") / "hypar", pictures=False)
    with deployment_folder(made) as folder:
        save_deployment(deploy_with_collisions(made, steps=STEPS, torsion=(0.0,)), folder, animation=False)
    return made


def test_states_are_met_and_between_them_the_way_is_straight() -> None:
    states = np.random.default_rng(1).normal(size=(5, 7, 3))
    way = Way(states, 1e-3, "rim")
    for k in range(5):
        np.testing.assert_allclose(way.at(k / 4), states[k], atol=1e-15)
    np.testing.assert_allclose(way.at(0.375), 0.5 * (states[1] + states[2]), atol=1e-15)
    assert way.at(-1.0).tolist() == way.at(0.0).tolist() and way.at(2.0).tolist() == way.at(1.0).tolist()
    assert way.words == "physical path, lambda = 0.001, rim drive"


def test_the_slider_moves_the_sheet_along_its_path_and_says_so(run: Run) -> None:
    state, results = opened_run(str(run.folder))
    sheet = results.sheet
    assert sheet is not None and sheet.way is not None and len(sheet.way.states) == STEPS + 1
    poses = Poses(sheet)
    tiles = sheet.tiles.edges
    lengths = np.linalg.norm(sheet.deployed[tiles[:, 0]] - sheet.deployed[tiles[:, 1]], axis=1)
    for k in range(STEPS + 1):
        points = poses.at(k / STEPS)
        # tiles are rigid in every state of the path, as no interpolation leaves them
        found = np.linalg.norm(points[tiles[:, 0]] - points[tiles[:, 1]], axis=1)
        np.testing.assert_allclose(found, lengths, rtol=1e-7)
    shown = deployed_view(state.deployed_to(0.5), results)
    assert "physical path, lambda = 0, free drive" in shown.note and "Interpolated" not in shown.title
    without = replace(results, sheet=replace(sheet, way=None))
    shown = deployed_view(state.deployed_to(0.5), without)
    assert "Interpolated" in shown.title and "physical" not in shown.note
    assert np.abs(Poses(without.sheet).at(0.5) - poses.at(0.5)).max() > 1e-3


def test_a_run_opens_though_its_deployment_is_broken(run: Run) -> None:
    assert read_way(run) is not None
    frame = run.folder / "deployment" / "deployment_pvd" / "0002_tiles.vtp"
    content = frame.read_bytes()
    record = run.folder / "deployment" / "deployment.json"
    text = record.read_text(encoding="utf-8")
    try:
        for broken in (content[:-40], b""):
            frame.write_bytes(broken)
            assert read_way(run) is None
        frame.unlink()
        assert read_way(run) is None
        frame.write_bytes(content)
        for broken_text in ("{", "[]", '{"paths": []}'):
            record.write_text(broken_text, encoding="utf-8")
            assert read_way(run) is None
        sheet = opened_run(str(run.folder))[1].sheet
        assert sheet is not None and sheet.way is None
    finally:
        frame.write_bytes(content)
        record.write_text(text, encoding="utf-8")
    assert read_way(run) is not None
