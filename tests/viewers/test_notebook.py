"""A design and a run show themselves in a notebook: true numbers, one piece of HTML, and never an error."""

from __future__ import annotations

import base64
import json
import os
import re
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

import kirisurf
from kirisurf.design import Design
from viewers.notebook import Card, card_html, card_of
from viewers.opengl import OpenGL
from viewers.parts import ReportParts

_VOID = {"img"}


class Page(HTMLParser):
    """Elements that are opened are closed in order; texts and addresses are kept."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.texts: list[str] = []
        self.addresses: list[str] = []
        self.names: set[str] = set()
        self.feed(html)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attributes):
        self.names.add(tag)
        if tag not in _VOID:
            self.open.append(tag)
        self.addresses += [text for name, text in attributes if name in ("src", "href")]
        assert not [name for name, _ in attributes if name.startswith("on")]

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, text):
        self.texts.append(text)

    @property
    def text(self) -> str:
        return " ".join(self.texts)


@pytest.fixture(scope="module")
def design() -> Design:
    return kirisurf.fit("hypar", cells=(2, 3), units="mm")


@pytest.fixture
def no_opengl(monkeypatch: pytest.MonkeyPatch) -> str:
    reason = "Pictures cannot be drawn: OpenGL is not usable here."
    monkeypatch.setattr("viewers.snapshot.probe", lambda: OpenGL(False, "", reason))
    return reason


def picture_of(page: Page) -> tuple[str, bytes]:
    (address,) = page.addresses
    media, content = re.fullmatch(r"data:(image/[a-z+]+);base64,([A-Za-z0-9+/=]+)", address).groups()
    return media, base64.b64decode(content)


def test_a_design_shows_its_verdict_numbers_and_picture(design: Design, opengl) -> None:
    page = Page(design._repr_html_())
    assert "Certified" in page.text and "24 tiles" in page.text and " mm" in page.text
    rms = float(re.search(r"vertices off by ([\d.e-]+) of a tile edge", page.text)[1])
    assert rms == pytest.approx(design.certificate.rows["distance_rms"], rel=5e-3)
    width, height = (float(x) for x in re.search(r"([\d.]+) × ([\d.]+) mm", page.text).groups())
    assert [width, height] == pytest.approx(np.ptp(design.contracted_points, axis=0), rel=5e-3)
    media, content = picture_of(page)
    assert media == "image/png" and content.startswith(b"\x89PNG") and len(content) < 400_000
    assert page.names <= {"div", "span", "table", "tr", "td", "img"}
    assert design._repr_html_() is design._repr_html_()


def test_without_opengl_the_flat_pattern_stands_for_the_pictures(no_opengl: str) -> None:
    page = Page(kirisurf.fit("hypar", cells=(2, 2))._repr_html_())
    media, content = picture_of(page)
    root = ElementTree.fromstring(content)
    assert media == "image/svg+xml" and root.tag.endswith("svg")
    assert "Certified" in page.text and no_opengl in page.text


def test_a_run_shows_what_its_design_showed(design: Design, tmp_path: Path, no_opengl: str) -> None:
    run = design.save(tmp_path / "<b>a & b", pictures=False)
    ours, theirs = Page(kirisurf.card(design)), Page(run._repr_html_())
    assert theirs.text.startswith("<b>a & b: hypar")
    assert theirs.texts[1:] == ours.texts[1:] and picture_of(theirs) == picture_of(ours)


def test_in_a_terminal_it_is_one_line(design: Design, tmp_path: Path) -> None:
    assert repr(design) == "Design('hypar', 24 tiles, CONVERGED)"
    run = design.save(tmp_path / "run", pictures=False)
    assert repr(run) == f"Run('{tmp_path / 'run'}', 24 tiles, CONVERGED)"


def test_a_design_that_is_not_finished_says_so(no_opengl: str) -> None:
    design = kirisurf.fit("peaks", cells=(3, 3), max_steps=1)
    page = Page(design._repr_html_())
    assert "Not certified" in page.text and design.status.value in page.text
    assert "✗" in page.text and "✓" not in page.text


def test_showing_never_raises(design: Design, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise RuntimeError("no <disk>")

    monkeypatch.setattr("kirisurf.publishing.notebook_card", fail)
    page = Page(kirisurf.card(design))
    assert page.text == "Design: it cannot be shown (no <disk>)"


def test_what_is_not_known_is_left_out_and_names_are_text() -> None:
    evil = '"><script>alert(1)</script>'
    page = Page(card_html(card_of(ReportParts(evil, evil), alt=evil, note=evil)))
    assert page.text.count(evil) == 2 and page.addresses == [] and "script" not in page.names
    assert Page(card_html(Card("a", "b", True, (("row <", "& value"),)))).texts[-2:] == ["row <", "& value"]


def test_warnings_stand_below(design: Design) -> None:
    parts = ReportParts("a", "a", certificate=dict(design.certificate.rows), failures=(), warnings=("Mind the gap.",))
    page = Page(card_html(card_of(parts)))
    assert "With warnings that need reading, below." in page.text and page.text.endswith("Mind the gap.")


@pytest.mark.slow
def test_a_notebook_runs(request: pytest.FixtureRequest, tmp_path: Path) -> None:
    program = shutil.which("jupyter")
    if program is None:
        pytest.skip(f"{request.node.name} did not run: there is no jupyter")
    name = "kirisurf-test"
    kernel = {"argv": [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"], "language": "python"}
    (tmp_path / "kernels" / name).mkdir(parents=True)
    (tmp_path / "kernels" / name / "kernel.json").write_text(json.dumps({**kernel, "display_name": name}))
    if subprocess.run([sys.executable, "-c", "import ipykernel"], capture_output=True, check=False).returncode:
        pytest.skip(f"{request.node.name} did not run: this environment has no ipykernel")
    cell = {"cell_type": "code", "metadata": {}, "outputs": [], "execution_count": None, "id": "a"}
    lines = "import kirisurf\nkirisurf.fit('hypar', cells=(2, 2))"
    metadata = {"kernelspec": {"name": name, "display_name": name}}
    book = {"nbformat": 4, "nbformat_minor": 5, "metadata": metadata, "cells": [{**cell, "source": lines}]}
    (tmp_path / "a.ipynb").write_text(json.dumps(book))
    subprocess.run(
        [program, "nbconvert", "--to", "notebook", "--execute", "--output", "b.ipynb", str(tmp_path / "a.ipynb")],
        env={**os.environ, "JUPYTER_PATH": str(tmp_path)},
        check=True,
        capture_output=True,
    )
    (output,) = json.loads((tmp_path / "b.ipynb").read_text())["cells"][0]["outputs"]
    assert "Certified" in Page("".join(output["data"]["text/html"])).text
