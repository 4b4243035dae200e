"""Addresses of the server: the page, its scripts, the socket of pictures, uploads and downloads."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import quote

from kirisurf.errors import KirisurfError
from viewers.workbench.web.browser import Browser
from viewers.workbench.web.desk import Desk
from viewers.workbench.web.exchange import Exchange

if TYPE_CHECKING:
    from aiohttp import web

STATIC = Path(__file__).parent / "static"
LARGEST_MESSAGE = 4096
"""Bytes of a message on what a hand does."""


class Routes:
    """What answers at which address.

    Parameters
    ----------
    desk : Desk
    exchange : Exchange
    page : str
        HTML that loads trame's client.
    query : str
        What the page's address has to carry for the client.
    """

    def __init__(self, desk: Desk, exchange: Exchange, page: str, query: str) -> None:
        self._desk, self._exchange, self._page, self._query = desk, exchange, page, query

    def add_to(self, app: web.Application) -> None:
        """Add all of them to an application."""
        app.router.add_get("/", self.page)
        app.router.add_get("/pictures", self.pictures)
        app.router.add_post("/upload", self.upload)
        app.router.add_get("/download/{name}", self.download)
        app.router.add_static("/own", STATIC)

    async def page(self, request: web.Request) -> web.Response:
        """Answer with the page; the client takes its part of the address away, so that a reload has to get it again."""
        from aiohttp import web

        if "secret" not in request.query:
            raise web.HTTPFound(f"?{self._query}")
        return web.Response(text=self._page, content_type="text/html")

    async def pictures(self, request: web.Request) -> web.WebSocketResponse:
        """Show the pictures to one browser until it leaves."""
        from aiohttp import web

        # images are compressed already
        socket = web.WebSocketResponse(max_msg_size=LARGEST_MESSAGE, heartbeat=30, compress=False)
        await socket.prepare(request)
        await Browser(self._desk, socket).serve()
        return socket

    async def upload(self, request: web.Request) -> web.Response:
        """Take a file as the new target."""
        name = request.query.get("name", "")
        try:
            opened = await self._exchange.take(name, request.content.iter_chunked(1 << 18), request.content_length)
        except KirisurfError as problem:
            return self._refused(problem)
        return _answer({"opened": opened})

    async def download(self, request: web.Request) -> web.StreamResponse:
        """Hand a file over, as soon as it is made."""
        from aiohttp import web

        try:
            name, path = await self._exchange.give(request.match_info["name"])
        except KirisurfError as problem:
            return self._refused(problem)
        return web.FileResponse(path, headers={"Content-Disposition": f"attachment; filename*=UTF-8''{quote(name)}"})

    def _refused(self, problem: KirisurfError) -> web.Response:
        self._desk.say(str(problem), True)
        # 409: what was asked does not go with what there is; 422: what came cannot be used
        return _answer({"error": str(problem), "exit_code": problem.exit_code}, 409 if problem.exit_code == 2 else 422)


def _answer(value: dict[str, object], status: int = 200) -> web.Response:
    from aiohttp import web

    return web.Response(text=json.dumps(value), content_type="application/json", status=status)
