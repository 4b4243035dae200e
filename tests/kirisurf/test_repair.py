"""Repair and remeshing in a child process: what it mends, what it keeps, and how it fails."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

from kirisurf import repair
from kirisurf.errors import ParameterError, UnusableError
from kirisurf.repair import decimated, remeshed, repaired, repaired_with_notes
from kirisurf.surface import Surface
from kirisurf.topology import examine, require_disk

needs_meshlab = pytest.mark.skipif(
    importlib.util.find_spec("pymeshlab") is None,
    reason="repair and remeshing did not run: pymeshlab (kirisurf[repair]) is not installed",
)


def grid(n: int = 12, height: float = 0.3, scale: float = 1.0, offset: float = 0.0) -> Surface:
    x, y = np.meshgrid(np.linspace(-1, 1, n), np.linspace(-1, 1, n))
    points = scale * np.stack([x.ravel(), y.ravel(), height * (x * y).ravel()], axis=1) + offset
    at = np.arange(n * n).reshape(n, n)
    a, b, c, d = at[:-1, :-1].ravel(), at[:-1, 1:].ravel(), at[1:, 1:].ravel(), at[1:, :-1].ravel()
    return Surface.from_arrays(points, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]), "grid")


def rim_distance(points: np.ndarray, surface: Surface) -> float:
    """Largest distance of points to the surface's boundary polyline."""
    loop = surface.vertices[surface.boundary_loops[0]]
    a, ab = loop, np.roll(loop, -1, axis=0) - loop
    t = np.clip(np.einsum("pki,ki->pk", points[:, None] - a, ab) / (ab**2).sum(axis=1), 0, 1)
    return float(np.linalg.norm(points[:, None] - a - t[..., None] * ab, axis=2).min(axis=1).max())


@needs_meshlab
def test_holes_are_filled_and_the_outline_stays() -> None:
    sheet = grid()
    holed = Surface.from_arrays(sheet.vertices, np.delete(sheet.faces, [40, 41, 100, 170, 171], axis=0), "holed")
    used = np.unique(holed.faces)
    assert len(used) == len(holed.vertices) and len(examine(holed).boundary_sizes) > 1
    mended, notes = repaired_with_notes(holed)
    assert require_disk(mended).area == pytest.approx(sheet.area, rel=1e-3)
    assert len(mended.boundary_loops[0]) == 44
    assert "filled" in notes[-1]
    assert len(examine(repaired(holed, close_holes=False)).boundary_sizes) == len(examine(holed).boundary_sizes)


@needs_meshlab
def test_branches_copies_and_other_pieces_go() -> None:
    sheet = grid()
    fin = len(sheet.vertices)
    points = np.vstack([sheet.vertices, [[0, 0, 0.05]], grid(4).vertices * 0.2 + 9])
    inner = sheet.faces[60]
    faces = np.vstack([
        sheet.faces,
        [[inner[0], inner[1], fin]],
        sheet.faces[[7]][:, [1, 2, 0]],
        grid(4).faces + fin + 1,
    ])  # fmt: skip
    broken = Surface.from_arrays(points, faces, "broken")
    assert not examine(broken).is_disk
    mended, notes = repaired_with_notes(broken)
    assert require_disk(mended).area == pytest.approx(sheet.area, rel=0.02)
    assert "largest of" in " ".join(notes)
    assert len(examine(repaired(broken, keep_largest=False)).component_sizes) > 1


@needs_meshlab
def test_what_cannot_be_mended_says_so() -> None:
    points = np.random.default_rng(0).random((90, 3))
    soup = Surface.from_arrays(points, np.arange(90).reshape(-1, 3), "soup")
    with pytest.raises(UnusableError, match="30 pieces of which the largest"):
        repaired(soup)


@needs_meshlab
@pytest.mark.parametrize(("scale", "offset"), [(1.0, 0.0), (1e-6, 0.0), (1e6, 3e7)])
def test_remeshing_keeps_the_surface_and_its_rim(scale: float, offset: float) -> None:
    sheet = grid(scale=scale, offset=offset)
    fine = remeshed(sheet, 0.1 * scale)
    assert require_disk(fine).area == pytest.approx(sheet.area, rel=2e-3)
    assert rim_distance(fine.vertices[fine.boundary_loops[0]], sheet) < 1e-3 * scale
    assert rim_distance(sheet.vertices[sheet.boundary_loops[0]], fine) < 0.05 * scale
    edges = np.linalg.norm(fine.vertices[fine.faces] - fine.vertices[np.roll(fine.faces, -1, axis=1)], axis=2)
    assert np.median(edges) == pytest.approx(0.1 * scale, rel=0.2)


@needs_meshlab
def test_number_of_faces_and_decimation() -> None:
    sheet = grid(24)
    assert len(remeshed(sheet, n_faces=400).faces) == pytest.approx(400, rel=0.25)
    coarse = decimated(sheet, 300)
    assert 100 < len(coarse.faces) <= 300 and require_disk(coarse).area == pytest.approx(sheet.area, rel=0.01)
    assert decimated(sheet, 10**9) is sheet


@needs_meshlab
def test_remeshing_that_loses_the_surface_is_refused() -> None:
    sheet = grid()
    x, y, _ = sheet.vertices.T
    squashed = Surface.from_arrays(np.stack([x, 1e-8 * y, 0.3 * np.sin(9 * y) * np.cos(2 * x)], axis=1), sheet.faces)
    with pytest.raises(UnusableError, match="expected remeshing to keep"):
        remeshed(squashed, n_faces=200)


def test_wrong_parameters() -> None:
    sheet = grid(4)
    for wrong in ({}, {"target_edge_length": 0.1, "n_faces": 7}, {"n_faces": 0}, {"target_edge_length": float("nan")}):
        with pytest.raises(ParameterError, match="for remeshing"):
            remeshed(sheet, **wrong)
    with pytest.raises(ParameterError, match="at most 5000000 faces"):
        remeshed(sheet, 1e-6)
    with pytest.raises(ParameterError, match="positive number of faces"):
        decimated(sheet, 0)


def test_without_pymeshlab_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(ParameterError, match=r"kirisurf\[repair\]"):
        repaired(grid(4))


@pytest.mark.parametrize(
    ("script", "message"),
    [
        ("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)", "death by SIGSEGV"),
        ("import time; time.sleep(60)", "no answer within 1 s"),
        ('print(\'{"error": "out of ideas"}\')', "out of ideas"),
        ("raise ImportError('libGL.so.1: cannot open')", "libGL"),
    ],
)
def test_a_child_that_fails_is_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, script: str, message: str
) -> None:
    worker = tmp_path / "worker.py"
    worker.write_text(script)
    monkeypatch.setattr(repair, "_WORKER", worker)
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: object())
    with pytest.raises(UnusableError, match=f"grid: expected repair to end with a surface, got: .*{message}"):
        repaired(grid(4), seconds=1 if "sleep" in script else 60)


@needs_meshlab
def test_pymeshlab_is_never_imported_here() -> None:
    repaired(grid(4))
    assert "pymeshlab" not in sys.modules
