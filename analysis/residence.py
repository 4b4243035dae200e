"""Where the curvature of a sheet resides: in its holes, along their rims, and none of it in its tiles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from analysis import polygons
from analysis.curvature import HoleCurvature
from analysis.gauss_bonnet import Balance
from analysis.hole_sides import center_fans, sides_beyond, tiles_beyond
from analysis.target_integrals import integrate_covered, integrate_target
from kirisurf.closest import ClosestPoints
from kirisurf.tessellation import Tessellation


@dataclass(frozen=True, eq=False)
class Residence:
    """Areas and integrated Gaussian curvatures, of the sheet and of the target beneath it.

    A tile is handed out to the holes round it, by the triangles from its center to its sides: a hole with its share
    is its cell. NaN where the hole's vertices do not determine a patch.

    Attributes
    ----------
    tile_areas, hole_areas : (t,), (g,), squared units
        Of the sheet: the tiles, and the patches within the holes.
    tile_curvatures : (t,), radians
        Excess of the tiles' angles: what is left by their planarity.
    hole_curvatures, hole_magnitudes : (g,), radians
        K and |K| integrated over the patches within the holes.
    cell_curvatures : (g,), radians
        Of every hole's cell by angle defects (:class:`analysis.gauss_bonnet.Balance`); NaN at the rim.
    target_tile_areas, target_hole_areas : (t,), (g,), squared units
        Of the target beneath tiles and holes (closest-point images).
    target_tile_curvatures, target_hole_curvatures, target_cell_curvatures : (t,), (g,), (g,), radians
        K of the target integrated beneath tiles, holes and cells.
    target_tile_magnitudes, target_hole_magnitudes : (t,), (g,), radians
        The same of |K|.
    target_area, target_curvature, target_magnitude : float
        Area and integrals of K and |K| of the whole target.
    """

    tile_areas: Float[np.ndarray, " t"]
    hole_areas: Float[np.ndarray, " g"]
    tile_curvatures: Float[np.ndarray, " t"]
    hole_curvatures: Float[np.ndarray, " g"]
    hole_magnitudes: Float[np.ndarray, " g"]
    cell_curvatures: Float[np.ndarray, " g"]
    target_tile_areas: Float[np.ndarray, " t"]
    target_hole_areas: Float[np.ndarray, " g"]
    target_tile_curvatures: Float[np.ndarray, " t"]
    target_hole_curvatures: Float[np.ndarray, " g"]
    target_cell_curvatures: Float[np.ndarray, " g"]
    target_tile_magnitudes: Float[np.ndarray, " t"]
    target_hole_magnitudes: Float[np.ndarray, " g"]
    target_area: float
    target_curvature: float
    target_magnitude: float

    @property
    def rim_curvatures(self) -> Float[np.ndarray, " g"]:
        """What lies on the sides and corners of every hole, (g,): its cell's without that of its patch, radians.

        It stands for what the target has beneath the flat tiles. NaN at the rim of the sheet.
        """
        return self.cell_curvatures - self.hole_curvatures


def residence(
    points: Float[np.ndarray, "n 3"],
    tessellation: Tessellation,
    curvature: HoleCurvature,
    angles: Balance,
    closest: ClosestPoints,
) -> Residence:
    """Return where the curvature of a sheet and of the target beneath it resides.

    Parameters
    ----------
    points : (n, 3), units
        Deployed, in the frame of the target.
    tessellation : Tessellation
    curvature : HoleCurvature
        Of the holes' patches.
    angles : Balance
    closest : ClosestPoints
        Of the target.
    """
    tiles, holes, t, g = tessellation.tiles, tessellation.holes, tessellation.n_tiles, len(tessellation.holes)
    fronts, beyond = polygons.normals(points, tiles), tiles_beyond(tessellation)
    at_holes = np.stack([np.bincount(holes.owners, column, g) for column in fronts[beyond].T], axis=1)
    under_sides = integrate_covered(center_fans(points, tiles), fronts[tiles.owners], closest)
    under_holes = integrate_covered(center_fans(points, holes), at_holes[holes.owners], closest)
    tile_area, tile_curvature, tile_magnitude = (np.bincount(tiles.owners, values, t) for values in under_sides)
    hole_area, hole_curvature, hole_magnitude = (np.bincount(holes.owners, values, g) for values in under_holes)
    shares = np.bincount(holes.owners, under_sides[1][sides_beyond(tessellation)], g)
    area, total, magnitude = integrate_target(closest)
    return Residence(
        tile_areas=np.linalg.norm(polygons.area_vectors(points, tiles), axis=1),
        hole_areas=curvature.areas,
        tile_curvatures=angles.tile_excess,
        hole_curvatures=curvature.integrated_gaussian,
        hole_magnitudes=curvature.integrated_absolute_gaussian,
        cell_curvatures=angles.defects,
        target_tile_areas=tile_area,
        target_hole_areas=hole_area,
        target_tile_curvatures=tile_curvature,
        target_hole_curvatures=hole_curvature,
        target_cell_curvatures=hole_curvature + shares,
        target_tile_magnitudes=tile_magnitude,
        target_hole_magnitudes=hole_magnitude,
        target_area=float(area),
        target_curvature=float(total),
        target_magnitude=float(magnitude),
    )
