"""A page's server in this process, with an engine that only notes what it is asked."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Awaitable, Callable

import pytest

from viewers.workbench.engine import Engine
from viewers.workbench.events import Ended, Written
from viewers.workbench.pipeline import Stage
from viewers.workbench.session import Session
from viewers.workbench.web.desk import Desk
from viewers.workbench.web.libraries import INSTALL_LINE, is_installed
from viewers.workbench.web.serving import Server


class Noted(Engine):
    """An engine that notes what it is asked, reports what a test puts there, and writes a word for every cut file."""

    def __init__(self) -> None:
        super().__init__()
        self.asked, self.reports, self.closed = [], [], False

    def warm_up(self):
        return

    def start(self, spec, since=Stage.HOLES, until=Stage.HOLES, resume=False):
        self.asked.append(spec)
        self.reports.append(Ended(len(self.asked)))
        return len(self.asked)

    def cut(self, path, hinge_width, kerf):
        with open(path, "w", encoding="utf-8") as file:
            file.write(f"cut with kerf {kerf:g}")
        self.reports.append(Written(path))

    def cancel(self):
        self.asked.append("cancel")

    def events(self, wait=0.0):
        reports, self.reports = self.reports, []
        return iter(reports)

    def close(self):
        self.closed = True


@pytest.fixture
def engine() -> Noted:
    return Noted()


@pytest.fixture
def session(state, fitted, engine) -> Session:
    return Session(state, fitted, engine)


@pytest.fixture
def published() -> dict[str, object]:
    """Everything that a desk has told its page."""
    return {}


@pytest.fixture
def desk(session, published) -> Desk:
    return Desk(session, published.update)


class Visit:
    """A server and a way to ask it."""

    def __init__(self, server, client) -> None:
        self.server, self.client = server, client
        self.address = server.guard.address
        self.origin = self.address[: self.address.index("/", 8)]

    async def get(self, path="", **how):
        async with self.client.get(self.address + path, allow_redirects=False, **how) as answer:
            return answer.status, await answer.text()

    async def post(self, path, data, **headers):
        headers = {"Origin": self.origin, **headers}
        async with self.client.post(self.address + path, data=data, headers=headers) as answer:
            return answer.status, await answer.text()


@pytest.fixture
def visit(request, state, fitted, engine) -> Callable[[Callable[[Visit], Awaitable[None]]], None]:
    """Run a coroutine against a server that answers as long as it runs."""
    if not is_installed():
        pytest.skip(f"{request.node.name} did not run: {INSTALL_LINE}")
    import aiohttp

    async def around(act):
        server, ready = Server(state, fitted, engine), asyncio.Event()
        serving = asyncio.create_task(server.serve(lambda address: ready.set()))
        waiting = asyncio.create_task(ready.wait())
        await asyncio.wait({serving, waiting}, return_when=asyncio.FIRST_COMPLETED)
        waiting.cancel()
        try:
            async with aiohttp.ClientSession() as client:
                await act(Visit(server, client))
        finally:
            server.end.set()
            with contextlib.suppress(asyncio.CancelledError):
                await asyncio.wait_for(serving, 120)
        assert engine.closed

    return lambda act: asyncio.run(around(act))
