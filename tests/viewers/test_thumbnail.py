"""Thumbnails: the same picture for the same sheet in whatever unit and place, near tiles over far ones."""

from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image
from scipy.spatial import ConvexHull

from kirisurf.errors import ParameterError
from kirisurf.loops import Loops
from kirisurf.pattern import quad_pattern
from kirisurf.surface import Surface
from viewers.framing import choose_view, fit_frame
from viewers.thumbnail import SIZE, thumbnail

SQUARE = Loops.from_lists([[0, 1, 2, 3]])
CORNERS = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])


def pixels(png: bytes) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(int)


def lifted(height, cells: int = 3):
    """A regular quad pattern lifted onto z = height(x, y), in [-1, 1]^2."""
    pattern = quad_pattern(cells, cells)
    low, high = pattern.deployed.min(axis=0), pattern.deployed.max(axis=0)
    flat = (2 * pattern.deployed - low - high) / (high - low).max()
    return np.column_stack([flat, height(*flat.T)]), pattern.tiles, pattern.holes


SHEETS = {
    "flat": lambda x, y: 0 * x,
    "bowl": lambda x, y: 0.5 * (x**2 + y**2),
    "saddle": lambda x, y: 0.5 * x * y,
    "tilted": lambda x, y: 0.3 * x - 0.4 * y,
    "waves": lambda x, y: 0.2 * np.sin(4 * x) + 0.1 * y,
}


@pytest.fixture(params=SHEETS)
def curved(request):
    return lifted(SHEETS[request.param])


def test_same_sheet_same_bytes(curved):
    assert thumbnail(*curved) == thumbnail(*curved)


@pytest.mark.parametrize("scale", [1e-12, 1 / 3, 25.4, 1e9])
@pytest.mark.parametrize("shift", [(0.0, 0.0, 0.0), (1e5, -3e4, 777.25)])
def test_unit_and_place_change_no_pixel(curved, scale, shift):
    points, tiles, holes = curved
    # a shift far beyond the size leaves fewer digits: far enough for any map, near enough for a pixel
    moved = points * scale + np.array(shift) * min(scale, 1e6)
    assert np.array_equal(pixels(thumbnail(moved, tiles, holes)), pixels(thumbnail(points, tiles, holes)))


def test_numbers_near_the_largest_are_drawn(curved):
    points, tiles, holes = curved
    assert thumbnail(points * 1e308, tiles, holes) == thumbnail(points, tiles, holes)


def test_numbers_of_points_do_not_matter(curved):
    points, tiles, _ = curved
    order = np.random.default_rng(1).permutation(len(points))
    where = np.argsort(order)
    renamed = Loops(tiles.offsets, where[tiles.indices])
    stray = np.vstack([points[order], [[50.0, 0, 0]]])
    assert thumbnail(stray, renamed) == thumbnail(points, tiles)


def test_the_sheet_fills_the_frame_and_leaves_a_margin(curved):
    inked = (pixels(thumbnail(*curved)) < 250).any(axis=2)
    rows, columns = np.flatnonzero(inked.any(axis=1)), np.flatnonzero(inked.any(axis=0))
    height, width = inked.shape
    assert (width, height) == SIZE
    assert rows[0] >= 4 and columns[0] >= 4 and rows[-1] < height - 4 and columns[-1] < width - 4
    assert np.ptp(rows) > 0.85 * height or np.ptp(columns) > 0.85 * width


def test_near_tiles_hide_far_ones():
    """Pixels of parallel squares against a ray through each: the nearest one shows, its front light, its back dark."""
    rng = np.random.default_rng(7)
    count = 12
    heights = np.linspace(0.0, 1.2, count)
    centers = rng.uniform(-0.5, 0.5, (count, 2))
    points = np.concatenate(
        [np.column_stack([0.45 * CORNERS[:, :2] + c, np.full(4, z)]) for c, z in zip(centers, heights, strict=True)]
    )
    turned = np.arange(count) % 3 == 1
    order = rng.permutation(count)
    loops = [list(range(4 * k, 4 * k + 4))[:: -1 if turned[k] else 1] for k in order]
    tiles = Loops.from_lists(loops)
    picture = pixels(thumbnail(points, tiles)).sum(axis=2)

    faces = np.array([[loop[0], loop[a], loop[a + 1]] for loop in loops for a in (1, 2)])
    view = choose_view(Surface.from_arrays(points, faces))
    frame = fit_frame(view, points, SIZE[0] / SIZE[1], 0.05)
    seen = (points - np.array(frame.center)) @ view.axes.T * (0.5 * SIZE[1] / frame.half_height)
    x = np.arange(SIZE[0]) + 0.5 - 0.5 * SIZE[0]
    y = 0.5 * SIZE[1] - (np.arange(SIZE[1]) + 0.5)
    nearest = np.full(picture.shape, -np.inf)
    shown = np.full(picture.shape, -1)
    doubtful = np.zeros(picture.shape, bool)
    for k in range(count):
        corner = seen[4 * k : 4 * k + 4]
        inward = np.full(picture.shape, np.inf)
        for a, b in zip(corner, np.roll(corner, -1, axis=0), strict=True):
            along = (b - a)[:2] / np.linalg.norm((b - a)[:2])
            inward = np.minimum(inward, along[0] * (y[:, None] - a[1]) - along[1] * (x[None] - a[0]))
        normal = np.cross(corner[1] - corner[0], corner[3] - corner[0])
        depth = (
            corner[0, 2] - (normal[0] * (x[None] - corner[0, 0]) + normal[1] * (y[:, None] - corner[0, 1])) / normal[2]
        )
        inside = inward > 0
        doubtful |= np.abs(inward) < 4.0
        shown = np.where(inside & (depth > nearest), k, shown)
        nearest = np.where(inside, np.maximum(depth, nearest), nearest)
    sure = ~doubtful
    light, dark, paper = (sure & (shown >= 0) & ~turned[shown], sure & (shown >= 0) & turned[shown], sure & (shown < 0))
    assert min(light.sum(), dark.sum(), paper.sum()) > 300
    assert picture[light].min() > picture[dark].max() and picture[paper].min() == 3 * 255 > picture[light].max()


