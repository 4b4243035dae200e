"""The gallery: every sample surface and outline is fitted, certified, and held against one number of its formula."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import kirisurf
import kirisurf.cli as cli
import sample_surfaces
from docs.gallery.example import Example, Measured
from docs.gallery.geometry import chord_loss, plan_integral, polygon_area, summit
from docs.gallery.outlines import OUTLINES
from docs.gallery.surfaces import SURFACES
from docs.pictures import strip
from kirisurf import outlines
from kirisurf.spec import FitSpec

FOLDER = Path(__file__).resolve().parents[2] / "docs"
PAGE = (FOLDER / "gallery.md").read_text(encoding="utf-8")
LARGEST, LARGEST_OF_ALL = 120_000, 2_500_000
"""Bytes of a picture, and of the documentation as a whole."""

LONG = {"car_hood", "circle", "disc", "face_mask", "letter-s"}
EXAMPLES = [pytest.param(e, id=e.name, marks=[pytest.mark.slow] if e.name in LONG else []) for e in SURFACES + OUTLINES]


@pytest.mark.parametrize("example", EXAMPLES)
def test_an_example_meets_its_number(example: Example) -> None:
    design = example.design()
    assert design.status is kirisurf.Status.CONVERGED
    assert design.certificate.failures == ()
    found = example.measure(design)
    assert found.is_met, (
        f"{example.quantity}: expected {found.expected:.6g} +- {found.tolerance:.2g}, got {found.value}"
    )


def test_every_sample_is_an_example() -> None:
    assert sorted(each.name for each in SURFACES) == sorted(sample_surfaces.names())
    assert sorted(each.name for each in OUTLINES) == sorted(outlines.names())


@pytest.mark.parametrize("example", SURFACES + OUTLINES, ids=lambda each: each.name)
def test_the_page_shows_what_the_command_makes(example: Example) -> None:
    """The line of the page parses to the options of the test, and the picture is there and small."""
    words = example.command.split()
    assert f"\n{example.command}\n" in PAGE
    assert f"](gallery/{example.name}.png)" in PAGE
    arguments = cli.build_parser().parse_args(words[1:])
    given = {name: getattr(arguments, name) for name in example.options}
    assert FitSpec(target=example.name, **given) == FitSpec(target=example.name, **example.options)
    picture = FOLDER / "gallery" / f"{example.name}.png"
    assert picture.stat().st_size <= LARGEST
    with Image.open(picture) as image:
        assert image.width >= 900


def test_the_page_shows_no_number_that_is_off() -> None:
    """Each number on the page is within the tolerance beside it (a redrawn page cannot hide a failing example)."""
    rows = re.findall(r"\*\*([−\d.e]+)[^*]*\*\*,\s+expected\s+([−\d.e]+)\s+±\s+([\d.e−]+)", PAGE)
    assert len(rows) == len(SURFACES + OUTLINES)
    for value, expected, tolerance in rows:
        numbers = [float(text.replace("−", "-")) for text in (value, expected, tolerance)]
        assert abs(numbers[0] - numbers[1]) <= numbers[2] + 1e-4 * abs(numbers[1])


def test_documentation_is_small() -> None:
    sizes = [path.stat().st_size for path in FOLDER.rglob("*") if path.is_file() and "__pycache__" not in path.parts]
    assert sum(sizes) <= LARGEST_OF_ALL


@pytest.mark.parametrize("off", [0.0, 0.9, 1.1])
def test_a_number_is_met_within_its_tolerance(off: float) -> None:
    assert Measured(2.0 + off * 1e-3, 2.0, 1e-3).is_met is (off < 1)


def test_a_number_that_is_none_is_not_met() -> None:
    assert not Measured(float("nan"), 2.0, 1e-3).is_met


def test_tiles_of_an_exact_sphere_are_cyclic() -> None:
    """Four corners in a plane and on a sphere lie on a circle: opposite angles of a quadrilateral sum to pi."""
    design = kirisurf.fit("sphere", cells=(4, 4), closeness="exact")
    corners = design.deployed_points[np.array(list(design.tessellation.tiles))]
    back, ahead = np.roll(corners, 1, axis=1) - corners, np.roll(corners, -1, axis=1) - corners
    cosine = (back * ahead).sum(axis=2) / np.linalg.norm(back, axis=2) / np.linalg.norm(ahead, axis=2)
    angles = np.arccos(cosine)
    assert angles[:, 0] + angles[:, 2] == pytest.approx(np.full(len(corners), np.pi), abs=1e-6)


def test_plan_integral_is_exact_for_planes_and_converges_with_second_order() -> None:
    rng = np.random.default_rng(5)
    corners = rng.normal(size=(4, 3, 3))
    area = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2]
    plane = plan_integral(corners, lambda x, y: 2 * x - y + 1, 3)
    assert plane == pytest.approx(area @ (corners.mean(axis=1)[:, :2] @ (2, -1) + 1), abs=1e-12)
    exact = plan_integral(corners, lambda x, y: np.cos(x + 2 * y), 128)
    off = [abs(plan_integral(corners, lambda x, y: np.cos(x + 2 * y), parts) - exact) for parts in (4, 8, 16)]
    assert np.log2(off[0] / off[1]) > 1.7 and np.log2(off[1] / off[2]) > 1.7


def test_summit_of_a_known_hill() -> None:
    height, curvature = summit(lambda x, y: 3 - (x - 0.2) ** 2 - 2 * (y + 0.1) ** 2, 1.0)
    assert height == pytest.approx(3.0, abs=1e-5) and curvature == pytest.approx(4.0, abs=1e-6)


def test_a_polygon_in_a_circle_loses_what_is_allowed_for() -> None:
    turn = 2 * np.pi * np.arange(40) / 40
    points = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    assert np.pi - polygon_area(points) == pytest.approx(chord_loss(points, 1.0), rel=0.01)


def test_a_strip_of_outlines_has_a_panel_for_each_state(tmp_path: Path) -> None:
    designs = [("one", kirisurf.fit("rect", cells=(1, 1))), ("two", kirisurf.fit("shear", cells=(1, 1)))]
    strip.outlines(designs, tmp_path / "strip.png", (120, 90))
    with Image.open(tmp_path / "strip.png") as picture:
        assert picture.size == (4 * 120, strip.HEAD + 90 + strip.BAR)
        assert picture.mode == "P" and picture.convert("RGB").getpixel((0, 0)) == (255, 255, 255)
    with pytest.raises(ValueError, match="expected a planar outline, got a surface"):
        strip.outlines([("", kirisurf.fit("hypar", cells=(1, 1)))], tmp_path / "no.png", (120, 90))


@pytest.mark.usefixtures("opengl")
def test_a_strip_of_surfaces_has_a_row_for_each_design(tmp_path: Path) -> None:
    design = kirisurf.fit("hypar", cells=(2, 2))
    strip.surfaces([("a", design), ("b", design)], tmp_path / "strip.png", (120, 90), ("target", "gaussian_curvature"))
    with Image.open(tmp_path / "strip.png") as picture:
        assert picture.size == (strip.HEAD + 2 * 120, strip.HEAD + 2 * (90 + strip.BAR))
        assert len(picture.convert("RGB").getcolors(10**6)) > 20
