"""Snapshots: pictures of scenes as PNG files, drawn off-screen."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import UInt8

from kirisurf.errors import KirisurfError, ParameterError
from viewers import theme
from viewers.drawing import add_item, add_lights, aim, colormap, plain_theme
from viewers.fields import Field, name_unit
from viewers.framing import Frame, fit_frame, round_length
from viewers.opengl import off_screen_window, probe
from viewers.scenes import Scene

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIZE = (1360, 1020)
LINES, LINES_OF_PANEL = 36.0, 26.0
"""Lines of text that would fit across a picture, and across one panel of an overview: fewer are larger letters."""

WIDE = 3
"""Most scenes in a row of an overview: more leave their text too small on a page."""

SUPERSAMPLING = 2
_DPI = 100.0


class NoOpenGLError(KirisurfError):
    """Pictures cannot be drawn on this machine; the message names the line that installs what is missing."""

    exit_code = 1


def render(scene: Scene, path: Path | str, size: tuple[int, int] = SIZE, lines: float = LINES) -> Path:
    """Write a scene as a PNG picture with title, color bar and scale bar.

    Parameters
    ----------
    scene : Scene
    path : path
        Replaced as a whole, or left alone where writing fails.
    size : (int, int)
        Width and height in pixels.
    lines : float
        Width of the picture over the height of a line of its text.

    Returns
    -------
    Path

    Raises
    ------
    NoOpenGLError
        Where nothing can be drawn here.
    OutputError
        Where the file cannot be written.
    """
    return _save(_page([scene], size, 1, lines), path)


def render_overview(
    scenes: Sequence[Scene] | Mapping[str, Scene],
    path: Path | str,
    columns: int | None = None,
    panel: tuple[int, int] = (640, 600),
    lines: float = LINES_OF_PANEL,
) -> Path:
    """Write several scenes as one picture at one scale, in rows; raises as `render`.

    Parameters
    ----------
    scenes : sequence or mapping of Scene
    path : path
    columns : int, optional
        Scenes in a row; by default at most `WIDE`, in rows as even as they can be.
    panel : (int, int)
        Width and height of one scene in pixels.
    lines : float
        Width of a panel over the height of a line of its text.
    """
    scenes = list(scenes.values()) if isinstance(scenes, Mapping) else list(scenes)
    if columns is None:
        columns = -(-len(scenes) // max(1, -(-len(scenes) // WIDE)))
    if not scenes or columns < 1:
        raise ParameterError(f"overview: expected scenes and columns, got {len(scenes)} scenes and {columns} columns")
    columns = min(columns, len(scenes))
    rows = -(-len(scenes) // columns)
    return _save(_page(scenes, (panel[0] * columns, panel[1] * rows), columns, lines), path)


def draw(
    scene: Scene, size: tuple[int, int], frame: Frame | None = None, supersampling: int = SUPERSAMPLING
) -> UInt8[np.ndarray, "h w 3"]:
    """Return the bare picture of a scene, (height, width, 3) uint8, without title and bars.

    Raises
    ------
    NoOpenGLError
        Where nothing can be drawn here.
    ParameterError
        Where the size is not positive.
    """
    width, height = size
    if width < 1 or height < 1:
        raise ParameterError(f"size: expected positive width and height, got {width}x{height}")
    answer = probe()
    if not answer.available:
        raise NoOpenGLError(answer.reason)
    import pyvista

    frame = frame or fit_frame(scene.view, scene.frame, width / height)
    with off_screen_window(answer):
        plotter = pyvista.Plotter(
            off_screen=True,
            window_size=[width * supersampling, height * supersampling],
            theme=plain_theme(),
            lighting="none",
        )
        try:
            # Line widths are thought for a picture 1200 pixels high.
            scale = supersampling * max(height / 1200.0, 0.7)
            add_lights(plotter)
            for item in scene.items:
                add_item(plotter, item, view=scene.view, depth=frame.depth, scale=scale)
            aim(plotter, scene.view, frame)
            image = np.asarray(plotter.screenshot(return_img=True))[..., :3]
        finally:
            plotter.close()
    return _averaged(image, supersampling)


@dataclass(frozen=True)
class _Panel:
    """Where one scene lies on the page, in pixels from the lower left; `line` is the height of a text line."""

    left: float
    base: float
    width: float
    height: float
    line: float

    @property
    def inner(self) -> tuple[int, int]:
        return int(self.width - 3.2 * self.line), int(self.height - 6.6 * self.line)

    @property
    def x(self) -> float:
        return float(round(self.left + 1.6 * self.line))

    @property
    def points(self) -> float:
        return self.line * 72.0 / _DPI


def _page(scenes: Sequence[Scene], size: tuple[int, int], columns: int, lines: float = LINES_OF_PANEL) -> Figure:
    """Lay scenes out on a page: title above, picture, and below it scale bar, color bar and note."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    width, height = size
    rows = -(-len(scenes) // columns)
    w, h = width / columns, height / rows
    line = max(8.0, min(w, 1.2 * h) / lines)
    figure = Figure(figsize=(width / _DPI, height / _DPI), dpi=_DPI, facecolor=theme.PAPER)
    FigureCanvasAgg(figure)
    panels = [_Panel(k % columns * w, height - (k // columns + 1) * h, w, h, line) for k in range(len(scenes))]
    inner = panels[0].inner
    frames = [fit_frame(scene.view, scene.frame, inner[0] / inner[1]) for scene in scenes]
    largest = max(frame.half_height for frame in frames)
    for scene, panel, frame in zip(scenes, panels, frames, strict=True):
        frame = replace(frame, half_height=largest)
        axes = figure.add_axes(
            (panel.x / width, round(panel.base + 3.9 * line) / height, inner[0] / width, inner[1] / height)
        )
        axes.imshow(draw(scene, inner, frame), interpolation="nearest")
        axes.set_axis_off()
        _write(figure, panel.x, panel.base + h - 1.9 * line, scene.title, 1.2 * panel.points, theme.INK)
        _scale_bar(figure, panel, 2.0 * frame.half_height / inner[1], scene.units)
        note = scene.note
        if scene.field is not None:
            _color_bar(figure, panel, scene.field)
            both = "; ".join(part for part in (note, scene.field.range_note) if part)
            # a letter is about half as wide as its size; what does not fit is said in the caption of the report
            note = both if 0.36 * line * len(both) <= inner[0] else note
        _write(figure, panel.x + inner[0], panel.base + 0.55 * line, note, 0.7 * panel.points, theme.MUTED, "right")
    return figure


def _write(figure: Figure, x: float, y: float, text: str, points: float, color: str, align: str = "left") -> None:
    width, height = figure.get_size_inches() * _DPI
    figure.text(x / width, y / height, text, fontsize=points, color=color, ha=align, parse_math=False)


def _scale_bar(figure: Figure, panel: _Panel, per_pixel: float, units: str) -> None:
    from matplotlib.lines import Line2D

    width, height = figure.get_size_inches() * _DPI
    length = round_length(0.2 * panel.inner[0] * per_pixel)
    x0, x1 = panel.x, panel.x + length / per_pixel
    y, tick = panel.base + 2.35 * panel.line, 0.2 * panel.line
    outline = ((x0, y + tick), (x0, y - tick), (x0, y), (x1, y), (x1, y + tick), (x1, y - tick))
    figure.add_artist(
        Line2D(
            [x / width for x, _ in outline],
            [v / height for _, v in outline],
            color=theme.INK,
            linewidth=0.06 * panel.points,
        )
    )
    label = f"{length:g} {name_unit(units, length)}"
    _write(figure, x0, y - 1.2 * panel.line, label, 0.82 * panel.points, theme.INK)


def _color_bar(figure: Figure, panel: _Panel, field: Field) -> None:
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize
    from matplotlib.ticker import MaxNLocator, ScalarFormatter

    width, height = figure.get_size_inches() * _DPI
    line, inner = panel.line, panel.inner[0]
    left = panel.x + 0.36 * inner
    axes = figure.add_axes(
        (left / width, (panel.base + 2.7 * line) / height, 0.64 * inner / width, 0.55 * line / height)
    )
    extend = {(False, False): "neither", (True, False): "min", (False, True): "max", (True, True): "both"}
    formatter = ScalarFormatter(useMathText=True)
    formatter.set_powerlimits((-3, 4))
    bar = figure.colorbar(
        ScalarMappable(Normalize(*field.limits), colormap(field)),
        cax=axes,
        orientation="horizontal",
        extend=extend[field.exceeds],
        extendfrac=0.035,
        ticks=MaxNLocator(max(2, min(5, int(0.19 * inner / line))), symmetric=field.signed),
        format=formatter,
    )
    bar.outline.set_visible(False)
    for value in field.marks:
        axes.axvline(value, color=theme.INK, linewidth=0.12 * panel.points, ymin=-0.35, ymax=1.35, clip_on=False)
    small = 0.8 * panel.points
    axes.tick_params(labelsize=small, labelcolor=theme.INK, length=0.2 * small, width=0.6, color=theme.MUTED)
    axes.xaxis.get_offset_text().set_visible(False)
    # drawing the whole page to learn the power of ten would take as long as writing it
    formatter.set_locs(axes.xaxis.get_majorticklocs())
    power = formatter.get_offset()
    unit = " ".join(part for part in (power, field.unit) if part)
    figure.text(
        (panel.x + inner) / width,
        (panel.base + 3.55 * line) / height,
        unit,
        fontsize=small,
        color=theme.INK,
        ha="right",
    )


def _save(figure: Figure, path: Path | str) -> Path:
    from kirisurf.formats.atomic import write_bytes

    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=_DPI, metadata={"Software": None})
    write_bytes(Path(path), buffer.getvalue())
    return Path(path)


def _averaged(image: np.ndarray, factor: int) -> np.ndarray:
    from PIL import Image

    return np.asarray(Image.fromarray(np.ascontiguousarray(image)).reduce(factor))
