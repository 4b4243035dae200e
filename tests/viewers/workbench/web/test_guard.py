"""Who is let in: every refusal, asked with real requests."""

from __future__ import annotations

import socket

import pytest

from viewers.workbench.web.guard import Guard, content_policy, new_key


@pytest.fixture
def guard() -> Guard:
    found = Guard("k" * 64)
    found.port = 8123
    return found


HERE = "127.0.0.1:8123"


def test_a_page_of_this_server_is_let_in(guard):
    path = f"/{guard.key}/upload"
    assert guard.refusal("GET", path, HERE, None) == ""
    assert guard.refusal("GET", path, "localhost:8123", None) == ""
    assert guard.refusal("POST", path, HERE, "http://127.0.0.1:8123") == ""
    assert guard.refusal("GET", path, HERE, "http://localhost:8123", is_socket=True) == ""


@pytest.mark.parametrize(
    ("method", "path", "host", "origin", "is_socket"),
    [
        ("GET", "/KEY/", "evil.example:8123", None, False),
        ("GET", "/KEY/", "127.0.0.1", None, False),
        ("GET", "/KEY/", "127.0.0.1:80", None, False),
        ("GET", "/KEY/", "127.0.0.1.evil.example:8123", None, False),
        ("GET", "/KEY/", "", None, False),
        ("GET", "/KEY/", HERE, "http://evil.example", False),
        ("GET", "/KEY/", HERE, "null", False),
        ("GET", "/KEY/", HERE, "https://127.0.0.1:8123", False),
        ("GET", "/KEY/pictures", HERE, None, True),
        ("POST", "/KEY/upload", HERE, None, False),
        ("DELETE", "/KEY/", HERE, None, False),
        ("GET", "/", HERE, None, False),
        ("GET", "/KEYS/", HERE, None, False),
        ("GET", "//KEY/", HERE, None, False),
        ("GET", "/kEY/", HERE, None, False),
        ("GET", "/\N{SNOWMAN}/", HERE, None, False),
    ],
)
def test_everything_else_is_refused_with_a_reason(guard, method, path, host, origin, is_socket):
    assert guard.refusal(method, path.replace("KEY", guard.key), host, origin, is_socket)


def test_before_the_port_is_known_nobody_is_let_in():
    assert Guard("k").refusal("GET", "/k/", "127.0.0.1:0", None)


def test_keys_are_long_and_never_the_same():
    keys = {new_key() for _ in range(50)}
    assert len(keys) == 50 and all(len(key) == 64 and key == key.lower() for key in keys)


def test_the_policy_names_no_other_server():
    policy = content_policy("<script>a()</script><script src='b.js'></script>")
    assert "http" not in policy and "*" not in policy and policy.count("sha256-") == 1
    assert "'unsafe-inline'" not in policy.split("; ")[1]


def test_requests_without_the_key_or_from_elsewhere_get_nothing(visit):
    async def act(at):
        root = at.origin
        for path in ("", "index.html", "own/page.js", "download/cut.svg", "pictures", "ws", "%2e%2e/own/page.js"):
            for start in (root + "/", f"{root}/{'0' * 64}/"):
                async with at.client.get(start + path) as answer:
                    assert answer.status == 403 and "key" in await answer.text()
                    assert answer.headers["Referrer-Policy"] == "no-referrer"
            for headers in ({"Host": "evil.example"}, {"Origin": "http://evil.example"}):
                assert (await at.get(path, headers=headers))[0] == 403
        status, _ = await at.post("upload?name=x.obj", b"v 0 0 0", Origin="http://evil.example")
        assert status == 403
        async with at.client.post(at.address + "upload?name=x.obj", data=b"v") as answer:
            assert answer.status == 403
        status, page = await at.get("?secret=x")
        assert status == 200 and "<script" in page
        named = {"Host": at.origin.replace("http://127.0.0.1", "localhost")}
        assert (await at.get("own/page.js", headers=named))[0] == 200

    visit(act)


def test_sockets_need_key_host_and_origin(visit):
    import aiohttp

    async def act(at):
        address = at.address.replace("http", "ws")
        good = {"Origin": at.origin}
        for path in ("pictures", "ws"):
            async with at.client.ws_connect(address + path, headers=good) as opened:
                assert not opened.closed
            refused = [
                (address + path, {}),
                (address + path, {"Origin": "http://evil.example"}),
                (address + path, {**good, "Host": "evil.example"}),
                (address.replace(at.server.guard.key, "0" * 64) + path, good),
            ]
            for to, headers in refused:
                with pytest.raises(aiohttp.WSServerHandshakeError) as problem:
                    await at.client.ws_connect(to, headers=headers)
                assert problem.value.status == 403

    visit(act)


def test_the_public_secret_of_the_library_opens_nothing(visit):
    import msgpack
    from wslink.chunking import UnChunker, generate_chunks

    async def hello(at, secret):
        message = {"wslink": "1.0", "id": "system:c0:0", "method": "wslink.hello", "args": [{"secret": secret}]}
        async with at.client.ws_connect(at.address.replace("http", "ws") + "ws", headers={"Origin": at.origin}) as ws:
            for chunk in generate_chunks(msgpack.packb(message), 1 << 20):
                await ws.send_bytes(chunk)
            return UnChunker().process_chunk((await ws.receive()).data)

    async def act(at):
        for secret in ("wslink-secret", "vtkweb-secret", "", None):
            assert "error" in await hello(at, secret)
        async with at.client.get(at.address, allow_redirects=False) as answer:
            secret = answer.headers["Location"].partition("secret=")[2].partition("&")[0]
        assert len(secret) == 64 and secret != at.server.guard.key
        assert "clientID" in (await hello(at, secret))["result"]

    visit(act)


def test_nothing_is_listed_and_nothing_outside_is_served(visit):
    async def act(at):
        for path in (
            "own",
            "own/",
            "assets/",
            "own/..%2fserving.py",
            "own/%2e%2e/%2e%2e/serving.py",
            "..%2f..%2fetc/passwd",
        ):
            status, text = await at.get(path)
            assert status in (403, 404) and "import" not in text and "page.js" not in text and "root:" not in text
        async with at.client.get(at.address + "?secret=x") as answer:
            policy = answer.headers["Content-Security-Policy"]
        assert "default-src 'self'" in policy and "frame-ancestors 'none'" in policy

    visit(act)


def test_only_the_loopback_address_listens(visit):
    async def act(at):
        port = at.server.guard.port
        for other in ("127.0.0.2", _own_address()):
            with pytest.raises(OSError), socket.create_connection((other, port), timeout=2):
                pass

    visit(act)


def _own_address() -> str:
    """An address of this machine that others reach, or another of loopback where there is none."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))
            found = probe.getsockname()[0]
        except OSError:
            return "127.0.0.3"
    return "127.0.0.3" if found.startswith("127.") else found
