"""The exchange of files between a desk and its browsers: targets come in, cut files and runs go out."""

from __future__ import annotations

import asyncio
import tempfile
from collections.abc import AsyncIterator, Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

from kirisurf.errors import KirisurfError, ParameterError
from kirisurf.spec import FitSpec
from viewers.workbench.engine import Engine
from viewers.workbench.pipeline import Stage
from viewers.workbench.web.desk import Desk
from viewers.workbench.web.downloads import checked_kind, drawing, file_name, from_run
from viewers.workbench.web.uploads import Uploads, check_target, discard


class Exchange:
    """What comes in and goes out.

    Parameters
    ----------
    desk : Desk
    engine : Engine
    folder : Path
        Private to this server; removed with it.
    opened : Path or None
        Run folder that was opened, whose files are given away until something else is fitted.
    """

    def __init__(self, desk: Desk, engine: Engine, folder: Path, opened: Path | None = None) -> None:
        self._desk, self._engine, self._folder, self._opened = desk, engine, folder, opened
        self._uploads = Uploads(folder)
        self._saved: dict[tuple[object, FitSpec, bool], Path] = {}
        self._one_at_a_time = asyncio.Lock()

    async def take(self, name: str, parts: AsyncIterator[bytes], announced: int | None = None) -> str:
        """Take a file as the new target and return its name; where that fails, everything stays as it is.

        Raises
        ------
        KirisurfError
            Where it can be no target.
        """
        path = await self._uploads.take(name, parts, announced)
        try:
            await asyncio.to_thread(check_target, path)
        except KirisurfError:
            discard(path)
            raise
        self._desk.open(str(path))
        self._desk.say("")
        self._desk.refresh()
        return path.name

    async def give(self, name: str) -> tuple[str, Path]:
        """Make a file and return a good name for it, and where it is.

        Raises
        ------
        KirisurfError
            Where there is no such file, nothing to make it from, or it cannot be made.
        """
        kind = checked_kind(name)
        async with self._one_at_a_time:
            session = self._desk.session
            called = file_name(name, session.state.spec.target)
            path = Path(tempfile.mkdtemp(prefix="download-", dir=self._folder)) / called
            if kind.of == "drawing":
                if session.results.running is not None or session.results.target is None:
                    raise ParameterError("download: expected nothing under way, got a fit that is; wait for its end")
                request = drawing(name, session, path)
                return called, await self._desk.written(path, lambda: session.draw(request))
            self._require_fit()
            if self._opened_run is not None:
                return called, await asyncio.to_thread(from_run, name, self._opened_run, path)
            spec = session.state.spec
            if kind.of == "cut":
                await self._tell_engine(session.results.job == 0)
                cut = partial(self._engine.cut, str(path), spec.hinge_width, spec.kerf)
                return called, await self._desk.written(path, partial(self._ask, "writing the cut file", cut))
            await self._tell_engine(session.results.job == 0 or spec != session.fitted_spec)
            run = await self._run(session.results.sheet, spec, kind.of == "pictures")
            return called, await asyncio.to_thread(from_run, name, run, path)

    async def _tell_engine(self, is_news: bool) -> None:
        """Let the engine hear of options that only concern files, or of a run that somebody else made."""
        if is_news:
            self._desk.session.fit()
            await self._desk.idle()

    async def _run(self, sheet: object, spec: FitSpec, with_pictures: bool) -> Path:
        """Return the run folder of the sheet on show, written where it is not yet."""
        for pictures in (with_pictures, True):
            if (sheet, spec, pictures) in self._saved:
                return self._saved[sheet, spec, pictures]
        folder = Path(tempfile.mkdtemp(prefix="run-", dir=self._folder)) / "run"
        is_upload = Path(spec.target).is_relative_to(self._folder)
        save = partial(self._engine.save, str(folder), pictures=with_pictures, carries_target=is_upload)
        await self._desk.written(folder, partial(self._ask, "writing the run", save))
        # runs of sheets that are gone are not asked for again
        self._saved = {key: path for key, path in self._saved.items() if key[0] is sheet}
        self._saved[sheet, spec, with_pictures] = folder
        return folder

    @property
    def _opened_run(self) -> Path | None:
        """The run that was opened, as long as it is what is on show."""
        session = self._desk.session
        return self._opened if session.results.job == 0 and session.state.spec == session.fitted_spec else None

    def _require_fit(self) -> None:
        session = self._desk.session
        if session.results.running is not None or session.is_stale or session.results.sheet is None:
            raise ParameterError("download: expected a fit of the options as they are, got none; press Fit first")

    def _ask(self, words: str, ask: Callable[[], None]) -> None:
        """Ask the engine for files, and say so."""
        session = self._desk.session
        session.results = replace(session.results, running=Stage.HOLES, doing=words)
        ask()
