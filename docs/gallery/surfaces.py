"""The sample surfaces as examples, each with a number that follows from its formula, written out here again."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

import kirisurf
from docs.gallery.example import Example, Measured
from docs.gallery.geometry import middle_hole, plan_integral, spacing, summit, triangles

_TROUGH = float(brentq(lambda s: np.tan(s) - s, 4.4, 4.6))
"""Where sin(s) / s is lowest: the first positive root of tan s = s."""


def _bell(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    return np.exp(-0.5 * (u * u + v * v))


def _face(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    base = 60 - 24 * (x / 75) ** 2 - 15 * (y / 100) ** 2 - 6 * (x / 75) ** 4
    nose = 12.5 * _bell(x / 16, (y + 9) / 20) + 5 * _bell(x / 15, (y - 20) / 22)
    eyes = sum(-5 * _bell((x - s * 31) / 16, (y - 17) / 12) for s in (-1, 1))
    cheeks = sum(4 * _bell((x - s * 38) / 20, (y + 14) / 20) for s in (-1, 1))
    mouth = 5 * _bell(x / 19, (y + 52) / 9) + 6 * _bell(x / 19, (y + 84) / 13)
    return base + nose + 4.5 * _bell(x / 44, (y - 42) / 14) + eyes + cheeks + mouth


def _hills(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    hills = (
        (150, 180, 140, 270, 240),
        (70, 560, -120, 230, 250),
        (95, -520, 60, 260, 300),
        (60, -60, -480, 260, 220),
        (-55, -170, 60, 190, 220),
        (-35, 330, -430, 220, 200),
    )
    return 300 + 0.03 * x + 0.02 * y + sum(h * _bell((x - a) / s, (y - b) / t) for h, a, b, s, t in hills)


def _hypar(design: kirisurf.Design) -> Measured:
    found = design.fields("hole")["gaussian_curvature"][middle_hole(design)]
    return Measured(float(found), -0.25, 0.25 * (spacing(design) / 2) ** 2)


def _mexicanhat(design: kirisurf.Design) -> Measured:
    points = design.deployed_points
    lowest = points[np.argsort(points[:, 2])[: len(points) // 20]]
    return Measured(float(np.hypot(lowest[:, 0], lowest[:, 1]).mean()), _TROUGH / 8, 0.5 * spacing(design))


def _mexicanhat2(design: kirisurf.Design) -> Measured:
    depth = float(np.cos(_TROUGH))
    return Measured(float(design.deployed_points[:, 2].min()), depth, 25 * abs(depth) * spacing(design) ** 2 / 4)


def _paraboloid(design: kirisurf.Design) -> Measured:
    found = design.fields("hole")["mean_curvature"][middle_hole(design)]
    return Measured(float(found), 1.0, spacing(design) ** 2)


def _peaks(design: kirisurf.Design) -> Measured:
    a, b, c, d = design.deployed_points[design.tessellation.holes[middle_hole(design)]]
    normal = np.cross(c - a, d - b)
    steepness = np.pi / 2
    slope = np.arccos(abs(normal[2]) / np.linalg.norm(normal))
    uneven = np.arctan(steepness) - np.arctan(steepness * (1 - (np.pi * spacing(design) / 2) ** 2 / 2))
    return Measured(float(np.degrees(slope)), float(np.degrees(np.arctan(steepness))), float(np.degrees(uneven)))


def _peaks2(design: kirisurf.Design) -> Measured:
    """Count the parts of the sheet above half of the height of a peak, joined by tiles and across holes."""
    high = np.flatnonzero(design.deployed_points[:, 2] > 0.125)
    pattern = design.tessellation
    loops = [np.intersect1d(loop, high) for loop in (*pattern.tiles, *pattern.holes)]
    pairs = np.concatenate([np.stack([loop[:-1], loop[1:]], axis=1) for loop in loops if len(loop)])
    joined = coo_array((np.ones(len(pairs)), tuple(pairs.T)), shape=(pattern.n_vertices,) * 2)
    labels = connected_components(joined, directed=False)[1]
    return Measured(float(len(np.unique(labels[high]))), 10.0, 0.0)


def _sphere(design: kirisurf.Design) -> Measured:
    holes = design.fields("hole")
    known = np.isfinite(holes["gaussian_curvature_averaged"])
    found = np.average(holes["gaussian_curvature_averaged"][known], weights=holes["area"][known])
    return Measured(float(found), 1.0, spacing(design) ** 2)


def _car_hood(design: kirisurf.Design) -> Measured:
    areas = []
    for points in (design.deployed_points, np.pad(design.contracted_points, ((0, 0), (0, 1)))):
        crosses = (np.cross(points[t], np.roll(points[t], -1, axis=0)).sum(axis=0) for t in design.tessellation.tiles)
        areas.append(0.5e-6 * sum(float(np.linalg.norm(cross)) for cross in crosses))
    return Measured(areas[1], areas[0], 1e-8 * areas[0])


def _dome(design: kirisurf.Design) -> Measured:
    sharpest = 2 * 4.2 * 1.1 / 9**2
    return Measured(float(design.deployed_points[:, 2].max()), 4.2, sharpest * spacing(design) ** 2 / 4)


def _face_mask(design: kirisurf.Design) -> Measured:
    height, sharpest = summit(_face, 60.0)
    return Measured(float(design.deployed_points[:, 2].max()), height, sharpest * spacing(design) ** 2 / 4)


def _saddle_roof(design: kirisurf.Design) -> Measured:
    x, y, z = design.deployed_points.T
    cubic = 3 * x**2 * y - y**3
    corner = 8 / np.cos(np.pi / 6)
    sharpest = 6 * 0.0035 * corner
    found = (cubic @ (z - 5)) / (cubic @ cubic)
    return Measured(1e3 * float(found), 3.5, 3.5 * (sharpest * spacing(design)) ** 2)


def _terrain(design: kirisurf.Design) -> Measured:
    corners = triangles(design)
    flat = plan_integral(corners, lambda x, y: np.ones_like(x))
    base = corners[:, 1:, :2] - corners[:, :1, :2]
    plan = 0.5 * (base[:, 0, 0] * base[:, 1, 1] - base[:, 0, 1] * base[:, 1, 0])
    found = plan @ corners[:, :, 2].mean(axis=1) / flat
    sharpest = 150 / 240**2
    return Measured(float(found), plan_integral(corners, _hills) / flat, sharpest * spacing(design) ** 2 / 12)


def _vault(design: kirisurf.Design) -> Measured:
    def stretch(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        along = 6 * np.pi / 22 * np.sin(np.pi * x / 22) * np.cos(np.pi * y / 18)
        across = 6 * np.pi / 18 * np.cos(np.pi * x / 22) * np.sin(np.pi * y / 18)
        return np.sqrt(1 + along**2 + across**2)

    corners = triangles(design)
    crosses = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    expected = plan_integral(corners, stretch)
    sharpest = 6 * (np.pi / 18) ** 2
    return Measured(
        0.5 * float(np.linalg.norm(crosses, axis=1).sum()), expected, expected * (sharpest * spacing(design)) ** 2
    )


_PATCH = "The error of a patch h wide on a radius R is of the order (h/R)²; h² is the target's area per tile."
_BETWEEN = "The highest vertex lies at most half the diagonal of a tile from the summit: lower by curvature × h²/4."

SURFACES: tuple[Example, ...] = (
    Example(
        "hypar",
        {"cells": (4, 4), "closeness": "exact"},
        "Gaussian curvature of the hole in the middle",
        "",
        "z = xy/2: K = −(∂²z/∂x∂y)² = −1/4 where the surface is level",
        _PATCH,
        _hypar,
    ),
    Example(
        "paraboloid",
        {"cells": (4, 4), "closeness": "exact"},
        "mean curvature of the hole in the middle",
        "",
        "z = (x² + y²)/2: both principal curvatures are 1 at the bottom",
        _PATCH,
        _paraboloid,
    ),
    Example(
        "sphere",
        {"cells": (4, 4), "closeness": "exact"},
        "Gaussian curvature of all holes, averaged by area",
        "",
        "1/R² with R = 1",
        _PATCH,
        _sphere,
    ),
    Example(
        "peaks",
        {"cells": (4, 4)},
        "slope of the hole in the middle",
        "°",
        "z = sin πx cos πy / 2 rises by π/2 at the origin: arctan(π/2)",
        "Within half a tile of the origin the slope falls with cos πx: by 1 − (πh/2)²/2.",
        _peaks,
    ),
    Example(
        "peaks2",
        {"cells": (8, 8)},
        "parts of the sheet above half the height of a peak",
        "",
        "z = sin 2πx cos 2πy / 4 has 6 summits inside the square and 4 on its sides",
        "A count: none may be missing, none may be joined.",
        _peaks2,
    ),
    Example(
        "mexicanhat",
        {"cells": (6, 6)},
        "radius of the trough, from the lowest twentieth of all vertices",
        "",
        "sin(s)/s with s = 8r is lowest where tan s = s: r = 4.4934/8",
        "The vertices lie up to half a tile off the trough.",
        _mexicanhat,
    ),
    Example(
        "mexicanhat2",
        {"cells": (6, 6)},
        "height of the lowest vertex",
        "",
        "sin(s)/s is cos s where tan s = s: cos 4.4934",
        "Up to half a tile's diagonal off the trough, whose curvature is 25 × 0.217: curvature × h²/4.",
        _mexicanhat2,
    ),
    Example(
        "car_hood",
        {"tiles": 300},
        "sheet metal in the flat blank (with the area of the tiles when open)",
        "m²",
        "rigid tiles keep their area when they turn",
        "Every edge and diagonal keeps its length to 1e-9 of itself: the area to 1e-8.",
        _car_hood,
    ),
    Example("dome", {"tiles": 300}, "height of the crown", "m", "4.2 m above the level rim", _BETWEEN, _dome),
    Example(
        "face_mask",
        {"tiles": 300},
        "height of the tip of the nose",
        "mm",
        "the maximum of the formula, on a grid of 0.15 mm",
        _BETWEEN,
        _face_mask,
    ),
    Example(
        "saddle_roof",
        {"tiles": 300},
        "coefficient of 3x²y − y³ in the height above 5 m, by least squares over all vertices",
        "/1000 m²",
        "0.0035 in the formula",
        "(h/R)², with R the smallest radius of curvature, at the corners.",
        _saddle_roof,
    ),
    Example(
        "terrain",
        {"tiles": 300},
        "mean height of the sheet over its own plan",
        "m",
        "the formula integrated over the same plan: what is cut is what is filled",
        "A plane patch h wide misses a hill of curvature k by k h²/12 on average.",
        _terrain,
    ),
    Example(
        "vault",
        {"tessellation": "kagome", "tiles": 200},
        "area of the sheet with its holes, which are spanned by triangles",
        "m²",
        "√(1 + |∇z|²) integrated over the same plan",
        "(h/R)², with R the smallest radius of curvature, at the crown.",
        _vault,
    ),
)
"""Every sample surface."""
