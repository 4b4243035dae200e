"""The window of the workbench: it asks the session what to show, and tells it what the user does."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from kirisurf.errors import KirisurfError
from kirisurf.spec import FitSpec
from viewers.workbench.desktop import actions
from viewers.workbench.desktop.option_panel import OptionPanel
from viewers.workbench.desktop.pictures_panel import PicturesPanel
from viewers.workbench.desktop.qt import qt
from viewers.workbench.desktop.side_panel import SidePanel
from viewers.workbench.desktop.stage_strip import StageStrip
from viewers.workbench.desktop.status_line import StatusLine
from viewers.workbench.desktop.style import SHEET
from viewers.workbench.opening import check_target, retargeted
from viewers.workbench.options import in_labels
from viewers.workbench.pipeline import Stage
from viewers.workbench.placing import Placing
from viewers.workbench.progress import progress_words, solved_share
from viewers.workbench.scene import cell_numbers, coloring
from viewers.workbench.session import Session
from viewers.workbench.state import Coloring, Selection, State

TICK = 15
"""Milliseconds between two looks at what the engine reports."""

SIZE = (1500, 900)


class Workbench:
    """The window.

    Parameters
    ----------
    session : Session
    title : str

    Attributes
    ----------
    window : QMainWindow
    pictures : PicturesPanel
    canvas : Canvas
    panel : OptionPanel
    strip : StageStrip
    side : SidePanel
    slider : QSlider
        Deployment, in hundredths.
    """

    def __init__(self, session: Session, title: str = "kirisurf") -> None:
        widgets, core = qt().widgets, qt().core
        self.session = session
        self.window = qt().Window()
        self._title, self._first_target = title, session.state.spec.target
        self.window.resize(*SIZE)
        self.window.setStyleSheet(SHEET)
        self.window.on_close = self.close
        self.window.on_drop = self.open
        self.actions = actions.add_actions(self)
        self.strip = StageStrip(self.toggle, self.run_again)
        self.panel = OptionPanel(self.change, self.replace_spec)
        self.side = SidePanel(self.color)
        self.pictures = PicturesPanel(self.pick, self.drag, self.deploy)
        self.canvas, self.slider = self.pictures.canvas, self.pictures.slider
        middle = self.pictures.widget
        parts = widgets.QSplitter(core.Qt.Orientation.Horizontal)
        for widget, stretch in ((self.panel.widget, 0), (middle, 1), (self.side.widget, 0)):
            parts.addWidget(widget)
            parts.setStretchFactor(parts.count() - 1, stretch)
            parts.setCollapsible(parts.count() - 1, widget is not middle)
        parts.setSizes([304, 856, 340])
        whole = widgets.QWidget()
        column = widgets.QVBoxLayout(whole)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self.strip.widget)
        column.addWidget(parts, 1)
        self.window.setCentralWidget(whole)
        self.foot = StatusLine(self.window.statusBar())
        self.status = self.foot.label
        self._framed: Any = None
        self._placing = Placing(session)
        self._is_closed = False
        self._is_behind, self._rests_until = False, 0.0
        self._timer = core.QTimer()
        self._timer.timeout.connect(self.tick)
        self._timer.start(TICK)
        self.refresh()

    # what the user does

    def change(self, name: str, value: Any) -> None:
        """Change an option of the fit; a value that does not do is said and taken back."""
        try:
            state = self.session.state.with_option(name, value)
        except KirisurfError as problem:
            self.say(str(problem), is_problem=True)
            self.panel.show(self.session.state.spec)
            return
        self._do(state)

    def replace_spec(self, spec: FitSpec) -> None:
        """Take another set of options."""
        self._do(self.session.state.with_spec(spec))

    def open(self, name: str) -> None:
        """Take another target; one that does not do is said, and what was there stays."""
        try:
            check_target(name)
            state = retargeted(self.session.state, name)
        except KirisurfError as problem:
            self.say(str(problem), is_problem=True)
            return
        self._do(state)

    def toggle(self, stage: Stage) -> None:
        """Show or hide a stage."""
        self._do(self.session.state.toggled(stage))

    def run_again(self, stage: Stage) -> None:
        """Run again from a stage on."""
        self.foot.forget()
        self.session.fit(since=stage)
        self.refresh()

    def color(self, chosen: Coloring | None) -> None:
        """Color by a field."""
        self._do(self.session.state.colored(chosen))

    def deploy(self, hundredths: int) -> None:
        """Move the sheet between its states."""
        self.session.adjust(self.session.state.deployed_to(hundredths / 100))
        self.refresh()

    def fit(self, resume: bool = False) -> None:
        """Start a fit of the options as they are."""
        self.foot.forget()
        self.session.fit(resume=resume)
        self.refresh()

    def write(self, ask: Callable[[], None]) -> None:
        """Ask the session to write something."""
        self.foot.forget()
        ask()
        self.refresh()

    def undo(self) -> None:
        """Take the last deed back."""
        self.foot.forget()
        self.session.undo()
        self.refresh()

    def redo(self) -> None:
        """Do the last undone deed again."""
        self.foot.forget()
        self.session.redo()
        self.refresh()

    def link(self, together: bool) -> None:
        """Turn the views together, or each by itself."""
        self.session.adjust(self.session.state.linked(together))
        self.canvas.link(together)

    def live(self, at_once: bool) -> None:
        """Start fits at once when an option changes, or wait to be asked."""
        self._do(self.session.state.live(at_once))

    def place(self, wanted: bool) -> None:
        """Let drags on the right view turn and size the pattern, or the camera."""
        self.canvas.is_placing = wanted
        cursor = qt().core.Qt.CursorShape
        self.canvas.widget.setCursor(cursor.CrossCursor if wanted else cursor.ArrowCursor)
        if wanted:
            self.foot.hold(self._placing.hint)
        else:
            self.foot.forget()
            self.refresh()

    def pick(self, side: int, name: str, face: int) -> None:
        """Pick the tile or hole of a face."""
        sheet, selection = self.session.results.sheet, None
        item = self.canvas.item(side, name)
        if sheet is not None and item is not None and face >= 0 and self.session.results.moving is None:
            numbers = cell_numbers(sheet, item)
            if face < len(numbers):
                selection = Selection("tile" if name == "tiles" else "hole", int(numbers[face]))
        state = self.session.state.picked(selection)
        if state != self.session.state:
            self.session.adjust(state)
            if state.selection is not None:
                self.side.tabs.setCurrentIndex(1)
            self.refresh()

    def drag(self, degrees: float, ratio: float, ended: bool) -> None:
        """Turn and size the pattern by a drag; it is laid anew while the hand moves and fitted when it lets go."""
        try:
            words = self._placing.drag(degrees, ratio, ended)
        except KirisurfError as problem:
            self.say(str(problem), is_problem=True)
            return
        if ended:
            self.foot.forget()
        else:
            self.foot.hold(f"{words}: let go to {'fit' if self.session.state.is_live else 'keep'} it")
        self.refresh()

    # what is shown

    def refresh(self) -> None:
        """Show the state and the results as they are."""
        session = self.session
        state, results = session.state, session.results
        self._is_behind = False
        target = state.spec.target
        self.window.setWindowTitle(self._title if target == self._first_target else f"kirisurf: {Path(target).name}")
        scenes = session.scenes()
        on_its_way = results.moving is not None
        found = None if on_its_way else coloring(state, results)
        self.pictures.show(scenes, found, state.share, results.sheet is not None and not on_its_way)
        self._scenes = scenes
        self._aim_once()
        self.panel.show(state.spec)
        self.strip.show(state.shown, results.running)
        self.side.show(state, results)
        actions.enable(self)
        self._show_progress()

    def tick(self) -> None:
        """Take in what the engine reports, and show it."""
        if self._is_closed:
            return
        self._is_behind |= self.session.listen()
        # pictures of a sheet on its way take a third of the time at most: the solver may need the same cores
        moving = self.session.results.moving is not None and self.session.results.running is not None
        if self._is_behind and (not moving or time.monotonic() >= self._rests_until):
            began = time.monotonic()
            self.refresh()
            self._rests_until = time.monotonic() + 2.0 * (time.monotonic() - began)
            self._placing.follow()
        self.pictures.measure()

    def say(self, words: str, is_problem: bool = False) -> None:
        """Say something in the status line; a problem stays there until the user does something else."""
        if is_problem:
            self.foot.hold(in_labels(words), True)
        else:
            self.foot.say(words)

    def close(self) -> None:
        """End the engine and give the OpenGL window back."""
        if not self._is_closed:
            self._is_closed = True
            self._timer.stop()
            self.session.engine.close()
            self.canvas.close()

    def _do(self, state: State) -> None:
        self.foot.forget()
        if state != self.session.state:
            self.session.do(state)
        self.refresh()

    def _aim_once(self) -> None:
        """Frame the first pictures of a target and of its first sheet; later ones keep the user's view."""
        results = self.session.results
        what = (id(results.target) if results.target is not None else None, results.sheet is not None)
        if what != self._framed and any(len(scene.frame) for scene in self._scenes):
            self._framed = what
            self.canvas.reset_view()

    def _show_progress(self) -> None:
        results = self.session.results
        words, is_problem = progress_words(results, self.session.is_stale)
        share = solved_share([step.residuals for step in results.steps], self.session.state.spec.tolerance)
        self.foot.follow(
            in_labels(words),
            is_problem,
            None if results.running is None else share if results.running is Stage.FIT else 1.0,
        )
