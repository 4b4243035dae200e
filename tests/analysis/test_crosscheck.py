"""The certificate against an independent recomputation from the same files, where that is at hand."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from analysis.certificate import certify
from analysis.sheet import coincident
from kirisurf.loops import Loops
from kirisurf.surface import Surface

PUBLISHED = [
    "3d/quad_hypar_w4_h4_i3_f0_r0",
    "3d/quad_mexicanhat2_w4_h4_i1_f0_r0",
    "3d/triangle_peaks_w3_h4_i3_f1_r0",
    "3d/triangle_sphere_w3_h4_i3_f0_r0",
    "2d/islamicquad_anvil_w3_h2_i4",
    "2d/islamictriangle_wedge_w3_h3_i4",
    "2d/triangle_circle_w3_h3_i1_f0_r0",
    "2d/quad_circle_w5_h5_i3_f1_r1",
    "2d/hexagon_anvil_w4_h2_i4_f1",
]
RIGID = ("length", "angle", "planarity", "isometry")


def read(path: Path) -> tuple[np.ndarray, list[list[int]]]:
    lines = [line.split() for line in path.read_text().splitlines()]
    vertices = [[float(x) for x in line[1:4]] for line in lines if line[:1] == ["v"]]
    tiles = [[int(word.split("/")[0]) - 1 for word in line[1:]] for line in lines if line[:1] == ["f"]]
    return np.array([v + [0.0] * (3 - len(v)) for v in vertices]), tiles


def write(path: Path, points: np.ndarray, tiles: Loops | np.ndarray) -> Path:
    lines = ["v " + " ".join(map(repr, map(float, p))) for p in points]
    lines += ["f " + " ".join(str(int(k) + 1) for k in tile) for tile in tiles]
    path.write_text("\n".join(lines) + "\n")
    return path


def audited(script: Path, *arguments: object) -> dict:
    done = subprocess.run(
        [sys.executable, str(script), *map(str, arguments)], capture_output=True, text=True, timeout=600, check=True
    )
    return json.loads(done.stdout)


@pytest.mark.parametrize("name", PUBLISHED)
def test_rigid_rows_of_published_results_agree(reference, name):
    files = [reference / "reference" / "choi2019" / f"{name}_{state}.obj" for state in ("deployed", "contracted")]
    (deployed, tiles), (contracted, _) = map(read, files)
    length = certify(deployed, contracted, Loops.from_lists(tiles)).edge_length
    # their copies coincide only roughly
    radius = 1e-2
    ours = certify(deployed, contracted, Loops.from_lists(tiles), weld=coincident(contracted, radius * length))
    theirs = audited(reference / "audit.py", *files, "--weld", radius)
    for row in RIGID:
        if row == "angle" and theirs[row] is None:
            # no inner point that tiles close round: only ours knows the law of the openings
            assert 0 < ours.rows[row] < 1e-2 and ours.rows["loop"] < 1e-2
        else:
            assert ours.rows[row] == pytest.approx(theirs[row], rel=1e-6, abs=1e-12), row
    assert ours.rows["min_edge"] == pytest.approx(theirs["min_edge"])
    assert ours.rows["intersections"] == theirs["intersections"]
    assert ours.rows["gap_contracted"] == pytest.approx(theirs["flat_gap"], abs=1e-6)
    assert not ours.passed


def test_sound_design_and_its_target_rows_agree(reference, flat_design, tmp_path):
    design = flat_design(4, 4)
    side = np.linspace(-2.9, 2.9, 12)
    x, y = (q.ravel() for q in np.meshgrid(side, side))
    number = np.arange(144).reshape(12, 12)
    a, b, c, d = (q.ravel() for q in (number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]))
    target = Surface.from_arrays(np.c_[x, y, 0.1 + 0.02 * x * y], np.r_[np.c_[a, b, c], np.c_[a, c, d]])
    files = (
        write(tmp_path / "deployed.obj", design.deployed, design.tiles),
        write(tmp_path / "contracted.obj", np.pad(design.contracted, ((0, 0), (0, 1))), design.tiles),
        "--target",
        write(tmp_path / "target.obj", target.vertices, target.faces),
    )
    theirs = audited(reference / "audit.py", *files)
    ours = certify(design.deployed, design.contracted, design.tiles, target)
    assert ours.passed, ours.failures
    assert (ours.pieces, ours.flipped) == (theirs["pieces"], theirs["flipped"])
    for row in (*RIGID, "closure"):
        assert max(ours.rows[row], theirs[row]) <= 1e-12
    assert ours.rows["distance_rms"] == pytest.approx(theirs["distance_rms"])
    assert ours.rows["distance_max"] == pytest.approx(theirs["distance_max"])
    # theirs reaches to tiles only, ours to the patches of the holes as well
    assert ours.rows["reach_rms"] <= theirs["reach_rms"]
    assert ours.rows["reach_max"] == pytest.approx(theirs["reach_max"], rel=0.05)
