"""Files that somebody waits for, until the engine reports that they are written, or why not."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from pathlib import Path

from kirisurf.errors import ParameterError
from viewers.workbench.events import Event, Failed, Lost, Written


class AwaitedFiles:
    """Files that were asked for."""

    def __init__(self) -> None:
        self._futures: dict[str, asyncio.Future[None]] = {}

    async def written(self, path: Path, ask: Callable[[], None]) -> None:
        """Ask for a file or folder and wait until it is there.

        Raises
        ------
        ParameterError
            Where it cannot be written.
        """
        future = asyncio.get_running_loop().create_future()
        self._futures[str(path)] = future
        try:
            ask()
            await future
        finally:
            self._futures.pop(str(path), None)

    def hear(self, event: Event) -> None:
        """Take in a report of the engine."""
        if isinstance(event, Written):
            future = self._futures.get(event.path)
            if future is not None and not future.done():
                future.set_result(None)
        elif isinstance(event, Lost) or (isinstance(event, Failed) and not event.job):
            self.give_up(event.message)

    def give_up(self, why: str) -> None:
        """Tell everybody who waits that nothing comes."""
        for future in self._futures.values():
            if not future.done():
                future.set_exception(ParameterError(why))
