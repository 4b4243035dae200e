"""The figure of an elastic check: the mesh at a ligament, the sheet as it opens, and the work that opening it takes."""

from __future__ import annotations

import io
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float

from kirisurf.elastic.driven_work import DrivenWork
from kirisurf.elastic.sheet_mesh import SheetMesh
from kirisurf.loops import Loops
from viewers import theme
from viewers.deployment_curves import dot
from viewers.moving_sheet import MovingSheet

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["ElasticCheck", "elastic_figure"]

DEEP_CRACK, BEAM = 1 / 15.8, 1 / 12
"""Moment of a ligament over E t w^2 and its angle: beside a deep crack, and of a beam as long as it is wide."""

_DPI, _COLORS = 150, 96
_PAGE = 9.0, 3.55
_SHOWN = 4.0  # half of the window on the mesh, in widths of a ligament
_STYLE: Any = {
    **theme.CHART_STYLE,
    "font.size": 9.0,
}


@dataclass(frozen=True, eq=False)
class ElasticCheck:
    """A sheet that a finite element program has opened.

    Attributes
    ----------
    mesh : SheetMesh
        Of the flat sheet.
    tiles, holes : Loops
        Of the tessellation.
    work : DrivenWork
        What was computed; a step of it ends at every opening.
    openings : (s, c), radians
        Angles of the slits that the design has at the end of every step.
    thickness, young : float
        Of the sheet; lengths are those of the mesh.
    """

    mesh: SheetMesh
    tiles: Loops
    holes: Loops
    work: DrivenWork
    openings: Float[np.ndarray, "s c"]
    thickness: float
    young: float = 1.0

    @property
    def energies(self) -> Float[np.ndarray, " s"]:
        """Work at the end of every step over E t w^2 for each slit end, w the median width of the ligaments."""
        unit = self.young * self.thickness * float(np.median(self.mesh.widths)) ** 2 * self.openings.shape[1]
        return np.array([self.work.at(float(step)) for step in range(1, 1 + len(self.openings))]) / unit

    @property
    def states(self) -> Float[np.ndarray, "k n 3"]:
        """Vertices of the flat sheet and at the end of every step."""
        flat = np.pad(self.mesh.nodes[self.mesh.vertices], ((0, 0), (0, 1)))
        return flat + np.concatenate([np.zeros((1, *flat.shape)), self.work.vertices])


def elastic_figure(check: ElasticCheck, title: str) -> bytes:
    """Draw the mesh at a ligament, the sheet at both ends, and the work beside that of the ligaments alone; PNG."""
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    with matplotlib.rc_context(_STYLE):
        figure = Figure(figsize=_PAGE, dpi=_DPI, facecolor=theme.PAPER)
        FigureCanvasAgg(figure)
        figure.text(0.025, 0.93, title, fontsize=12, va="center")
        _mesh(figure.add_axes((0.025, 0.13, 0.27, 0.69)), check)
        states = check.states
        _sheets(figure, check, states[[0, -1]], (0.31, 0.11, 0.28, 0.75))
        _work(figure.add_axes((0.665, 0.22, 0.32, 0.6)), check)
        for x, words in (
            (0.16, f"mesh at a ligament, {_count(check)} elements in all"),
            (0.45, "flat and open: vertices as computed"),
        ):
            figure.text(x, 0.065, words, fontsize=8.5, color=theme.MUTED, ha="center", va="center")
        return _written(figure)


def _count(check: ElasticCheck) -> str:
    return f"{len(check.mesh.triangles):,}".replace(",", " ")


def _mesh(axes: Axes, check: ElasticCheck) -> None:
    """The mesh round the ligament next to the middle: sides of tiles dark, the ligament in color."""
    mesh = check.mesh
    middle = mesh.nodes.mean(axis=0)
    k = int(np.argmin([np.linalg.norm(mesh.nodes[nodes].mean(axis=0) - middle) for nodes in mesh.ligaments]))
    center, half = mesh.nodes[mesh.ligaments[k]].mean(axis=0), _SHOWN * float(mesh.widths[k])
    axes.triplot(*mesh.nodes.T, mesh.triangles[:, :3], color=theme.NO_VALUE, linewidth=0.6)
    corners = mesh.nodes[mesh.vertices]
    for loop in check.tiles:
        axes.fill(*corners[loop].T, facecolor=theme.TILE, zorder=0.5)
        axes.plot(*corners[np.r_[loop, loop[:1]]].T, color=theme.INK, linewidth=1.4)
    for nodes in mesh.ligaments:
        ends = mesh.nodes[nodes[[0, -1]]]
        axes.plot(*ends.T, color=theme.SERIES[1], linewidth=3.2, solid_capstyle="butt", zorder=4)
    axes.set_xlim(center[0] - half, center[0] + half)
    axes.set_ylim(center[1] - half, center[1] + half)
    axes.set_aspect("equal")
    axes.set_xticks([])
    axes.set_yticks([])
    for spine in axes.spines.values():
        spine.set_visible(True)


def _sheets(figure: Any, check: ElasticCheck, states: np.ndarray, box: tuple[float, float, float, float]) -> None:
    """States one above the other, from one place and at one scale."""
    sheet = MovingSheet(check.tiles, check.holes, states, np.zeros((len(states), len(check.tiles))), 0.0)
    left, base, width, height = box
    part = height / len(states)
    size = round(width * _PAGE[0] * _DPI), round(part * _PAGE[1] * _DPI)
    for k in range(len(states)):
        axes = figure.add_axes((left, base + (len(states) - 1 - k) * part, width, part))
        axes.imshow(np.asarray(sheet.picture(k, size)), interpolation="lanczos")
        axes.set_axis_off()


def _work(axes: Axes, check: ElasticCheck) -> None:
    squares = np.r_[0.0, 0.5 * (check.openings**2).mean(axis=1)]
    mean = np.r_[0.0, np.degrees(check.openings.mean(axis=1))]
    for factor, color, words in (
        (BEAM, theme.SERIES[2], "ligaments as beams, c = 1/12"),
        (DEEP_CRACK, theme.SERIES[0], "ligaments beside a crack, c = 1/15.8"),
    ):
        axes.plot(mean, factor * squares, color=color, linewidth=1.8, label=words)
    look = dot(theme.SERIES[1], 6.5)
    axes.plot(mean, np.r_[0.0, check.energies], "o", **look, clip_on=False, label="computed with CalculiX", zorder=5)
    axes.set_xlim(left=0)
    axes.set_ylim(0, 1.22 * max(float(check.energies.max()), BEAM * float(squares.max())))
    axes.grid(axis="y", color=theme.HAIRLINE, linewidth=0.6)
    axes.set_axisbelow(True)
    axes.set_xlabel("mean opening of the slits (degrees)")
    axes.set_ylabel("work a slit end, over $E t w^2$")
    axes.legend(fontsize=8, loc="upper left", borderaxespad=0.2)


def _written(figure: Any) -> bytes:
    from PIL import Image

    picture, buffer = io.BytesIO(), io.BytesIO()
    figure.savefig(picture, format="png", metadata={"Software": None})
    few = Image.open(picture).convert("RGB").quantize(_COLORS, dither=Image.Dither.NONE)
    few.save(buffer, format="png", optimize=True)
    return buffer.getvalue()
