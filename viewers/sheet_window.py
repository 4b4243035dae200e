"""The window of a sheet: both states side by side, to turn, to color and to blend."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np

from viewers import theme
from viewers.drawing import Drawn, add_item, add_lights, aim, plain_theme
from viewers.fields import Field
from viewers.framing import fit_frame
from viewers.items import BEHIND, Item, sheet_items, target_items
from viewers.sheet import Sheet, blended, laid_flat, sheet_view

HELP = (
    "t  target      k  tiles      h  holes\n"
    "n / b  next / previous field\n"
    "l  turn together or apart      o  first view\n"
    "x  save a picture      q  close"
)
SIZE = (1500, 850)
_PARTS = {"target": ("target", "rim"), "tiles": ("tiles", "tile edges"), "holes": ("holes",)}
_POLYGONS = ("tiles", "tile edges", "holes")


class SheetWindow:
    """The two linked views of a sheet and their state: what is shown, colored and blended.

    Parameters
    ----------
    sheet : Sheet
    title : str
    off_screen : bool
        For tests and pictures: nothing is shown.

    Attributes
    ----------
    plotter : pyvista.Plotter
    shown : dict of str to bool
        target, tiles, holes.
    coloring : (str, str) or None
        Field by which the sheet is colored.
    share : float
        0 contracted, 1 deployed; between them a straight blend.
    """

    def __init__(self, sheet: Sheet, title: str = "kirisurf", *, off_screen: bool = False) -> None:
        import pyvista

        self.sheet = sheet
        self.shown = {"target": True, "tiles": True, "holes": True}
        self.colorings: list[tuple[str, str] | None] = [None, *sheet.colorings]
        first = ("hole", "gaussian_curvature")
        self.coloring: tuple[str, str] | None = first if first in self.colorings else None
        self.share = 1.0
        self.linked = True
        self._flat = laid_flat(sheet)
        self._drawn: dict[tuple[int, str], Drawn] = {}
        self._view = sheet_view(sheet)
        self.plotter = pyvista.Plotter(
            shape=(1, 2),
            title=title,
            window_size=list(SIZE),
            off_screen=off_screen,
            lighting="none",
            border=False,
            theme=plain_theme(),
        )
        for side in (0, 1):
            self.plotter.subplot(0, side)
            add_lights(self.plotter)
            self.plotter.enable_anti_aliasing("msaa", multi_samples=4)
        self._redraw()
        self.reset_view()
        self.plotter.link_views()
        self._add_controls()

    def toggle(self, part: str) -> None:
        """Show or hide target, tiles or holes."""
        self.shown[part] = not self.shown[part]
        self._apply_shown()
        self.plotter.render()

    def cycle(self, step: int = 1) -> None:
        """Color by the next (1) or previous (-1) field; plain tiles come between the last and the first."""
        place = self.colorings.index(self.coloring) if self.coloring in self.colorings else 0
        self.coloring = self.colorings[(place + step) % len(self.colorings)]
        self._redraw()
        self.plotter.render()

    def blend(self, share: float) -> None:
        """Move the right view's sheet between contracted (0) and deployed (1)."""
        before, self.share = self.share, min(max(float(share), 0.0), 1.0)
        if (before == 1.0) != (self.share == 1.0) and self.sheet.patches is not None:
            # Curved hole patches exist for the deployed state alone.
            self._redraw()
        else:
            points = np.array(self._points())
            for name in _POLYGONS:
                drawn = self._drawn.get((1, name))
                if drawn is not None:
                    drawn.data.points = points
        self._write_titles()

    def turn_together(self) -> None:
        """Link or unlink the cameras of the two views."""
        self.linked = not self.linked
        if self.linked:
            self.plotter.link_views()
        else:
            self.plotter.unlink_views()
        self._say("the views turn together" if self.linked else "the views turn apart")

    def reset_view(self) -> None:
        """Look again from where the window first looked."""
        width, height = self.plotter.window_size
        everything = [self.sheet.deployed, self._flat]
        if self.sheet.target is not None:
            everything.append(self.sheet.target.vertices)
        frame = fit_frame(self._view, np.vstack(everything), 0.5 * width / height, margin=0.13)
        for side in (0, 1):
            self.plotter.subplot(0, side)
            aim(self.plotter, self._view, frame)
            self.plotter.renderer.ResetCameraClippingRange()

    def save_picture(self) -> Path:
        """Write what the window shows as kirisurf-view-N.png in the current folder; the path.

        Raises
        ------
        OutputError
            Where the file cannot be written.
        """
        from PIL import Image

        from kirisurf.formats.atomic import write_bytes

        number = 1
        while (path := Path(f"kirisurf-view-{number}.png")).exists():
            number += 1
        buffer = io.BytesIO()
        Image.fromarray(np.asarray(self.plotter.screenshot(return_img=True))).save(buffer, format="PNG")
        write_bytes(path, buffer.getvalue())
        self._say(f"saved {path}")
        return path

    def _points(self) -> np.ndarray:
        return self.sheet.deployed if self.share == 1.0 else blended(self._flat, self.sheet.deployed, self.share)

    def _redraw(self) -> None:
        """Draw both views anew; the cameras stay."""
        found = self.sheet.described(*self.coloring) if self.coloring is not None else None
        for side, points in ((0, self._flat), (1, self._points())):
            self.plotter.subplot(0, side)
            for key in [key for key in self._drawn if key[0] == side]:
                self.plotter.remove_actor(self._drawn.pop(key).actor, render=False, reset_camera=False)
            items: tuple[Item, ...] = sheet_items(self.sheet, points, found)
            if side == 1 and self.sheet.target is not None:
                items = target_items(self.sheet.target, BEHIND) + items
            for item in items:
                drawn = add_item(self.plotter, item)
                if drawn is not None:
                    self._drawn[side, item.name] = drawn
        self._apply_shown()
        self._draw_bar(found)
        self._write_titles()

    def _apply_shown(self) -> None:
        for part, names in _PARTS.items():
            for side in (0, 1):
                for name in names:
                    if (side, name) in self._drawn:
                        self._drawn[side, name].actor.visibility = self.shown[part]

    def _draw_bar(self, found: Field | None) -> None:
        self.plotter.subplot(0, 1)
        for name in list(self.plotter.scalar_bars.keys()):
            self.plotter.remove_scalar_bar(name, render=False)
        if found is None:
            self._text(1, "bar", "", (0.0, 0.0))
            return
        name = {"hole": "holes", "tile": "tiles", "vertex": "tiles"}[found.where]
        drawn = self._drawn.get((1, name))
        if drawn is not None:
            self.plotter.add_scalar_bar(
                title=" ",
                mapper=drawn.actor.mapper,
                vertical=True,
                position_x=0.85,
                position_y=0.3,
                width=0.05,
                height=0.42,
                n_labels=5,
                fmt="{:.3g}",
                title_font_size=16,
                label_font_size=14,
                color=theme.INK,
                interactive=False,
                render=False,
            )
        label = found.label[:1].upper() + found.label[1:]
        words = "\n".join(part for part in (label, found.unit and f"in {found.unit}", found.range_note) if part)
        self._text(1, "bar", words, (0.97, 0.76), "right")

    def _write_titles(self) -> None:
        between = 0.0 < self.share < 1.0
        state = f"Interpolated, {100 * self.share:.0f} %" if between else "Deployed" if self.share else "Contracted"
        self._text(0, "title", "Contracted: flat and closed", (0.03, 0.95), size=13)
        self._text(1, "title", state, (0.03, 0.95), size=13)
        self._text(1, "remark", "a straight blend, not a mechanical path" if between else "", (0.03, 0.91))

    def _text(
        self, side: int, name: str, words: str, place: tuple[float, float], align: str = "left", size: int = 10
    ) -> None:
        self.plotter.subplot(0, side)
        if not words:
            self.plotter.remove_actor(f"{name} {side}", render=False, reset_camera=False)
            return
        actor = self.plotter.add_text(
            words,
            position=place,
            viewport=True,
            font_size=size,
            color=theme.INK if name == "title" else theme.MUTED,
            name=f"{name} {side}",
            render=False,
        )
        actor.prop.SetLineSpacing(1.25)
        if align == "right":
            actor.prop.justification_horizontal = "right"

    def _say(self, words: str) -> None:
        self._text(0, "said", words, (0.03, 0.9))
        self.plotter.render()

    def _add_controls(self) -> None:
        self._text(0, "help", HELP, (0.03, 0.03))
        self.plotter.subplot(0, 1)
        self.plotter.add_slider_widget(
            self.blend,
            (0.0, 1.0),
            value=1.0,
            title="contracted  -  interpolated  -  deployed",
            pointa=(0.25, 0.09),
            pointb=(0.75, 0.09),
            style="modern",
            color=theme.MUTED,
            title_color=theme.MUTED,
            title_height=0.018,
            slider_width=0.018,
            tube_width=0.004,
            fmt="%.2f",
            interaction_event="always",
        )
        self.plotter.reset_key_events()
        for key, action in {
            "t": lambda: self.toggle("target"),
            "k": lambda: self.toggle("tiles"),
            "h": lambda: self.toggle("holes"),
            "n": lambda: self.cycle(1),
            "b": lambda: self.cycle(-1),
            "l": self.turn_together,
            "o": self._reset_and_render,
            "x": self.save_picture,
        }.items():
            self.plotter.add_key_event(key, action)

    def _reset_and_render(self) -> None:
        self.reset_view()
        self.plotter.render()
