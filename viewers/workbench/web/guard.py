"""The guard: who may ask this server for anything. A page on loopback can be reached by every page in the browser.

Three conditions, for pages, images, files and sockets alike: the address begins with a random key, which only who
sees the terminal knows; the request names this server as its host, so that no other name can be bent to loopback (DNS
rebinding); and where a page asks, it is one of this server.
"""

from __future__ import annotations

import base64
import hashlib
import re
import secrets
from collections.abc import Awaitable, Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from aiohttp import web

LOOPBACK = "127.0.0.1"
NAMES = (LOOPBACK, "localhost")
SAFE = ("GET", "HEAD")

_HEADERS = {
    "Cache-Control": "no-store",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    # the key stands in the address
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
}


def new_key() -> str:
    """Return a random key. In small letters and digits: trame's client writes addresses in small letters."""
    return secrets.token_hex(32)


class Guard:
    """Lets requests in, or says why not.

    Parameters
    ----------
    key : str
    page : str
        The page's HTML; of the scripts in it only those that stand there now will run.

    Attributes
    ----------
    port : int
        Known when the server listens; before, nobody is let in.
    """

    def __init__(self, key: str, page: str = "") -> None:
        self.key = key
        self._policy = content_policy(page)
        self.port = 0

    @property
    def address(self) -> str:
        """Address of the page, with its key."""
        return f"http://{LOOPBACK}:{self.port}/{self.key}/"

    def refusal(self, method: str, path: str, host: str, origin: str | None, is_socket: bool = False) -> str:
        """Return why a request is refused, in words; empty where it is let in.

        Parameters
        ----------
        method, path : str
        host : str
            As its header names it.
        origin : str or None
            Page that asks, as its header names it; browsers send it with sockets and with all that changes things.
        is_socket : bool
        """
        hosts = [f"{name}:{self.port}" for name in NAMES]
        if not self.port or host.lower() not in hosts:
            return "this host is not served"
        if origin is not None and origin.lower() not in [f"http://{name}" for name in hosts]:
            return "pages of other origins are not served"
        if origin is None and (is_socket or method not in SAFE):
            return "expected a page of this server to ask, got no origin"
        given = path.split("/")[1] if path.startswith("/") else ""
        if not secrets.compare_digest(given.encode(), self.key.encode()):
            return "open the address that kirisurf shows in the terminal, with its key"
        return ""

    @property
    def middleware(self) -> Callable[..., Awaitable[web.StreamResponse]]:
        """What aiohttp asks before every request."""
        from aiohttp import web

        @web.middleware
        async def guarded(
            request: web.Request, handler: Callable[[web.Request], Awaitable[web.StreamResponse]]
        ) -> web.StreamResponse:
            reason = self.refusal(
                request.method,
                request.path,
                request.headers.get("Host", ""),
                request.headers.get("Origin"),
                "upgrade" in request.headers,
            )
            if reason:
                return web.Response(status=403, text=f"kirisurf: {reason}.\n", headers=_HEADERS)
            return await handler(request)

        return guarded

    async def add_headers(self, request: web.Request, response: web.StreamResponse) -> None:
        """Add to every answer what browsers are told to keep to."""
        sockets = " ".join(f"ws://{name}:{self.port}" for name in NAMES)
        policy = self._policy.replace("connect-src 'self'", f"connect-src 'self' {sockets}")
        response.headers.update({**_HEADERS, "Content-Security-Policy": policy})


def content_policy(page: str) -> str:
    """Return the content security policy of a page: everything from this server, and its own inline scripts.

    Vue makes functions of the page's template in the browser, which is what unsafe-eval allows.

    Examples
    --------
    >>> content_policy("<script>go()</script>").split("; ")[0]
    "default-src 'self'"
    """
    inline = re.findall(r"<script>(.*?)</script>", page, re.DOTALL)
    hashes = [base64.b64encode(hashlib.sha256(script.encode()).digest()).decode() for script in inline]
    return "; ".join(
        [
            "default-src 'self'",
            " ".join(["script-src 'self' 'unsafe-eval'", *(f"'sha256-{digest}'" for digest in hashes)]),
            "style-src 'self' 'unsafe-inline'",
            "img-src 'self' blob: data:",
            "connect-src 'self'",
            "object-src 'none'",
            "base-uri 'self'",
            "form-action 'none'",
            "frame-ancestors 'none'",
        ]
    )
