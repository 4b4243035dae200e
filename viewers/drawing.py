"""Drawing: items of a scene put into a pyvista plotter. Shared by snapshots and the window."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from kirisurf.loops import Loops
from viewers import theme
from viewers.fields import Field
from viewers.framing import Frame, View
from viewers.items import Item

if TYPE_CHECKING:
    import pyvista
    from matplotlib.colors import ListedColormap

VALUES = "values"
# Colors of a map have to match its color bar: hardly any shading there. The target has nothing but shading.
_SMOOTH = {"ambient": 0.27, "diffuse": 0.75, "specular": 0.0}
_MATTE = {"ambient": 0.46, "diffuse": 0.54, "specular": 0.0}
_MAPPED = {"ambient": 0.78, "diffuse": 0.26, "specular": 0.0}


class Drawn(NamedTuple):
    """An item in a plotter: its actor, and the PolyData whose points may be moved."""

    actor: pyvista.Actor
    data: pyvista.PolyData


def cell_buffer(loops: Loops) -> np.ndarray:
    """Return loops in VTK's flat layout [n, i, j, ..., n, i, ...].

    Examples
    --------
    >>> cell_buffer(Loops.from_lists([[4, 5, 6], [0, 1]])).tolist()
    [3, 4, 5, 6, 2, 0, 1]
    """
    sizes = loops.sizes
    out = np.empty(len(loops.indices) + len(loops), np.int64)
    heads = loops.offsets[:-1] + np.arange(len(loops))
    out[heads] = sizes
    body = np.ones(len(out), bool)
    body[heads] = False
    out[body] = loops.indices
    return out


def polydata(item: Item) -> pyvista.PolyData:
    """Return an item's geometry as PolyData; its field's values, if any, under the name `values`."""
    import pyvista

    buffer = cell_buffer(item.loops)
    if item.kind == "faces":
        drawn = pyvista.PolyData(np.array(item.points), faces=buffer)
    elif item.kind == "lines":
        drawn = pyvista.PolyData(np.array(item.points), lines=buffer)
    else:
        drawn = pyvista.PolyData(np.array(item.points), verts=buffer)
    if item.normals is not None:
        drawn.point_data.active_normals = np.array(item.normals)
    if item.field is not None:
        put_values(drawn, item.field)
    return drawn


def put_values(drawn: pyvista.PolyData, field: Field) -> None:
    """Set or replace the values that color a PolyData."""
    data = drawn.point_data if field.where == "vertex" else drawn.cell_data
    data[VALUES] = np.array(field.values)


def add_item(
    plotter: pyvista.Plotter, item: Item, *, view: View | None = None, depth: float = 1.0, scale: float = 1.0
) -> Drawn | None:
    """Add an item and return what was added; None where there is nothing to draw.

    Parameters
    ----------
    plotter : pyvista.Plotter
    item : Item
    view : View, optional
        A fixed line of sight: the item is shifted along it by its layer. Without one (a camera that turns)
        the depth buffer is offset instead.
    depth : float
        Diagonal of the picture, in units.
    scale : float
        Pixels per picture point, for the width of lines.
    """
    if not len(item.loops):
        return None
    drawn = polydata(item)
    options: dict[str, object] = {"show_scalar_bar": False, "name": None, "reset_camera": False, "pickable": False}
    if item.field is None:
        options["color"] = item.color
    else:
        options |= {
            "scalars": VALUES,
            "preference": "point" if item.field.where == "vertex" else "cell",
            "cmap": colormap(item.field),
            "clim": item.field.limits,
            "nan_color": theme.NO_VALUE,
        }
    if item.kind == "faces":
        options |= {theme.TARGET: _SMOOTH, theme.TILE: _MATTE}.get("" if item.field else item.color, _MAPPED)
        options["smooth_shading"] = item.normals is not None
    else:
        options |= {"lighting": False, "line_width": item.width * scale, "point_size": item.width * scale}
    actor = plotter.add_mesh(drawn, **options)
    if view is not None:
        actor.position = tuple(float(c) for c in np.array(view.direction) * item.layer * depth)
    else:
        _offset_depth(actor, item.layer)
    return Drawn(actor, drawn)


def colormap(field: Field) -> ListedColormap:
    """Return the matplotlib color map of a field: diverging where the sign matters."""
    from matplotlib import colormaps
    from matplotlib.colors import ListedColormap

    name, low, high = theme.DIVERGING if field.signed else theme.SEQUENTIAL
    return ListedColormap(colormaps[name](np.linspace(low, high, 255)), name=f"kirisurf {name}")


def add_lights(plotter: pyvista.Plotter) -> None:
    """Soft light that moves with the camera: a key from the upper left, a weak fill, no gloss."""
    import pyvista

    plotter.remove_all_lights()
    for position, intensity in (((-0.9, 0.9, 1.0), 0.92), ((0.9, 0.0, 1.0), 0.36)):
        light = pyvista.Light(position=position, focal_point=(0, 0, 0), light_type="camera light", intensity=intensity)
        plotter.add_light(light)


def aim(plotter: pyvista.Plotter, view: View, frame: Frame) -> None:
    """Point a parallel camera along a view at a frame."""
    center, toward = np.array(frame.center), np.array(view.direction)
    camera = plotter.camera
    camera.parallel_projection = True
    camera.focal_point = tuple(center)
    camera.position = tuple(center + 2.0 * frame.depth * toward)
    camera.up = view.up
    camera.parallel_scale = frame.half_height
    camera.clipping_range = (0.5 * frame.depth, 3.5 * frame.depth)


def plain_theme() -> pyvista.themes.Theme:
    """Return a pyvista theme of its own, so that a user's global one changes nothing here."""
    import pyvista

    chosen = pyvista.themes.Theme()
    chosen.background = theme.PAPER
    chosen.font.color = theme.INK
    chosen.font.family = "arial"
    return chosen


def _offset_depth(actor: pyvista.Actor, layer: float) -> None:
    mapper = actor.mapper
    mapper.SetResolveCoincidentTopologyToPolygonOffset()
    # VTK's shaders scale the offset by 1.6e-5 of the depth range, which is about a diagonal here.
    steps = -layer / 1.6e-5
    mapper.SetRelativeCoincidentTopologyPolygonOffsetParameters(0.0, steps)
    mapper.SetRelativeCoincidentTopologyLineOffsetParameters(0.0, steps)
    mapper.SetRelativeCoincidentTopologyPointOffsetParameter(steps)
