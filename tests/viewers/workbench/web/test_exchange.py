"""Files that come and go, asked for with real requests: what is broken is said and loses nothing."""

from __future__ import annotations

import asyncio
import json
import re
import zipfile
from pathlib import Path
from urllib.parse import quote

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kirisurf import fit
from kirisurf.errors import KirisurfError, ParameterError, UnreadableError
from kirisurf.formats import write_obj
from kirisurf.loops import Loops
from kirisurf.targets import load
from viewers.workbench.opening import open_any
from viewers.workbench.session import Session
from viewers.workbench.web.desk import Desk
from viewers.workbench.web.downloads import KINDS, file_name
from viewers.workbench.web.exchange import Exchange
from viewers.workbench.web.uploads import Uploads, plain_name


@pytest.fixture
def roof(tmp_path) -> bytes:
    surface = load("hypar", resolution=8)
    path = tmp_path / "roof.obj"
    write_obj(path, surface.vertices, Loops.from_lists(surface.faces.tolist()))
    return path.read_bytes()


@given(st.text(max_size=120), st.sampled_from([".stl", ".OBJ", ".svg", ".GLB"]))
def test_a_plain_name_is_one_part_of_a_path_and_keeps_its_suffix(text, suffix):
    name = plain_name(text + suffix)
    assert name.endswith(suffix.lower()) and len(name) <= 90
    assert re.fullmatch(r"[\w .()-]+", name) and not name.startswith((".", "-", " "))


@pytest.mark.parametrize("name", ["", "hood", "hood.exe", "../../etc/passwd", "a.obj/..", "x.stl.py", "\0.txt"])
def test_what_cannot_be_read_by_its_name_is_refused(name):
    with pytest.raises(UnreadableError, match="expected one of"):
        plain_name(name)


def test_too_much_is_refused_announced_or_not_and_leaves_nothing(tmp_path):
    async def parts():
        for _ in range(10):
            yield b"x" * 1000

    uploads = Uploads(tmp_path, limit_mb=0.005)
    for announced in (None, 10_000, 10):
        with pytest.raises(UnreadableError, match=r"at most 0\.005 MB"):
            asyncio.run(uploads.take("a.obj", parts(), announced))
        assert list(tmp_path.iterdir()) == []


def test_a_browser_that_leaves_in_the_middle_leaves_nothing(tmp_path):
    async def parts():
        yield b"v 0 0 0"
        raise ConnectionResetError

    with pytest.raises(KirisurfError):
        asyncio.run(Uploads(tmp_path).take("a.obj", parts()))
    assert list(tmp_path.iterdir()) == []


def test_an_upload_becomes_the_target_and_undo_brings_the_one_before_back(visit, engine, roof):
    async def act(at):
        before = at.server.session.state
        status, text = await at.post("upload?name=" + quote("../../a folder/roof (1).obj"), roof)
        assert (status, json.loads(text)) == (200, {"opened": "roof (1).obj"})
        spec = at.server.session.state.spec
        assert spec.target.endswith("/roof (1).obj") and engine.asked[-1] == spec
        at.server.session.undo()
        assert at.server.session.state == before

    visit(act)


def test_an_outline_becomes_the_target_too(visit):
    circle = (
        b"<svg xmlns='http://www.w3.org/2000/svg' width='40mm' height='40mm' viewBox='0 0 40 40'>"
        b"<circle cx='20' cy='20' r='15'/></svg>"
    )

    async def act(at):
        assert (await at.post("upload?name=disc.svg", circle))[0] == 200
        assert at.server.session.state.spec.target.endswith("/disc.svg")

    visit(act)


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("a.stl", b"solid nothing\nfacet normal 0 0\n", "a.stl"),
        ("a.obj", b"", "empty file"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "a.obj"),
        ("a.ply", b"\x7fELF" + bytes(100), "a program"),
        ("a.svg", b"<svg xmlns='http://www.w3.org/2000/svg'><path d='M0 0'/></svg>", "a.svg"),
        ("a.exe", b"MZ", "expected one of"),
        ("", b"v", "expected one of"),
    ],
)
def test_a_broken_upload_is_said_in_a_sentence_and_changes_nothing(visit, engine, name, content, words):
    async def act(at):
        before = at.server.session.state
        status, text = await at.post(f"upload?name={name}", content)
        answer = json.loads(text)
        assert status == 422 and words in answer["error"] and "kirisurf-" not in answer["error"]
        assert answer["exit_code"] in (3, 4)
        assert at.server.session.state == before and engine.asked == []

    visit(act)


def test_the_cut_file_comes_under_a_good_name_and_not_while_something_runs(visit):
    async def act(at):
        async with at.client.get(at.address + "download/cut.svg") as answer:
            # the results of this server are of an engine that it does not have: it fits first
            assert answer.status == 200 and await answer.text() == "cut with kerf 0"
            assert answer.headers["Content-Disposition"].endswith("hypar-cut.svg")
        session = at.server.session
        session.do(session.state.live(False))
        session.do(session.state.with_option("min_angle", 20.0))
        status, text = await at.get("download/cut.svg")
        assert status == 409 and "press Fit first" in text
        for name in ("passwd", "..%2f..%2fetc%2fpasswd", "run.toml"):
            assert (await at.get(f"download/{name}"))[0] in (404, 409)

    visit(act)


def test_a_run_that_was_opened_gives_its_own_files_away_until_something_changes(tmp_path, engine):
    folder = tmp_path / "saved"
    fit("hypar", cells=(2, 2)).save(folder, pictures=False)
    session = Session(*open_any(str(folder)), engine)
    desk = Desk(session, lambda values: None)
    exchange = Exchange(desk, engine, tmp_path, folder)

    async def act():
        name, path = await exchange.give("cut.svg")
        assert name == "hypar-cut.svg"
        assert 'id="hinge"' in path.read_text("utf-8") and engine.asked == []
        _, path = await exchange.give("run.zip")
        with zipfile.ZipFile(path) as archive:
            names = {Path(name).name for name in archive.namelist()}
        assert names == {file.name for file in folder.rglob("*") if file.is_file()}
        session.do(session.state.live(False))
        session.do(session.state.with_option("min_angle", 20.0))
        with pytest.raises(ParameterError, match="press Fit first"):
            await exchange.give("cut.svg")

    asyncio.run(act())


def test_names_of_downloads_follow_the_target():
    names = {file_name(name, "/tmp/x y/hood.v2.stl") for name in KINDS}
    assert len(names) == len(KINDS) and all(name.startswith("hood.v2") and "/" not in name for name in names)
