"""One browser's socket: what its hand does comes in, images go out, as fast as it shows them."""

from __future__ import annotations

import asyncio
import json
from typing import TYPE_CHECKING, Any

from viewers.workbench.web.desk import Desk
from viewers.workbench.web.pictures import HANDS, Pictures, numbers

if TYPE_CHECKING:
    from aiohttp import web

REST = 0.18
"""Seconds without a move after which the image is drawn once more, well."""

IN_FLIGHT = 2
"""Images that may be on their way: one is shown while the next is drawn."""


class Browser:
    """Pictures for one page.

    Parameters
    ----------
    desk : Desk
    socket : aiohttp.web.WebSocketResponse
    """

    def __init__(self, desk: Desk, socket: web.WebSocketResponse) -> None:
        self._desk, self._socket = desk, socket
        self._pictures: Pictures | None = None
        self._wanted = asyncio.Event()
        self._is_behind, self._is_moving = True, False
        self._room = asyncio.BoundedSemaphore(IN_FLIGHT)
        self._scales: list[dict[str, Any]] = []

    def look(self, is_moving: bool) -> None:
        """Draw what is on the desk, when there is time."""
        self._is_behind = True
        self._want(is_moving)

    async def leave(self) -> None:
        """Close the socket."""
        await self._socket.close(code=1001, message=b"kirisurf was closed")

    async def serve(self) -> None:
        """Answer until the browser leaves."""
        from aiohttp import WSMsgType

        drawing = asyncio.create_task(self._drawn())
        self._desk.enter(self)
        try:
            async for message in self._socket:
                if message.type is not WSMsgType.TEXT:
                    break
                try:
                    await self._hear(json.loads(message.data))
                except (ValueError, TypeError, AttributeError, RecursionError):
                    # no message of our page: whoever sends it is told so and let go
                    await self._socket.close(code=1003, message=b"not understood")
                    break
        finally:
            self._desk.exit(self)
            drawing.cancel()
            await asyncio.gather(drawing, return_exceptions=True)
            if self._pictures is not None:
                self._pictures.close()

    async def _hear(self, message: dict[str, Any]) -> None:
        kind = message.get("kind", "")
        if kind == "shown":
            self._room.release()
            return
        if kind == "size":
            self._resize(*numbers(message, "width", "height", "ratio"))
        pictures = self._pictures
        if pictures is None:
            return
        if kind in HANDS:
            act, names = HANDS[kind]
            act(pictures, *numbers(message, *names))
            self._want(True)
        elif kind == "reset":
            pictures.reset()
            self._want(False)
        elif kind == "click":
            if self._desk.pick(pictures.hit(*numbers(message, "x", "y"))):
                await self._socket.send_str(json.dumps({"picked": True}))
        elif kind == "place":
            x, y, x0, y0 = numbers(message, "x", "y", "x0", "y0")
            self._desk.place(*pictures.placed((x0, y0), (x, y)), ended=message.get("ended") is True)

    def _resize(self, width: float | int, height: float | int, ratio: float | int) -> None:
        if self._pictures is None:
            self._pictures = Pictures(int(width), int(height), ratio)
        else:
            self._pictures.resize(int(width), int(height))
        self.look(False)

    def _want(self, is_moving: bool) -> None:
        self._is_moving = is_moving
        self._wanted.set()

    async def _drawn(self) -> None:
        """Draw until the browser leaves; a defect is said, and the browser comes back to a new picture."""
        try:
            await self._draw()
        except ConnectionError:
            return
        except Exception as problem:
            self._desk.say(f"internal error: {type(problem).__name__}: {problem}", True)
            await self._socket.close(code=1011)

    async def _draw(self) -> None:
        is_rough = False
        while True:
            try:
                await asyncio.wait_for(self._wanted.wait(), REST if is_rough else None)
                is_rough = self._is_moving
            except TimeoutError:
                is_rough = False
            self._wanted.clear()
            if self._pictures is None:
                continue
            await self._room.acquire()
            if self._is_behind:
                self._is_behind = False
                state = self._desk.session.state
                self._pictures.show(self._desk.scenes, state.is_linked, self._desk.framed)
            image = self._pictures.image(is_rough)
            scales = self._pictures.scales(self._desk.scenes[1].units)
            if scales != self._scales:
                self._scales = scales
                await self._socket.send_str(json.dumps({"scales": scales}))
            await self._socket.send_bytes(image)
            # what came in meanwhile is heard before the next image
            await asyncio.sleep(0)
