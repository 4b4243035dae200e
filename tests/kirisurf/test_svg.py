"""The cut pattern: what is cut falls apart exactly where it should, and the drawing is to scale."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from functools import lru_cache

import numpy as np
import pytest
from shapely import MultiLineString, MultiPoint, Polygon, get_num_geometries

from kirisurf.cuts import Cuts, cuts
from kirisurf.errors import ParameterError, UnusableError
from kirisurf.pattern import quad_pattern, tile_pattern
from kirisurf.svg import svg_text
from kirisurf.tessellation import Tessellation
from kirisurf.unit_cell import quad_cell
from tests.kirisurf import patterns

SVG = "{http://www.w3.org/2000/svg}"
CORNERS = [(0, 0), (0, 1), (3, 3)]


@lru_cache
def pattern(name: str) -> Tessellation:
    if name == "rectangle":
        return quad_pattern(3, 2)
    mask = np.ones((4, 4, 4), bool)
    for column, row in CORNERS:
        mask[column, row] = False
    return tile_pattern(quad_cell(), mask)


def bent(tessellation: Tessellation) -> np.ndarray:
    """Contracted points moved a little, copies together: no two edges are equal or parallel any more."""
    shift = np.random.default_rng(1).uniform(-0.06, 0.06, (tessellation.n_welded, 2))
    return tessellation.contracted + shift[tessellation.weld]


def slit_lengths(tessellation: Tessellation, points: np.ndarray) -> np.ndarray:
    a, b = points[tessellation.edge_pairs[:, 0]].swapaxes(0, 1)
    return np.linalg.norm(b - a, axis=1)


def length(line: np.ndarray) -> float:
    return float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum())


@pytest.mark.parametrize("name", ["rectangle", "trimmed"])
def test_every_slit_is_cut_once_and_shortened_at_its_hinges(name: str) -> None:
    tessellation = pattern(name)
    points = bent(tessellation)
    lines = cuts(tessellation, points, 0.03)
    cut = sum(length(line) for line in lines.slits)
    n_ends = int(tessellation.slit_ends.sum())
    assert len(lines.hinges) == n_ends
    assert cut == pytest.approx(slit_lengths(tessellation, points).sum() - 0.03 * n_ends, abs=1e-12)
    # a notch or a hole each: at the rim a slit has one hinge, inside it has two
    n_notches = 2 * len(lines.slits) - n_ends
    assert len(lines.slits) == len(tessellation.holes) + n_notches


@pytest.mark.parametrize("name", ["rectangle", "trimmed"])
def test_the_cut_sheet_holds_together_until_its_hinges_are_cut(name: str) -> None:
    tessellation = pattern(name)
    lines = cuts(tessellation, bent(tessellation), 0.03)
    sheet = Polygon(lines.outline)
    saw = MultiLineString([line.tolist() for line in lines.slits]).buffer(1e-4)
    left = sheet.difference(saw)
    assert get_num_geometries(left) == 1
    punched = left.difference(MultiPoint(lines.hinges).buffer(0.02))
    assert get_num_geometries(punched) == tessellation.n_tiles
    assert sheet.area == pytest.approx(left.area, rel=0.02)


def test_the_outline_holds_all_tiles() -> None:
    tessellation = pattern("trimmed")
    points = bent(tessellation)
    tiles = [Polygon(points[tile]) for tile in tessellation.tiles]
    assert Polygon(cuts(tessellation, points).outline).area == pytest.approx(sum(tile.area for tile in tiles))


def test_the_automatic_hinge_is_narrow_and_a_wide_one_is_refused() -> None:
    tessellation = pattern("rectangle")
    assert cuts(tessellation, tessellation.contracted).hinge_width == pytest.approx(0.04 * 0.5)
    assert cuts(tessellation, tessellation.contracted, 0.25).hinge_width == 0.25
    for width in (0.26, 0.0, -1.0, float("nan")):
        with pytest.raises(ParameterError, match="--hinge-width: expected"):
            cuts(tessellation, tessellation.contracted, width)
    with pytest.raises(UnusableError, match="expected shape"):
        cuts(tessellation, tessellation.contracted[1:])


def parsed(text: str) -> tuple[ElementTree.Element, dict[str, list[np.ndarray]]]:
    root = ElementTree.fromstring(text)
    layers = {}
    for group in root.findall(f"{SVG}g"):
        paths = [path.attrib["d"] for path in group.findall(f"{SVG}path")]
        layers[group.attrib["id"]] = [
            np.array([[float(x) for x in pair.split(",")] for pair in d.replace("M", "").replace("Z", "").split("L")])
            for d in paths
        ]
    return root, layers


@pytest.mark.parametrize(
    ("units", "factor", "page"),
    [
        (None, 1, "mm"),
        ("mm", 1, "mm"),
        ("cm", 1, "cm"),
        ("m", 1000, "mm"),
        ("um", 0.001, "mm"),
        ("in", 1, "in"),
        ("ft", 12, "in"),
    ],
)
def test_the_drawing_is_to_scale_and_not_mirrored(units: str | None, factor: float, page: str) -> None:
    tessellation = pattern("trimmed")
    lines = cuts(tessellation, 70 * bent(tessellation))
    root, layers = parsed(svg_text(lines, units))
    width, height = (root.attrib[name] for name in ("width", "height"))
    assert width.endswith(page) and height.endswith(page)
    box = [float(x) for x in root.attrib["viewBox"].split()]
    assert [float(width.removesuffix(page)), float(height.removesuffix(page))] == box[2:]
    for drawn, line in zip(layers["cut"], lines.slits, strict=True):
        assert length(drawn) == pytest.approx(factor * length(line), rel=1e-9)
    outline = layers["outline"][0]
    # counter-clockwise in the plane is clockwise by the formula where y points down
    assert -Polygon(outline).exterior.is_ccw == -(not Polygon(lines.outline).exterior.is_ccw)
    assert Polygon(outline).area == pytest.approx(factor**2 * Polygon(lines.outline).area)
    assert outline.min() > 0 and (outline.max(axis=0) < box[2:]).all()
    assert ("assumed" in text_of(root)) == (units is None)


def text_of(root: ElementTree.Element) -> str:
    found = root.find(f"{SVG}desc")
    assert found is not None and found.text
    return found.text


def test_the_layers_are_groups_that_inkscape_knows() -> None:
    tessellation = pattern("rectangle")
    lines = cuts(tessellation, tessellation.contracted)
    root, layers = parsed(svg_text(lines, "mm", "a < b & c"))
    assert list(layers) == ["cut", "hinge", "outline"]
    for group in root.findall(f"{SVG}g"):
        names = {key.rpartition("}")[2]: value for key, value in group.attrib.items()}
        assert names["groupmode"] == "layer" and names["label"] == names["id"]
    assert root.findtext(f"{SVG}title") == "a < b & c"
    circles = root.findall(f"{SVG}g[@id='hinge']/{SVG}circle")
    assert len(circles) == len(lines.hinges)
    assert float(circles[0].attrib["r"]) == pytest.approx(lines.hinge_width / 2)


def test_an_unknown_unit_is_refused() -> None:
    lines = Cuts((), np.zeros((0, 2)), np.array([[0.0, 0], [1, 0], [0, 1]]), 0.1)
    with pytest.raises(ParameterError, match="units: expected one of"):
        svg_text(lines, "parsec")


def test_designed_openings_are_drawn_with_the_outline() -> None:
    tessellation = patterns.pattern("opening")
    lines = cuts(tessellation, 70 * tessellation.contracted, 2.0, 0.5)
    _, layers = parsed(svg_text(lines, "mm"))
    drawn = [Polygon(loop).area for loop in layers["outline"]]
    assert drawn == pytest.approx([Polygon(loop).area for loop in (lines.outline, *lines.openings)])
    assert len(drawn) == 2
