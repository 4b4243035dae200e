"""The catalog of sample surfaces: their specs, and the surfaces that they describe."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files
from typing import Any

import numpy as np

from kirisurf.errors import ParameterError
from kirisurf.surface import Surface
from sample_surfaces.expression import Expression
from sample_surfaces.height_field import HeightField
from sample_surfaces.meshing import cap_mesh, grid_mesh, outline_mesh
from sample_surfaces.outlines import outline_box, outline_from
from sample_surfaces.sphere import Sphere

_COARSEST = 6
_FINEST = 1000


@dataclass(frozen=True)
class SampleSpec:
    """What a sample surface is.

    Attributes
    ----------
    name, title, formula : str
    origin : str
        One sentence: where the surface comes from.
    units : str
        Of the coordinates: "mm", "m", or "1" for the dimensionless published targets.
    outline : str
        In one word: square, round, elliptic, ...
    published : bool
        True for the targets of Choi, Dudte and Mahadevan (Nature Materials, 2019).
    resolution : int
        Default number of mesh edges across the longer side of the outline's box.
    cells : (int, int) or None
        Suggested number of unit cells, where the pattern is a rectangle.
    tiles : int or None
        Suggested number of tiles, where the pattern is trimmed to the outline.
    """

    name: str
    title: str
    formula: str
    origin: str
    units: str
    outline: str
    published: bool
    resolution: int
    cells: tuple[int, int] | None = None
    tiles: int | None = None

    @property
    def fit_options(self) -> dict[str, str]:
        """Suggested options of a fit, as the command line spells them."""
        if self.cells is not None:
            return {"cells": f"{self.cells[0]}x{self.cells[1]}"}
        return {"tiles": str(self.tiles)} if self.tiles is not None else {}


def names() -> tuple[str, ...]:
    """Return the names of the sample surfaces: the published ones first, then the practical ones.

    Examples
    --------
    >>> "hypar" in names() and "car_hood" in names()
    True
    """
    return tuple(_definitions())


def spec(name: str) -> SampleSpec:
    """Return the spec of a sample surface.

    Raises
    ------
    ParameterError
        Where there is no such sample.

    Examples
    --------
    >>> spec("hypar").fit_options
    {'cells': '4x4'}
    """
    definition = _definition(name)
    cells = definition.get("cells")
    return SampleSpec(
        name=name,
        title=definition["title"],
        formula=definition["formula"],
        origin=definition["origin"],
        units=definition["units"],
        outline=definition["outline"],
        published=definition["published"],
        resolution=definition["resolution"],
        cells=(int(cells[0]), int(cells[1])) if cells else None,
        tiles=definition.get("tiles"),
    )


def load(name: str, resolution: int | None = None) -> Surface:
    """Return a sample surface: a mesh made on the spot, with the smooth surface that it stands for.

    Parameters
    ----------
    name : str
        One of `names()`.
    resolution : int, optional
        Number of mesh edges across the longer side of the outline's box; the sample's own by default.
        Vertices lie on the smooth surface, those of the rim over the outline.

    Raises
    ------
    ParameterError
        Where there is no such sample, or the resolution is not a whole number in range.

    Examples
    --------
    >>> surface = load("hypar", resolution=20)
    >>> surface.vertices.shape, surface.smooth.formula
    ((441, 3), 'z = x y / 2')
    """
    default = _definition(name)["resolution"]
    wanted = default if resolution is None else resolution
    if isinstance(wanted, bool) or not isinstance(wanted, int | np.integer) or not _COARSEST <= wanted <= _FINEST:
        raise ParameterError(
            f"resolution of {name}: expected a whole number from {_COARSEST} to {_FINEST}, got {wanted!r}"
        )
    return _loaded(name, int(wanted))


@lru_cache(maxsize=32)
def _loaded(name: str, resolution: int) -> Surface:
    definition = _definition(name)
    if "cap" in definition:
        cap = definition["cap"]
        sphere = Sphere(float(cap["radius"]))
        points, faces = cap_mesh(max(2, resolution // 2), np.radians(cap["half_angle"]))
        return Surface.from_arrays(sphere.radius * points, faces, name, sphere)
    outline = outline_from(definition["boundary"])
    box = outline_box(outline)
    if definition["boundary"].get("grid", False):
        places, faces = grid_mesh(box[0], box[1], resolution)
    else:
        places, faces = outline_mesh(outline, float((box[1] - box[0]).max()) / resolution)
    smooth = HeightField(definition["formula"], Expression.from_texts(definition["height"]), box)
    return Surface.from_arrays(smooth.points(places), faces, name, smooth)


def _definition(name: str) -> dict[str, Any]:
    definitions = _definitions()
    if name not in definitions:
        raise ParameterError(f"sample surface: expected one of {', '.join(definitions)}, got {name!r}")
    return definitions[name]


@lru_cache(maxsize=1)
def _definitions() -> dict[str, dict[str, Any]]:
    tables = {}
    for entry in files("sample_surfaces").joinpath("specs").iterdir():
        if entry.name.endswith(".toml"):
            tables[entry.name.removesuffix(".toml")] = tomllib.loads(entry.read_text(encoding="utf-8"))
    return dict(sorted(tables.items(), key=lambda item: (not item[1]["published"], item[0])))
