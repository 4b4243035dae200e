"""The tool bar: what can be done by a button or a key, and when."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from viewers.workbench.desktop.asking import ask_folder, ask_target, ask_where, with_suffix
from viewers.workbench.desktop.qt import qt
from viewers.workbench.events import Draw
from viewers.workbench.scene import deployment_scenes, turntable_scenes

if TYPE_CHECKING:
    from viewers.workbench.desktop.window import Workbench

DRAWINGS = ("Drawings for laser cutters (*.svg)", "Drawings for CAD (*.dxf)")
PICTURES = ("Pictures (*.png)",)
ANIMATIONS = ("Animations (*.gif)",)


def add_actions(bench: Workbench) -> dict[str, Any]:
    """Add the tool bar to a window and return its actions by name."""
    widgets = qt().widgets
    bar = widgets.QToolBar()
    bar.setMovable(False)
    bar.setContextMenuPolicy(qt().core.Qt.ContextMenuPolicy.PreventContextMenu)
    bar.setToolButtonStyle(qt().core.Qt.ToolButtonStyle.ToolButtonTextOnly)
    bench.window.addToolBar(bar)
    made: dict[str, Any] = {}

    def add(
        name: str, words: str, tip: str, act: Any, keys: str = "", checked: bool | None = None, place: Any = bar
    ) -> None:
        action = place.addAction(words)
        action.setToolTip(f"{tip}  ({keys})" if keys else tip)
        if keys:
            action.setShortcut(keys)
        if checked is None:
            action.triggered.connect(lambda _=False: act())
        else:
            action.setCheckable(True)
            action.setChecked(checked)
            action.toggled.connect(act)
        made[name] = action

    add("open", "Open \u2026", "Take another target: a mesh, or a planar outline", lambda: open_target(bench), "Ctrl+O")
    bar.addSeparator()
    add("fit", "\u25b6 Fit", "Fit the options as they are", bench.fit, "F5")
    add("stop", "\u25a0 Stop", "End the solver at its best point", bench.session.cancel, "Esc")
    add("resume", "Resume", "Go on from the best point of the fit that was stopped", lambda: bench.fit(True), "F6")
    add("live", "Live", "Fit at once when an option changes", bench.live, checked=bench.session.state.is_live)
    bar.addSeparator()
    add("undo", "\u21b6 Undo", "Take the last change back", bench.undo, "Ctrl+Z")
    add("redo", "\u21b7 Redo", "Do it again", bench.redo, "Ctrl+Shift+Z")
    bar.addSeparator()
    add(
        "place",
        "Place pattern",
        "Drag on the right picture to turn the pattern and to size its tiles",
        bench.place,
        "P",
        checked=False,
    )
    add("link", "Turn together", "Turn both pictures together", bench.link, "L", checked=True)
    add("reset", "First view", "Look from where the window first looked", lambda: bench.canvas.reset_view(), "Home")
    bar.addSeparator()
    add(
        "cut",
        "Cut file \u2026",
        "Write the flat pattern to cut, as SVG or DXF, to scale",
        lambda: save_cut_file(bench),
        "Ctrl+E",
    )
    add(
        "save",
        "Save run \u2026",
        "Write a run folder: cutting files, both states, certificate, report",
        lambda: save_run(bench),
        "Ctrl+S",
    )
    menu = widgets.QMenu(bench.window)
    menu.setToolTipsVisible(True)
    button = widgets.QToolButton()
    button.setObjectName("pictures")
    button.setText("Pictures")
    button.setToolTip("Write pictures and animations of the sheet")
    button.setPopupMode(widgets.QToolButton.ToolButtonPopupMode.InstantPopup)
    button.setMenu(menu)
    bar.addWidget(button)
    for name, words, tip, act, keys in (
        ("snapshot", "Snapshot \u2026", "Write both pictures as PNG", save_snapshot, "Ctrl+P"),
        (
            "deployment",
            "Deployment \u2026",
            "Write an animation of the opening as GIF (on the computed path, else interpolated)",
            save_deployment,
            "",
        ),
        ("turntable", "Turntable \u2026", "Write an animation that turns once as GIF", save_turntable, ""),
    ):
        add(name, words, tip, partial(act, bench), keys, place=menu)
    return made


def enable(bench: Workbench) -> None:
    """Let those actions be done that mean something now."""
    results, history = bench.session.results, bench.session.history
    is_idle, has_sheet = results.running is None, results.sheet is not None
    # a sheet of other options than those on show is not written under their name
    can_write = is_idle and results.is_current and results.job > 0 and not bench.session.is_stale
    for name, can in {
        "stop": not is_idle,
        "resume": results.can_resume and not bench.session.is_stale,
        "undo": bool(history.past),
        "redo": bool(history.future),
        "open": True,
        "cut": can_write,
        "save": can_write,
        "snapshot": is_idle and results.target is not None,
        "deployment": is_idle and has_sheet,
        "turntable": is_idle and has_sheet,
    }.items():
        bench.actions[name].setEnabled(can)


def open_target(bench: Workbench) -> None:
    """Ask for a file and fit it."""
    name = ask_target(bench.window)
    if name:
        bench.open(name)


def save_cut_file(bench: Workbench) -> None:
    """Ask for a file and write the cut pattern."""
    name = ask_where(bench.window, "Save the cut file", f"{_stem(bench)}-cut.svg", DRAWINGS)
    if name:
        bench.write(partial(bench.session.cut, name if name.lower().endswith((".svg", ".dxf")) else f"{name}.svg"))


def save_run(bench: Workbench) -> None:
    """Ask for a folder and write the run into it."""
    name = ask_folder(bench.window, "Save the run in a new folder", f"{_stem(bench)}-run")
    if name:
        bench.write(partial(bench.session.save, name))


def save_snapshot(bench: Workbench) -> None:
    """Ask for a file and write both pictures as they are described, at one scale, with their bars."""
    name = ask_where(bench.window, "Save both pictures", f"{_stem(bench)}.png", PICTURES)
    if name:
        scenes = tuple(scene for scene in bench.session.scenes() if scene.items)
        _draw(bench, Draw(scenes, with_suffix(name, PICTURES[0]), (1100, 1000)))


def save_deployment(bench: Workbench) -> None:
    """Ask for a file and write the way from contracted to deployed and back."""
    name = ask_where(bench.window, "Save the deployment", f"{_stem(bench)}-deployment.gif", ANIMATIONS)
    if name:
        scenes = deployment_scenes(bench.session.state, bench.session.results)
        _draw(bench, Draw(scenes, with_suffix(name, ANIMATIONS[0]), (800, 640)))


def save_turntable(bench: Workbench) -> None:
    """Ask for a file and write the deployed sheet turning once."""
    name = ask_where(bench.window, "Save the turntable", f"{_stem(bench)}-turntable.gif", ANIMATIONS)
    if name:
        scenes = turntable_scenes(bench.session.scenes()[1])
        _draw(bench, Draw(scenes, with_suffix(name, ANIMATIONS[0]), (800, 640)))


def _draw(bench: Workbench, request: Draw) -> None:
    bench.write(partial(bench.session.draw, request))


def _stem(bench: Workbench) -> str:
    return Path(bench.session.state.spec.target).stem
