"""Words: what the rows of a certificate and the pictures mean, for a reader who did not write the solver."""

from __future__ import annotations

from dataclasses import dataclass

CAPTIONS = {
    "overview": "All at one scale: the target, the flat sheet, the deployed sheet, and the curvature of its holes.",
    "target": "The target as it was read.",
    "pattern": "The flat, closed sheet. Every line is a cut; at the corners of the tiles a hinge stays.",
    "deployed": "The sheet, opened, on the target. The gaps between the tiles are the opened slits.",
    "asked_stretch": "How much longer than the flat sheet the target is at every place. The marks on the color bar are "
    "the ends of what this tessellation can give.",
    "mean_curvature": "Positive where the surface bends toward the normal of the target. Holes and target share one "
    "color scale, white at zero.",
    "gaussian_curvature": "Positive like a dome, negative like a saddle. Holes and target share one color scale, white "
    "at zero.",
    "distance": "How far the sheet lies above (+) or below (\u2212) the target. Gray: holes.",
    "residence": "Integrated Gaussian curvature of every tile and hole, of the target beneath and of the sheet.",
    "residuals": "Distance of corners to their tile's plane and change of a tile's lengths, over L; angles round a "
    "vertex without 2\u03c0; distance of the copies of a vertex in the flat sheet.",
}

PLANAR_CAPTIONS = {
    "overview": "All at one scale: the target, the flat sheet, and the deployed sheet.",
    "target": "The outline of the target as it was read.",
    "deployed": "The sheet, opened, from above, with the outline of the target over it.",
}

OPEN_CAPTIONS = {
    "pattern": "The flat, closed sheet. Every line is a cut; at the corners of the tiles a hinge stays. What is open "
    "here is so by design.",
    "deployed": "The sheet, opened, on the target. The gaps between the tiles are the opened slits, and openings by "
    "design.",
}
"""Of patterns that keep openings when they are flat."""

OPTIONAL = frozenset({"loop", "boundary", "contracted_boundary"})
"""Rows that only some designs have: a null there means that the row does not apply."""

AT_LEAST = frozenset({"opening_min", "min_edge", "coverage", "coverage_strict"})

# name: (short name, meaning, unit)
_ROWS = {
    "length": (
        "Slit edges match",
        "The two sides of every slit are equally long, so that it can close.",
        "of a tile edge",
    ),
    "angle": (
        "Corners close",
        "Round every inner point of the closed sheet the tile angles sum to a full turn; round an opening that stays, "
        "with m sides, to m + 2 half turns.",
        "rad",
    ),
    "planarity": ("Tiles are flat", "The corners of every tile lie in one plane.", "of a tile edge"),
    "isometry": ("Tiles are rigid", "Every tile has the same shape in both states.", "of a tile edge"),
    "closure": (
        "The sheet closes",
        "Copies of a point on the two sides of a slit meet when it is closed.",
        "of a tile edge",
    ),
    "opening_min": (
        "Slits open the right way",
        "Smallest opening at a hinge; below zero, two tiles would overlap.",
        "rad",
    ),
    "intersections": (
        "No tiles cross",
        "Pairs of tiles without a common point that cut through each other in space.",
        "pairs",
    ),
    "overlap_contracted": (
        "No overlap when flat",
        "Area where tiles of the flat sheet lie on each other, over that of the tiles.",
        "of the tiles' area",
    ),
    "gap_contracted": (
        "No gaps when flat",
        "Area inside the flat outline that no tile covers, over that of the tiles.",
        "of the tiles' area",
    ),
    "loop": ("Designed openings close", "How well the outline of every designed opening closes.", "of a tile edge"),
    "boundary": (
        "The rim lies on the outline",
        "The outer vertex of the deployed sheet farthest from the planar target's outline.",
        "of a tile edge",
    ),
    "contracted_boundary": (
        "The flat rim is as asked",
        "The outer vertex of the flat sheet farthest from the outline that was prescribed for it.",
        "of a tile edge",
    ),
    "min_edge": ("Smallest edge", "The shortest tile edge, against the median one.", "of a tile edge"),
    "distance_rms": ("Distance to the target", "Root mean square over the deployed vertices.", "of a tile edge"),
    "distance_max": (
        "Largest distance to the target",
        "The deployed vertex farthest from the target.",
        "of a tile edge",
    ),
    "reach_rms": (
        "Reach of the target",
        "From points all over the target to the sheet, root mean square.",
        "of a tile edge",
    ),
    "reach_max": ("Farthest reach", "The point of the target farthest from the sheet.", "of a tile edge"),
    "coverage": ("Coverage", "Part of the target inside the sheet's outer outline.", "of the target's area"),
    "pieces": ("One piece", "Parts that hinges hold together.", "pieces"),
    "flipped": ("No tile turned over", "Tiles of the flat sheet that lie face down.", "tiles"),
    "flatness": ("The closed sheet is flat", "Largest distance of its vertices from one plane.", "of a tile edge"),
    "distance_smooth_max": (
        "Vertices on the smooth target",
        "The deployed vertex farthest from the smooth surface that the target's mesh stands for.",
        "of a tile edge",
    ),
    "coverage_strict": (
        "Strict coverage",
        "Part of the target under tiles and closed holes alone.",
        "of the target's area",
    ),
}

