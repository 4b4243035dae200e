"""The server: one session, served on loopback until it is told to end.

trame keeps the page's values in step; the addresses, the guard and the images are ours.
"""

from __future__ import annotations

import asyncio
import errno
import importlib
import logging
import os
import signal
import tempfile
from collections.abc import Callable
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from kirisurf.errors import OutputError, ParameterError
from viewers.opengl import probe
from viewers.workbench.engine import Engine
from viewers.workbench.results import Results
from viewers.workbench.session import Session
from viewers.workbench.state import State
from viewers.workbench.web.desk import Desk
from viewers.workbench.web.exchange import Exchange
from viewers.workbench.web.guard import LOOPBACK, Guard, new_key
from viewers.workbench.web.pictures import LEAST, Pictures
from viewers.workbench.web.routes import STATIC, Routes
from viewers.workbench.web.values import fixed_values, page_values

LIBRARIES = ("aiohttp.web", "trame_server", "trame_client.module", "trame_client.widgets.core")
SIGNALS = ("SIGINT", "SIGTERM", "SIGHUP")


class Server:
    """The workbench as a page.

    Parameters
    ----------
    state : State
    results : Results
    engine : Engine
        Closed with the server.
    port : int
        0 for any that is free.
    title : str
    opened : Path, optional
        Run folder that the results are from.

    Raises
    ------
    ParameterError
        Where the port cannot be had.
    """

    def __init__(
        self,
        state: State,
        results: Results,
        engine: Engine,
        port: int = 0,
        title: str = "kirisurf",
        opened: Path | None = None,
    ) -> None:
        self.session = Session(state, results, engine)
        self._engine, self._port, self._title, self._opened = engine, port, title, opened
        self.end = asyncio.Event()
        self.guard = Guard(new_key())

    async def serve(self, ready: Callable[[str], None]) -> None:
        """Serve until `end` is set; `ready` receives the page's address as soon as it answers."""
        with tempfile.TemporaryDirectory(prefix="kirisurf-", ignore_cleanup_errors=True) as folder:
            server = _trame_server(self._title)
            self.desk = Desk(self.session, lambda values: _publish(server, values))
            exchange = Exchange(self.desk, self._engine, Path(folder), self._opened)
            page = (Path(server._www) / "index.html").read_text("utf-8")
            self.guard = Guard(new_key(), page)
            secret = new_key()
            routes = Routes(self.desk, exchange, page, f"secret={secret}&sessionURL=ws://USE_HOST/{self.guard.key}/ws")
            _prepare(server, self.desk, secret)
            server.controller.on_server_bind.add(lambda bound: _mount(bound, self.guard, routes, server))
            listening = asyncio.create_task(self._run(server))
            try:
                await _first(server.ready, listening)
                self.guard.port = server.port
                if self.session.results.sheet is None:
                    self.session.fit()
                hearing = asyncio.create_task(self.desk.listen())
                ready(self.guard.address)
                await _warm_up_drawing()
                await _first(self.end.wait(), listening, hearing)
                hearing.cancel()
                await self.desk.close()
                await server.stop()
            finally:
                listening.cancel()
                await asyncio.gather(listening, return_exceptions=True)
                self._engine.close()

    async def _run(self, server: Any) -> None:
        try:
            with _own_arguments():
                answering = server.start(
                    port=self._port,
                    host=LOOPBACK,
                    open_browser=False,
                    show_connection_info=False,
                    disable_logging=True,
                    timeout=0,
                    exec_mode="coroutine",
                )
            await answering
        except OSError as problem:
            raise port_error(self._port, problem) from None


def prepare() -> None:
    """Import what a page needs, which takes a second."""
    for name in LIBRARIES:
        importlib.import_module(name)


def serve(
    state: State,
    results: Results,
    engine: Engine,
    ready: Callable[[str], None],
    port: int = 0,
    title: str = "kirisurf",
    opened: Path | None = None,
) -> None:
    """Serve the workbench until a signal ends it; parameters and errors as for :class:`Server`."""

    async def run() -> None:
        server = Server(state, results, engine, port, title, opened)
        loop = asyncio.get_running_loop()
        for name in SIGNALS:
            if hasattr(signal, name):
                loop.add_signal_handler(getattr(signal, name), server.end.set)
        await server.serve(ready)

    try:
        asyncio.run(run())
    finally:
        engine.close()


