"""The published configurations: what Choi, Dudte and Mahadevan made of which tessellation for which target.

G. P. T. Choi, L. H. Dudte and L. Mahadevan, "Programming shape using kirigami tessellations", Nature Materials 18
(2019); read from the names of the results in the repository garyptchoi/inverse-kirigami-design (Apache-2.0). Their
triangle pattern is kagome here.

Every line of the tables is a tessellation, a target, the numbers of unit cells across and up, the initial maps that
results are published for (1 standard, 2 rescaled, 3 conformal or analytic, 4 Teichmueller), and what is asked of the
contracted sheet: free, rectangle, a rectangle with a ratio (a number), or for hexagons angles, which says that all
angles of the contracted tiles are 2 pi/3.

The published ratio is the length of the lower side over the height: of the published contracted sheets with
triangles and ratio 1 these are 0.9647 and 0.9647 (hypar, 3x4) and 0.867 and 0.867 (circle, 3x3), with 1/2 they are
0.685 and 1.389 (wedge, 3x5). The lower row of w cells is 2 w triangles long and the sheet, whose rows are offset,
half a triangle wider. A rectangle here is the one that touches the outermost points on all four sides, so its ratio
is that of the published side times (4 w + 1)/(4 w), which is exact for a sheet with rows of even triangles.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from kirisurf.spec import RECTANGLE, FitSpec

FREE, ANGLES = "free", "angles"

LARGEST = 20
"""Unit cells along a side of the largest square that opens into the circle (Fig. 2c): 40x40 tiles."""

_PLANAR = """
hexagon          anvil    4x2  4     angles
hexagon          circle   5x3  3     free
hexagon          rainbow  4x2  4     angles
hexagon          shear    4x2  4     free
hexagon          wedge    4x3  4     free
islamic-quad     anvil    3x2  4     free
islamic-quad     rainbow  3x3  4     free
islamic-quad     rect     3x3  4     free
islamic-quad     wedge    2x3  4     free
islamic-triangle rainbow  4x2  4     free
islamic-triangle rainbow  6x3  4     free
islamic-triangle wedge    3x3  4     free
quad             anvil    3x3  1     rectangle
quad             anvil    4x4  1,4   free
quad             circle   2x2  3     1
quad             circle   3x3  1     rectangle
quad             circle   3x3  3,4   1
quad             circle   4x4  3     1
quad             circle   4x4  4     free
quad             circle   5x5  3     1
quad             egg      3x3  1     1
quad             rainbow  3x3  4     1
quad             rainbow  4x2  4     2
quad             rainbow  4x3  4     rectangle
quad             rect     8x8  1     free
quad             shear    3x3  1     1
quad             star     3x3  4     rectangle
quad             wavy     4x4  4     rectangle
quad             wedge    3x3  4     1
quad             wedge    3x4  4     free
quad             wedge    3x4  4     1
quad             wedge    8x8  1     free
kagome           anvil    3x3  4     free
kagome           circle   3x3  1     free
kagome           circle   3x3  3     1
kagome           circle   3x4  4     rectangle
kagome           egg      3x4  4     free
kagome           egg      6x7  4     rectangle
kagome           rainbow  2x2  1,2,3,4 free
kagome           rainbow  3x3  1     free
kagome           rainbow  5x3  4     rectangle
kagome           shear    3x4  4     rectangle
kagome           shear    6x7  4     1
kagome           star     3x4  4     rectangle
kagome           wedge    3x4  4     rectangle
kagome           wedge    3x5  4     0.5
"""

_CURVED = """
quad             hypar       4x4  3  free
quad             hypar       4x4  3  rectangle
quad             hypar       5x5  3  1
quad             mexicanhat2 4x4  1  free
quad             paraboloid  4x4  3  1
quad             paraboloid  4x4  4  1.5
quad             peaks       4x4  1  free
quad             peaks       5x5  3  1
quad             peaks2      6x6  3  1
quad             sphere      4x4  3  free
kagome           hypar       3x4  3  1
kagome           mexicanhat  4x4  3  rectangle
kagome           mexicanhat  6x7  3  free
kagome           mexicanhat2 6x7  3  free
kagome           paraboloid  3x4  3  1
kagome           peaks       3x4  3  rectangle
kagome           peaks       6x7  3  1
kagome           peaks2      6x7  3  1
kagome           sphere      3x4  3  free
"""

_THEIR_NAMES = {"kagome": "triangle", "islamic-quad": "islamicquad", "islamic-triangle": "islamictriangle"}


@dataclass(frozen=True)
class Configuration:
    """One published configuration.

    Attributes
    ----------
    kind : str
        2d: the target is a planar outline; 3d: a surface.
    tessellation, target : str
        Names of the catalog and of a sample surface or outline.
    cells : (int, int)
        Unit cells across and up.
    initials : tuple of int
        Initial maps that results are published for.
    contracted : str
        free, rectangle, the published ratio of a rectangle, or angles.
    """

    kind: str
    tessellation: str
    target: str
    cells: tuple[int, int]
    initials: tuple[int, ...]
    contracted: str

    @property
    def name(self) -> str:
        """Name of the configuration, which serves as the name of a folder.

        Examples
        --------
        >>> configurations("2d")[0].name
        'hexagon_anvil_4x2_angles'
        """
        return f"{self.tessellation}_{self.target}_{self.cells[0]}x{self.cells[1]}_{self.contracted}"

    @property
    def stems(self) -> tuple[str, ...]:
        """Names of the published files, one for each initial map, without their ends _deployed and _contracted.

        Examples
        --------
        >>> configurations("3d")[0].stems
        ('quad_hypar_w4_h4_i3_f0_r0',)
        """
        theirs = _THEIR_NAMES.get(self.tessellation, self.tessellation)
        fixed = int(self.contracted != FREE)
        ratio = self.contracted if self.contracted[0].isdigit() else "0"
        ends = {"quad": f"_f{fixed}_r{ratio}", "kagome": f"_f{fixed}_r{ratio}", "hexagon": f"_f{fixed}"}
        end = ends.get(self.tessellation, "")
        return tuple(f"{theirs}_{self.target}_w{self.cells[0]}_h{self.cells[1]}_i{i}{end}" for i in self.initials)

    @property
    def contracted_option(self) -> str:
        """What --contracted is given.

        Hexagons with angles of 2 pi/3 leave the outline free; that condition is not asked for here.
        """
        if self.contracted in (FREE, ANGLES):
            return FREE
        if self.contracted == RECTANGLE:
            return RECTANGLE
        widened = 1 + 1 / (4 * self.cells[0]) if self.tessellation == "kagome" else 1.0
        return f"{RECTANGLE}:{float(self.contracted) * widened:.12g}"

    @property
    def spec(self) -> FitSpec:
        """The fit that makes this configuration."""
        return FitSpec(
            target=self.target,
            tessellation=self.tessellation,
            cells=self.cells,
            contracted=self.contracted_option,
        )


@cache
def configurations(kind: str | None = None) -> tuple[Configuration, ...]:
    """Return the published configurations, the planar ones first.

    Parameters
    ----------
    kind : str, optional
        2d or 3d; both by default.

    Examples
    --------
    >>> len(configurations("2d")), len(configurations("3d"))
    (46, 19)
    """
    tables = {"2d": _PLANAR, "3d": _CURVED}
    chosen = tables if kind is None else {kind: tables[kind]}
    return tuple(_configuration(name, line) for name, table in chosen.items() for line in table.strip().splitlines())


def _configuration(kind: str, line: str) -> Configuration:
    tessellation, target, cells, initials, contracted = line.split()
    columns, rows = map(int, cells.split("x"))
    return Configuration(kind, tessellation, target, (columns, rows), tuple(map(int, initials.split(","))), contracted)
