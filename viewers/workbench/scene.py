"""The two views of a workbench as scenes: pure functions of what its user chose and what is known."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from analysis.similarity import laid_on
from kirisurf.arrays import frozen
from kirisurf.loops import Loops
from viewers import theme
from viewers.fields import Field, name_unit
from viewers.framing import FROM_ABOVE, View
from viewers.items import BEHIND, LINES, Item, segments, sheet_items, target_items
from viewers.scenes import Scene
from viewers.sheet import Sheet
from viewers.workbench.events import Shape
from viewers.workbench.pipeline import Stage
from viewers.workbench.poses import Poses, target_view
from viewers.workbench.results import Results
from viewers.workbench.state import Coloring, Selection, State

GUESS_LINE, PATTERN_LINE, PICKED_LINE = "#0072b2", "#7a8594", "#d55e00"
INTERPOLATED = "no mechanical path"


def deployed_view(state: State, results: Results, poses: Poses | None = None) -> Scene:
    """Return the view of the open sheet on its target: whatever is known of it, as far as it is shown.

    Parameters
    ----------
    state : State
    results : Results
    poses : Poses, optional
        Of the sheet, where they are at hand.
    """
    sheet = results.sheet
    poses = poses or (None if sheet is None else Poses(sheet))
    items = [*_target(state, results)]
    title, note, found = "Target", "", None
    if results.guess is not None and Stage.GUESS in state.shown:
        items.append(_outlines("guess", results.guess.points, results.guess.tiles, GUESS_LINE, 2 * LINES))
    if results.moving is not None:
        shape = results.moving
        title = f"Solving: step {len(results.steps)}" if results.steps else "Start: the pattern on the target"
        note = f"{len(shape.tiles)} tiles"
        if Stage.FIT in state.shown or Stage.GUESS in state.shown:
            items += _moving(shape)
    elif sheet is not None and poses is not None:
        found = coloring(state, results)
        points = poses.at(state.share)
        title, note = _title(state, sheet, found)
        if not results.is_current:
            title += ", before the change"
        drawn = sheet_items(sheet, points, found, holes=Stage.HOLES in state.shown)
        items += [item for item in drawn if Stage.FIT in state.shown or item.name == "holes"]
        items += _picked(state.selection, sheet, points)
    view = poses.view if poses is not None else _view_of(results)
    return Scene("deployed", title, tuple(items), view, _frame(results, poses), _units(state, results), note)


def contracted_view(state: State, results: Results, poses: Poses | None = None) -> Scene:
    """Return the view of the flat, closed sheet, in the frame of the deployed one so that both turn alike."""
    sheet = results.sheet
    if sheet is None:
        return _pattern_alone(state, results)
    poses = poses or Poses(sheet)
    items: list[Item] = []
    if Stage.PATTERN in state.shown and results.guess is not None and results.is_current:
        regular = poses.pattern(results.guess)
        if regular is not None:
            items.append(_outlines("pattern", regular, results.guess.tiles, PATTERN_LINE, -LINES))
    found = coloring(state, results)
    if found is not None and found.where == "hole":
        # closed holes have no area to color
        found = None
    if Stage.CONTRACTED in state.shown:
        drawn = sheet_items(sheet, poses.flat, found, holes=False)
        items += [replace(item, color=theme.TILE) if item.name == "tiles" else item for item in drawn]
        items += _picked(state.selection, sheet, poses.flat)
    width, height = np.ptp(sheet.contracted[:, :2], axis=0)
    note = f"{width:.4g} \u00d7 {height:.4g} {name_unit(sheet.units, height)}"
    title = "Contracted: flat and closed" if results.is_current else "Contracted, before the change"
    return Scene("contracted", title, tuple(items), poses.view, _frame(results, poses), sheet.units, note)


def coloring(state: State, results: Results) -> Field | None:
    """Return the field that colors the sheet, where it has one of that name."""
    sheet = results.sheet
    if sheet is None or state.coloring is None or state.coloring not in _colorings(sheet):
        return None
    return _described(sheet, *state.coloring)


def colorings(results: Results) -> tuple[Coloring, ...]:
    """Return the fields that can color the sheet."""
    return () if results.sheet is None else _colorings(results.sheet)


# asked for at every picture, and the same for every picture of a sheet
@lru_cache(maxsize=4)
def _colorings(sheet: Sheet) -> tuple[Coloring, ...]:
    return sheet.colorings


@lru_cache(maxsize=16)
def _described(sheet: Sheet, where: str, name: str) -> Field | None:
    return sheet.described(where, name)


def cell_numbers(sheet: Sheet, item: Item) -> np.ndarray:
    """Return the tile or hole that every face of an item belongs to, for picking.

    Holes with a curved patch are drawn as a grid of faces each, before those that are polygons.
    """
    count = len(item.loops)
    total = len(sheet.tiles) if item.name == "tiles" else len(sheet.holes)
    if count == total or sheet.patches is None:
        return np.arange(count)
    _, k, m, _ = sheet.patches.shape
    curved = np.isfinite(sheet.patches).reshape(total, -1).all(axis=1)
    each = (k - 1) * (m - 1)
    return np.concatenate([np.repeat(np.flatnonzero(curved), each), np.flatnonzero(~curved)])


def deployment_scenes(state: State, results: Results, count: int = 40) -> tuple[Scene, ...]:
    """Return the frames of an animation from contracted to deployed and back; empty without a sheet."""
    if results.sheet is None:
        return ()
    poses = Poses(results.sheet)
    shares = 0.5 - 0.5 * np.cos(np.linspace(0.0, 2 * np.pi, count, endpoint=False))
    still = replace(state, selection=None)
    return tuple(deployed_view(still.deployed_to(float(share)), results, poses) for share in shares)


def turntable_scenes(scene: Scene, count: int = 60) -> tuple[Scene, ...]:
    """Return the frames of a scene that turns once about the upright axis."""
    frames = []
    x, y, z = scene.view.direction
    if abs(z) > 0.95:
        # seen from above there is nothing to see of a turn: the eye comes down
        x, y, z = 0.4, -0.6, 0.69
    middle = 0.5 * (scene.frame.min(axis=0) + scene.frame.max(axis=0))
    radius = float(np.linalg.norm(scene.frame - middle, axis=1).max(initial=0.0)) or 1.0
    # one frame for all directions: the corners of a box round the sphere round everything
    box = frozen(middle + radius * np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]) * 0.6)
    for angle in np.linspace(0.0, 2 * np.pi, count, endpoint=False):
        c, s = np.cos(angle), np.sin(angle)
        turned = View((float(c * x - s * y), float(s * x + c * y), float(z)), (0.0, 0.0, 1.0))
        frames.append(replace(scene, view=turned, frame=box))
    return tuple(frames)


def _target(state: State, results: Results) -> tuple[Item, ...]:
    if results.target is None or Stage.TARGET not in state.shown:
        return ()
    covered = bool({Stage.FIT, Stage.HOLES, Stage.GUESS} & state.shown) and (
        results.sheet is not None or results.moving is not None
    )
    items = target_items(results.target, BEHIND if covered else 0.0)
    if covered and state.share < 1.0 and results.moving is None and results.target.outline is None:
        # a sheet on its way lies inside a curved target, which would hide it: the rim says where it is going
        return items[1:]
    if covered and results.target.outline is not None:
        # the outline is what a planar sheet is held against: it lies on top
        items = tuple(replace(item, layer=2 * LINES) if item.name == "rim" else item for item in items)
    return items


def _moving(shape: Shape) -> list[Item]:
    edges = segments(shape.tiles.edges)
    return [
        Item("tiles", "faces", shape.points, shape.tiles, theme.TILE),
        Item("tile edges", "lines", shape.points, edges, theme.TILE_EDGE, width=_width(shape.tiles), layer=LINES),
    ]


def _outlines(name: str, points: np.ndarray, tiles: Loops, color: str, layer: float) -> Item:
    return Item(name, "lines", frozen(points), segments(tiles.edges), color, width=1.2 * _width(tiles), layer=layer)


def _picked(selection: Selection | None, sheet: Sheet, points: np.ndarray) -> list[Item]:
    """A thick line round what is picked."""
    if selection is None:
        return []
    loops = sheet.tiles if selection.kind == "tile" else sheet.holes
    if selection.number >= len(loops):
        return []
    loop = loops[selection.number]
    around = segments(np.stack([loop, np.roll(loop, -1)], axis=1))
    return [Item("picked", "lines", frozen(points), around, PICKED_LINE, width=4.0, layer=4 * LINES)]


def _title(state: State, sheet: Sheet, found: Field | None) -> tuple[str, str]:
    if 0.0 < state.share < 1.0:
        part = f"{100 * state.share:.0f} % of the way"
        return (f"Interpolated: {part}", INTERPOLATED) if sheet.way is None else (f"Opening: {part}", sheet.way.words)
    title = "Deployed" if state.share else "Contracted"
    note = f"{len(sheet.tiles)} tiles, {len(sheet.holes)} holes"
    if found is not None and found.where == "hole" and np.isnan(found.values).any():
        note += f"; gray: {int(np.isnan(found.values).sum())} without a trustworthy patch"
    return title, note


def _pattern_alone(state: State, results: Results) -> Scene:
    """The regular pattern, before there is a sheet, in the size and attitude that it has on the target."""
    shape, title = results.moving or results.guess, "Contracted"
    items: list[Item] = []
    note = ""
    if shape is not None:
        flat = laid_on(np.column_stack([shape.flat, np.zeros(len(shape.flat))]), shape.points)
        items, note = _moving(replace(shape, points=flat)), f"{len(shape.tiles)} tiles"
        title = "Pattern: regular, before the fit"
    return Scene("pattern", title, tuple(items), _view_of(results), _frame(results, None), _units(state, results), note)


def _view_of(results: Results) -> View:
    if results.target is None or results.target.outline is not None:
        return FROM_ABOVE
    return target_view(results.target)


def _frame(results: Results, poses: Poses | None) -> np.ndarray:
    parts = [] if results.target is None else [results.target.vertices]
    if poses is not None:
        parts += [poses.sheet.deployed, poses.flat]
        parts += [] if poses.sheet.way is None else [poses.sheet.way.states.reshape(-1, 3)]
    return frozen(np.vstack(parts)) if parts else frozen(np.zeros((0, 3)))


def _units(state: State, results: Results) -> str:
    return state.spec.units or ("unit" if results.sheet is None else results.sheet.units)


def _width(tiles: Loops) -> float:
    # lines of many small tiles would otherwise darken what is between them
    return theme.EDGE_WIDTH * min(1.0, max(0.4, (150.0 / max(len(tiles), 1)) ** 0.5))