def port_error(port: int, problem: OSError) -> ParameterError | OutputError:
    """Return what is to be said where a port cannot be had."""
    if problem.errno == errno.EADDRINUSE:
        return ParameterError(
            f"--port: expected one that is free, got {port}, which another program uses; "
            f"try --port {port + 1 if port < 65535 else 8080}, or leave it out for any free one"
        )
    if problem.errno in (errno.EACCES, errno.EPERM):
        return ParameterError(f"--port: expected one that this user may open, got {port}; try one above 1023")
    return OutputError(f"the page cannot be served: {problem.strerror or problem}")


def _trame_server(title: str) -> Any:
    """A server of trame with the page's template, and nothing of its own in the open."""
    client, core, trame = (
        importlib.import_module(name) for name in ("trame_client.module", "trame_client.widgets.core", "trame_server")
    )
    # its defects are told on the page; what a browser sends is no reason for a traceback in the terminal
    logging.getLogger("wslink").setLevel(logging.CRITICAL)
    server = trame.Server("kirisurf", core.VirtualNode)
    server.client_type = "vue3"
    server.enable_module(client)
    # the files below `own` are served by our routes
    server.enable_module({"scripts": ["own/page.js"], "styles": ["own/page.css"], "vue_use": ["kirisurf_page"]})
    server.state.trame__title = title
    server.state.trame__favicon = None
    server.state.trame__template_main = (STATIC / "page.html").read_text("utf-8")
    server.state.trame__template_error = (STATIC / "lost.html").read_text("utf-8")
    # every browser for itself
    server.state.client_only("tab", "placing", "busy")
    return server


def _prepare(server: Any, desk: Desk, secret: str) -> None:
    """Give the page its first values and its actions, and the socket a secret of its own."""
    first = {
        "tab": "solve",
        "placing": False,
        "busy": "",
        "notice": "",
        "notice_kind": "words",
        "refused": 0,
        "tabs": 0,
    }
    server.state.update({**first, **fixed_values(), **page_values(desk.session, desk.scenes)})
    for name, act in desk.actions.items():
        server.controller.trigger(name)(act)
    # nothing is served but by our routes
    server.cli.set_defaults(authKey=secret, no_http=True, nosignalhandlers=True)


def _mount(bound: Any, guard: Guard, routes: Routes, server: Any) -> None:
    """Put trame's application behind the guard, below the key, and its client's files beside our own."""
    from aiohttp import web

    inner, outer = bound.app, web.Application(middlewares=[guard.middleware])
    routes.add_to(inner)
    for name, folder in server.serve.items():
        inner.router.add_static(f"/{name}", folder)
    inner.router.add_static("/", server._www)
    outer.add_subapp(f"/{guard.key}", inner)
    outer.on_response_prepare.append(guard.add_headers)
    bound.set_app(outer)


async def _warm_up_drawing() -> None:
    """Make a first picture, which takes a second, while the browser starts."""
    await asyncio.to_thread(importlib.import_module, "pyvista")
    if probe().available:
        Pictures(LEAST, LEAST).close()


def _publish(server: Any, values: dict[str, Any]) -> None:
    with server.state:
        server.state.update(values)


@contextmanager
def _own_arguments() -> Any:
    """Keep trame from reading the command line, which is kirisurf's."""
    before = os.environ.get("TRAME_ARGS")
    os.environ["TRAME_ARGS"] = ""
    try:
        yield
    finally:
        if before is None:
            del os.environ["TRAME_ARGS"]
        else:
            os.environ["TRAME_ARGS"] = before


async def _first(*waited: Any) -> None:
    """Wait for the first of several; what it raises is raised."""
    tasks = [asyncio.ensure_future(one) for one in waited]
    done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    for task in done:
        task.result()