def test_holes_are_open_or_cooler_than_tiles():
    points, tiles, holes = lifted(SHEETS["flat"])
    without, withal = pixels(thumbnail(points, tiles)), pixels(thumbnail(points, tiles, holes))
    changed = (without != withal).any(axis=2)
    sure = changed & (without == 255).all(axis=2)
    assert sure.sum() > 1000
    # tiles are warm, red above blue; holes are cool
    assert (withal[sure][:, 2] > withal[sure][:, 0]).all()
    tile = withal[(without < 255).any(axis=2) & ~changed]
    assert np.mean(tile[:, 0] > tile[:, 2]) > 0.99


@pytest.mark.parametrize("normal", [(0, 0, 1), (0, 0, -1), (1, 0, 0), (0, -1, 0), (1, 2, 3), (-1, 1, 0.01)])
def test_a_flat_sheet_is_seen_along_its_normal(normal):
    """A square is seen as one: its area is half of its diagonal squared; from anywhere else it would be less."""
    n = np.array(normal, float) / np.linalg.norm(normal)
    u = np.cross(n, (0.3, 0.5, -0.8))
    u /= np.linalg.norm(u)
    points = np.array([a * u + b * np.cross(n, u) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
    inked = (pixels(thumbnail(points, SQUARE, size=(480, 360))) < 250).any(axis=2)
    at = np.argwhere(inked)
    rim = at[ConvexHull(at).vertices]
    diagonal = np.linalg.norm(rim[:, None] - rim[None], axis=2).max()
    assert inked.sum() == pytest.approx(0.5 * diagonal**2, rel=0.03)


@pytest.mark.parametrize("cells", [1, 8, 50])
def test_any_number_of_tiles_is_a_small_file(cells):
    points, tiles, holes = lifted(SHEETS["saddle"], cells)
    png = thumbnail(points, tiles, holes)
    assert len(png) < 16_000
    assert Image.open(io.BytesIO(png)).mode == "P"
    assert len(np.unique(pixels(png).reshape(-1, 3), axis=0)) > 4


def test_polygons_of_all_sizes_are_drawn():
    angle = np.linspace(0, 2 * np.pi, 18, endpoint=False)
    ring = np.column_stack([np.cos(angle), np.sin(angle), 0.2 * np.cos(angle)])
    far = np.vstack([ring, ring + np.array([3.0, 0, 0])])
    tiles = Loops.from_lists([range(18), [18, 22, 26], [27, 29, 31, 33, 35]])
    assert (pixels(thumbnail(far, tiles)) < 250).any()


def test_degenerate_tiles_do_not_stop_the_others():
    points = np.vstack([CORNERS, [[2.0, 0, 0.5]] * 4])
    assert (pixels(thumbnail(points, Loops.from_lists([[0, 1, 2, 3], [4, 5, 6, 7]]))) < 250).any()
    line = np.column_stack([np.arange(4.0), np.arange(4.0), np.zeros(4)])
    assert thumbnail(line, SQUARE)


@pytest.mark.parametrize(
    ("points", "tiles", "holes", "size", "words"),
    [
        (CORNERS, Loops.from_lists([]), None, SIZE, "at least one tile"),
        (CORNERS * np.nan, SQUARE, None, SIZE, "finite"),
        (CORNERS + np.inf, SQUARE, None, SIZE, "finite"),
        (CORNERS[:, :2], SQUARE, None, SIZE, "shape"),
        ("points", SQUARE, None, SIZE, "points of a thumbnail"),
        (CORNERS * 0, SQUARE, None, SIZE, "of some size"),
        (CORNERS[:3], SQUARE, None, SIZE, "vertices 0 to 2, got 0 to 3"),
        (CORNERS, Loops.from_lists([[0, 1]]), None, SIZE, "3 corners, got 2"),
        (CORNERS, Loops.from_lists([[0, 1, -1]]), None, SIZE, "got -1 to 1"),
        (CORNERS, SQUARE, Loops.from_lists([[]]), SIZE, "holes of a thumbnail"),
        (CORNERS, SQUARE, Loops.from_lists([[0, 1, 9]]), SIZE, "holes of a thumbnail"),
        (CORNERS, SQUARE, None, (0, 100), "from 16 to 4096"),
        (CORNERS, SQUARE, None, (100, 1_000_000), "from 16 to 4096"),
    ],
)
def test_bad_input_is_named(points, tiles, holes, size, words):
    with pytest.raises(ParameterError, match=words):
        thumbnail(points, tiles, holes, size)
