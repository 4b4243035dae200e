"""A few pictures, drawn off-screen and read back."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from kirisurf.errors import OutputError, ParameterError
from viewers import opengl, snapshot
from viewers.scenes import deployed_scene, holes_scene, pattern_scene, standard_scenes, stretch_scene
from viewers.snapshot import LINES, NoOpenGLError, draw, render, render_overview

SMALL = (320, 240)


def share_of(image: np.ndarray, rgb: tuple[int, int, int], within: int = 40) -> float:
    """Part of the pixels that have nearly this color."""
    return float((np.abs(image.astype(int) - rgb).max(axis=2) <= within).mean())


def size_of(path: Path) -> tuple[int, int]:
    with Image.open(path) as image:
        return image.size


@pytest.mark.usefixtures("opengl", "no_open_plotter")
def test_the_flat_pattern_fills_its_frame(sheet):
    image = draw(pattern_scene(sheet), (240, 240), supersampling=1)
    assert image.shape == (240, 240, 3)
    assert (image[:4] == 255).all() and (image[:, -4:] == 255).all()
    # The square sheet fills 0.92 x 0.92 of the picture, but for its lines.
    assert share_of(image, (243, 212, 160)) > 0.6


@pytest.mark.usefixtures("opengl", "no_open_plotter")
def test_curvature_has_the_color_of_its_sign(sheet):
    saddle = draw(holes_scene(sheet, "gaussian_curvature"), SMALL, supersampling=1).astype(int)
    values = -np.asarray(sheet.fields["hole", "gaussian_curvature"])
    turned = replace(sheet, fields={**sheet.fields, ("hole", "gaussian_curvature"): values})
    dome = draw(holes_scene(turned, "gaussian_curvature"), SMALL, supersampling=1).astype(int)
    blue, red = (lambda i: (i[..., 2] - i[..., 0] > 60).mean()), (lambda i: (i[..., 0] - i[..., 2] > 60).mean())
    assert blue(saddle) > 0.02 and red(saddle) == 0
    assert red(dome) > 0.02 and blue(dome) == 0


@pytest.mark.usefixtures("opengl", "no_open_plotter")
def test_tiles_just_below_the_target_are_not_swallowed(sheet):
    sunk = replace(sheet, deployed=sheet.deployed - [0.0, 0.0, 0.01])
    above, below = (draw(deployed_scene(s), SMALL, supersampling=1) for s in (sheet, sunk))
    warm = [((i[..., 0].astype(int) - i[..., 2]) > 30).mean() for i in (above, below)]
    assert warm[0] > 0.1
    assert warm[1] == pytest.approx(warm[0], rel=0.1)


@pytest.mark.usefixtures("opengl", "no_open_plotter")
def test_pictures_are_written_with_the_size_asked_for_and_again_the_same(sheet, tmp_path):
    scene = holes_scene(sheet, "mean_curvature")
    first, second = (render(scene, tmp_path / f"{k}.png", size=SMALL) for k in (1, 2))
    assert size_of(first) == SMALL
    assert first.read_bytes() == second.read_bytes()
    assert [p.name for p in sorted(tmp_path.iterdir())] == ["1.png", "2.png"]


@pytest.mark.usefixtures("opengl", "no_open_plotter")
def test_the_color_bar_marks_what_is_possible(sheet, tmp_path):
    asked = np.linspace(1.0, 2.0, len(sheet.target.vertices))
    scene = stretch_scene(replace(sheet, asked_stretch=asked, possible_stretch=(1.2, 1.4)))
    item = next(item for item in scene.items if item.field is not None)
    bare = replace(item, field=replace(item.field, marks=()))
    plain = replace(scene, items=tuple(bare if other is item else other for other in scene.items))
    with_marks, without = (
        np.asarray(Image.open(render(each, tmp_path / f"{k}.png", (640, 480))).convert("RGB")).astype(int)
        for k, each in enumerate((scene, plain))
    )
    columns = np.flatnonzero((np.abs(with_marks - without).max(axis=2) > 60).any(axis=0))
    groups = np.split(columns, np.flatnonzero(np.diff(columns) > 1) + 1)
    assert len(groups) == 2
    low, high = item.field.limits
    apart = np.diff([group.mean() for group in groups])[0]
    length = 0.64 * (640 - 3.2 * 480 * 1.2 / LINES)
    assert apart / length == pytest.approx(0.2 / (high - low), rel=0.1)


@pytest.mark.usefixtures("opengl", "no_open_plotter")
def test_the_overview_holds_all_scenes_side_by_side(sheet, tmp_path):
    path = render_overview(standard_scenes(sheet), tmp_path / "overview.png", panel=(160, 150))
    assert size_of(path) == (480, 300)
    grid = render_overview(list(standard_scenes(sheet).values()), tmp_path / "grid.png", columns=2, panel=(160, 150))
    assert size_of(grid) == (320, 450)


@pytest.mark.usefixtures("opengl", "no_open_plotter")
def test_a_name_with_a_dollar_sign_is_no_formula(sheet, tmp_path):
    render(replace(pattern_scene(sheet), title="a $broken_{ name"), tmp_path / "p.png", size=SMALL)


@pytest.mark.usefixtures("opengl", "no_open_plotter")
def test_an_unwritable_place_is_an_output_error_and_no_plotter_stays_open(sheet, tmp_path):
    with pytest.raises(OutputError):
        render(pattern_scene(sheet), tmp_path / "missing" / "p.png", size=SMALL)


def test_without_opengl_the_reason_is_raised(sheet, tmp_path, monkeypatch):
    monkeypatch.setattr(snapshot, "probe", lambda: opengl.OpenGL(False, "", "no OpenGL: install it"))
    with pytest.raises(NoOpenGLError, match="no OpenGL: install it"):
        render(pattern_scene(sheet), tmp_path / "p.png")
    assert not list(tmp_path.iterdir())


def test_wrong_sizes_are_refused(sheet, tmp_path):
    with pytest.raises(ParameterError, match="size: expected positive"):
        draw(pattern_scene(sheet), (0, 10))
    with pytest.raises(ParameterError, match="overview: expected scenes"):
        render_overview([], tmp_path / "p.png")


@pytest.fixture
def blank(monkeypatch):
    """Lay pages out without drawing what is on them."""
    monkeypatch.setattr(snapshot, "draw", lambda scene, size, frame: np.full((size[1], size[0], 3), 255, np.uint8))


def texts(figure) -> list[str]:
    return [text.get_text() for text in figure.texts]


@pytest.mark.parametrize(("scale", "power"), [(1.0, ""), (1e-12, r"10^{"), (1e7, r"10^{")])
def test_the_unit_of_a_color_bar_has_the_power_of_its_ticks(sheet, blank, scale, power):
    values = scale * np.asarray(sheet.fields["hole", "gaussian_curvature"])
    scaled = replace(sheet, fields={**sheet.fields, ("hole", "gaussian_curvature"): values})
    figure = snapshot._page([holes_scene(scaled, "gaussian_curvature")], (960, 780), 1, 26.0)
    (unit,) = [text for text in texts(figure) if "mm\u00b2" in text]
    assert (power in unit) if power else unit == "1/mm\u00b2"


@pytest.mark.parametrize("lines", [26.0, 36.0, 46.0])
def test_nothing_on_a_page_runs_into_its_neighbor(sheet, blank, lines):
    flag = np.zeros(len(sheet.holes))
    flag[:3] = 1
    flagged = replace(sheet, fields={**sheet.fields, ("hole", "flag"): flag})
    for scene in (holes_scene(flagged, "mean_curvature"), pattern_scene(sheet)):
        figure = snapshot._page([scene], (960, 780), 1, lines)
        figure.canvas.draw()
        boxes = [text.get_window_extent() for text in figure.texts if text.get_text()]
        for axes in figure.axes:
            low, high = axes.get_xlim()
            shown = [
                label for label in axes.get_xticklabels() if axes.axison and low <= label.get_position()[0] <= high
            ]
            boxes += [label.get_window_extent() for label in shown]
        for k, box in enumerate(boxes):
            assert box.x0 >= 0 and box.x1 <= 960 and box.y0 >= 0 and box.y1 <= 780
            assert not any(box.overlaps(other) for other in boxes[k + 1 :])
