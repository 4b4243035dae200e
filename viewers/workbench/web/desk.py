"""The desk: one session for all browsers. What they ask goes to the session, what the engine reports goes to them."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

from kirisurf.errors import KirisurfError, ParameterError
from kirisurf.targets import is_sample
from viewers.scenes import Scene
from viewers.workbench import options
from viewers.workbench.opening import retargeted
from viewers.workbench.options import in_labels
from viewers.workbench.pipeline import Stage
from viewers.workbench.placing import Placing
from viewers.workbench.scene import cell_numbers
from viewers.workbench.session import Session
from viewers.workbench.state import Selection, State
from viewers.workbench.views import Hit
from viewers.workbench.web.awaited import AwaitedFiles
from viewers.workbench.web.editors import option_value
from viewers.workbench.web.values import page_values

TICK = 0.015
"""Seconds between two looks at what the engine reports."""

SPEAKING = ("say", "explain_placing")
"""Actions that say something themselves; all others take away what was said before."""


@runtime_checkable
class Onlooker(Protocol):
    """A browser's pictures, which want to know when there is something new to draw."""

    def look(self, is_moving: bool) -> None:
        """Draw what is on the desk, when there is time."""

    async def leave(self) -> None:
        """Look no more."""


class Desk:
    """One session and everybody who looks at it.

    Parameters
    ----------
    session : Session
    publish : callable
        Receives values for the page.

    Attributes
    ----------
    scenes : (Scene, Scene)
        Contracted and deployed view.
    onlookers : set of Onlooker
    """

    def __init__(self, session: Session, publish: Callable[[dict[str, Any]], None]) -> None:
        self.session = session
        self.onlookers: set[Onlooker] = set()
        self._publish = publish
        self._placing = Placing(session)
        self._awaited = AwaitedFiles()
        self._refused = 0
        self._rests_until = 0.0
        self.scenes: tuple[Scene, Scene] = session.scenes()

    @property
    def framed(self) -> object:
        """What a first look is told apart by: another target, or the first sheet of one."""
        results = self.session.results
        return id(results.target) if results.target is not None else None, results.sheet is not None

    @property
    def actions(self) -> dict[str, Callable[..., None]]:
        """What a page may ask for, by name; every one says what went wrong instead of raising."""
        session = self.session
        asked: dict[str, Callable[..., Any]] = {
            "fit": lambda: session.fit(),
            "resume": lambda: session.fit(resume=True),
            "stop": session.cancel,
            "undo": session.undo,
            "redo": session.redo,
            "change": self.change,
            "lay_out": self.lay_out,
            "toggle": lambda stage: self._do(session.state.toggled(Stage(stage))),
            "run_again": lambda stage: session.fit(since=Stage(stage)),
            "color": self.color,
            "deploy": lambda share: session.adjust(session.state.deployed_to(float(share) / 100)),
            "link": lambda together: session.adjust(session.state.linked(bool(together))),
            "live": lambda at_once: self._do(session.state.live(bool(at_once))),
            "open_sample": self.open_sample,
            "say": self.say,
            "explain_placing": lambda: self.say(self._placing.hint),
        }
        return {name: self._guarded(name, act) for name, act in asked.items()}

    def change(self, name: str, given: Any) -> None:
        """Change an option of the fit; raises where the value does not do."""
        self._do(self.session.state.with_option(name, option_value(name, given)))

    def lay_out(self, kind: str) -> None:
        """Exchange a rectangular pattern for a trimmed one, or the other way round."""
        spec = self.session.state.spec
        self._do(
            self.session.state.with_spec(options.with_cells(spec) if kind == "cells" else options.with_tiles(spec))
        )

    def color(self, chosen: str) -> None:
        """Color by a field, given as where/name; by none where the text is empty."""
        where, _, name = str(chosen).partition("/")
        self._do(self.session.state.colored((where, name) if chosen else None))

    def open_sample(self, name: str) -> None:
        """Take a sample surface as the target; raises where there is none of that name."""
        if not is_sample(str(name)):
            raise ParameterError(f"sample: expected one of the list, got {str(name)[:60]!r}")
        self.open(name)

    def open(self, target: str) -> None:
        """Take another target; raises where its name says that it cannot be."""
        self._do(retargeted(self.session.state, target))
        if not self.session.state.is_live:
            self.session.fit()

    def pick(self, hit: Hit) -> bool:
        """Pick the tile or hole of a face; whether there was one."""
        results, state = self.session.results, self.session.state
        item = next((item for item in self.scenes[hit.side].items if item.name == hit.name), None)
        selection = None
        if results.sheet is not None and item is not None and hit.face >= 0 and results.moving is None:
            found = cell_numbers(results.sheet, item)
            if hit.face < len(found):
                selection = Selection("tile" if hit.name == "tiles" else "hole", int(found[hit.face]))
        self.session.adjust(state.picked(selection))
        self.refresh()
        return self.session.state.selection is not None

    def place(self, degrees: float | int, ratio: float | int, ended: bool) -> None:
        """Turn and size the pattern by a drag so far."""
        try:
            words = self._placing.drag(degrees, ratio, ended)
        except KirisurfError as problem:
            self.say(str(problem), True)
            return
        self.refresh()
        self.say("" if ended else words)

    def say(self, words: str, is_problem: bool = False) -> None:
        """Say something above the page; an empty text takes it away."""
        self._publish({"notice": words, "notice_kind": "problem" if is_problem else "words"})

    def refresh(self, is_moving: bool = False) -> None:
        """Show the session as it is, on the page and in the pictures."""
        self.scenes = self.session.scenes()
        self._publish(page_values(self.session, self.scenes))
        for onlooker in tuple(self.onlookers):
            onlooker.look(is_moving)

    async def written(self, path: Path, ask: Callable[[], None]) -> Path:
        """Ask the engine for a file or folder and wait until it is there.

        Raises
        ------
        KirisurfError
            Where it cannot be written.
        """

        def ask_and_show() -> None:
            ask()
            self.refresh()

        try:
            await self._awaited.written(path, ask_and_show)
        finally:
            # where it was written says nothing to somebody in a browser
            self.session.results = replace(self.session.results, said="")
            self.refresh()
        return path

    async def idle(self) -> None:
        """Wait until the engine has nothing to do."""
        while self.session.results.running is not None:
            await asyncio.sleep(TICK)

    async def listen(self) -> None:
        """Take in what the engine reports, and show it, for ever."""
        behind = False
        while True:
            for event in self.session.engine.events():
                self.session.take(event)
                self._awaited.hear(event)
                behind = True
            # pictures of a sheet on its way take a third of the time at most: the solver may need the same cores
            moving = self.session.results.moving is not None and self.session.results.running is not None
            if behind and (not moving or time.monotonic() >= self._rests_until):
                began, behind = time.monotonic(), False
                self.refresh(moving)
                self._placing.follow()
                self._rests_until = time.monotonic() + max(2.0 * (time.monotonic() - began), 0.08)
            await asyncio.sleep(TICK)

    async def close(self) -> None:
        """Send everybody home, and tell those who wait for a file."""
        self._awaited.give_up("kirisurf was closed before the file was written")
        for onlooker in tuple(self.onlookers):
            await onlooker.leave()

    def enter(self, onlooker: Onlooker) -> None:
        """Let somebody look."""
        self.onlookers.add(onlooker)
        self._publish({"tabs": len(self.onlookers)})

    def exit(self, onlooker: Onlooker) -> None:
        """Let somebody go; what is under way goes on."""
        self.onlookers.discard(onlooker)
        self._publish({"tabs": len(self.onlookers)})

    def _do(self, state: State) -> None:
        if state != self.session.state:
            self.session.do(state)

    def _guarded(self, name: str, act: Callable[..., Any]) -> Callable[..., None]:
        def guarded(*given: Any) -> None:
            try:
                act(*given)
            except KirisurfError as problem:
                self.say(in_labels(str(problem)), True)
                # the editor still shows what was refused
                self._refused += 1
                self._publish({"refused": self._refused})
            except (TypeError, ValueError) as problem:
                self.say(f"This was not understood: {problem}", True)
            else:
                if name not in SPEAKING:
                    self.say("")
            self.refresh(is_moving=name == "deploy")

        return guarded