_MARKS = {
    "pass": ("\u2713", "pass"),
    "fail": ("\u2717", "fails"),
    "unchecked": ("?", "not checked"),
    "none": ("\u2013", "does not apply"),
    "info": ("\u00b7", "reported"),
}


@dataclass(frozen=True)
class CertificateRow:
    """One row of the certificate in words.

    Attributes
    ----------
    name, title, meaning, unit : str
    value, limit : str
        Formatted, the limit with its relation.
    verdict : str
        pass, fail, unchecked, none (does not apply) or info (no limit).
    mark, verdict_word : str
        A sign and a word for the verdict, so that color is never alone.
    """

    name: str
    title: str
    meaning: str
    unit: str
    value: str
    limit: str
    verdict: str
    mark: str
    verdict_word: str

    @property
    def short_unit(self) -> str:
        """L for a length over the median tile edge, rad for an angle; empty for counts and shares."""
        return {"of a tile edge": "L", "rad": "rad"}.get(self.unit, "")

    @property
    def relation(self) -> str:
        """How the value has to stand to its limit."""
        return ">" if self.name == "opening_min" else "\u2265" if self.name in AT_LEAST else "\u2264"


def row_in_words(
    name: str, value: float | int | None, limit: float | int | None, failures: tuple[str, ...] | None = None
) -> CertificateRow:
    """Describe one certificate row.

    Parameters
    ----------
    name : str
    value : float or None
    limit : float or None
        Largest allowed value, or smallest for openings, edges and coverages; None where there is no limit.
    failures : tuple of str, optional
        The judge's sentences, "name: why" each: a row fails where one names it. Without them the row is held
        against its limit here, and a null row counts as not checked, but for those of `OPTIONAL`.
    """
    title, meaning, unit = _ROWS.get(name, (name.replace("_", " "), "", ""))
    at_least = name in AT_LEAST
    if failures is not None:
        fails = any(sentence.startswith(f"{name}:") for sentence in failures)
    elif value is None:
        fails = name not in OPTIONAL
    else:
        fails = limit is not None and not _holds(name, value, limit)
    if value is None:
        verdict = "unchecked" if fails else "none"
    elif fails:
        verdict = "fail"
    else:
        verdict = "info" if limit is None else "pass"
    mark, word = _MARKS[verdict]
    relation = ">" if name == "opening_min" else "\u2265" if at_least else "\u2264"
    return CertificateRow(
        name,
        title,
        meaning,
        unit,
        "\u2013" if value is None else number(value),
        "" if limit is None else f"{relation} {number(limit)}",
        verdict,
        mark,
        word,
    )


def _holds(name: str, value: float | int, limit: float | int) -> bool:
    if name == "opening_min":
        return value > limit
    return value >= limit if name in AT_LEAST else value <= limit


def number(value: object) -> str:
    """Format a number with three significant digits, all those before the point up to 100000.

    Whole numbers and text stay as they are; what is not a number is a dash.

    Examples
    --------
    >>> number(0.123456), number(2.0), number(5e-9), number(1079.6)
    ('0.123', '2', '5e-9', '1080')
    """
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return str(value) if value is not None else "\u2013"
    if value != value:
        return "\u2013"
    if isinstance(value, int) or (value == int(value) if abs(value) < 1e15 else False):
        return f"{int(value)}"
    text = f"{value:.0f}" if 999.5 <= abs(value) < 1e5 else f"{value:.3g}"
    return text.replace("e-0", "e-").replace("e+0", "e")
