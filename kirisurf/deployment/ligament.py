"""From material to lambda: how stiff a slit is against its tiles, by a simple model of the ligament at a hinge."""

from __future__ import annotations

import numpy as np

from kirisurf.deployment.energy import Energy
from kirisurf.errors import ParameterError


def torsion_of_ligament(
    energy: Energy,
    width: float,
    *,
    reach: float | None = None,
    poisson: float = 0.3,
    modulus_ratio: float = 1.0,
    thickness_ratio: float = 1.0,
) -> float:
    """Return lambda for ligaments of a given width.

    *The slit.* What is left standing at the end of a slit is a short beam in the plane of the sheet, of width w,
    thickness t' and length h (its `reach`), of modulus E'. Bent by the angle theta it stores k theta^2 / 2 with::

        k = E' I / h,   I = t' w^3 / 12.

    A cut without width leaves no free length: the ligament bends over about its own width, h = w, and
    k = E' t' w^2 / 12.

    *The tile.* Rods stand for a plate: stretched by the strain s in all directions, a tile of area A, thickness t,
    modulus E and Poisson's ratio nu stores E t A s^2 / (1 - nu), and its m rods m c s^2, if a rod of strain s stores
    c s^2. Over all tiles c = E t (sum A) / ((1 - nu) Ns), Ns being the number of rods.

    *Both.* Dividing the energy of the sheet by c Ns gives that of the model, with Nc slit ends::

        lambda = Nc k / (2 c Ns) = Nc (E' t' / E t) w^3 (1 - nu) / (24 h sum A).

    A sheet cut from one material has E' = E and t' = t: modulus and thickness drop out, and with h = w lambda grows
    as the square of the width over the tile's: Nc / (24 t_n) (1 - nu) (w / a)^2 for t_n square tiles of side a.

    *Where it ends.* Small bending of an elastic beam: at 90 degrees a ligament yields, and what it keeps is a hinge
    that is weaker and rests partly open. Shear, the compliance of the tile next to the ligament and its stretching
    are left out; so are bending and twisting out of the plane, with stiffness of order E t^3, which matter for sheets
    in space. Against finite elements (docs/elastic.md), h = w: a ligament between two free tiles has 0.8 of this k, one
    in a sheet whose rim is held 1.35 to 1.6 times as much.

    Parameters
    ----------
    energy : Energy
        Of the sheet, which gives the numbers of rods and slits and the area of the tiles.
    width : float
        w, in the units of the sheet.
    reach : float, optional
        h: the free length of the ligament, about the width of the cut; by default w.
    poisson : float
        nu of the tiles.
    modulus_ratio, thickness_ratio : float
        E'/E and t'/t.

    Raises
    ------
    ParameterError
        Where a number is not positive, or nu does not lie above -1 and below 0.5.

    Examples
    --------
    >>> from kirisurf.deployment.springs import energy_of
    >>> from kirisurf.pattern import quad_pattern
    >>> sheet = quad_pattern(4, 4)
    >>> energy = energy_of(sheet, sheet.contracted, dimension=2)
    >>> round(torsion_of_ligament(energy, 0.1) / torsion_of_ligament(energy, 0.05), 9)
    4.0
    """
    reach = width if reach is None else reach
    named = {"width": width, "reach": reach, "modulus_ratio": modulus_ratio, "thickness_ratio": thickness_ratio}
    for name, value in named.items():
        if not (np.isfinite(value) and value > 0):
            raise ParameterError(f"{name}: expected a number above 0, got {value}")
    if not -1 < poisson < 0.5:
        raise ParameterError(f"poisson: expected a number between -1 and 0.5, got {poisson}")
    slits = len(energy.hinges.stencil)
    bending = modulus_ratio * thickness_ratio * width**3 / reach
    return slits * bending * (1 - poisson) / (24 * energy.area)
