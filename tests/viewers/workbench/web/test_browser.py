"""One walk through the page in a real Chromium: from a mesh file to a colored hole map and a cut file."""

from __future__ import annotations

import importlib.util
import re
import shutil
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

from kirisurf.formats import write_obj
from kirisurf.loops import Loops
from kirisurf.targets import load
from viewers.workbench.web.libraries import INSTALL_LINE, is_installed

_HERE = importlib.util.spec_from_file_location("page_process", Path(__file__).parent / "page_process.py")
page_process = importlib.util.module_from_spec(_HERE)
_HERE.loader.exec_module(page_process)

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
WAIT = 60_000


@pytest.fixture
def chromium(request, opengl):
    name = request.node.name
    if not is_installed():
        pytest.skip(f"{name} did not run: {INSTALL_LINE}")
    if CHROMIUM is None:
        pytest.skip(f"{name} did not run: there is no Chromium; on Debian or Ubuntu: apt-get install chromium")
    playwright = pytest.importorskip("playwright.sync_api", reason=f"{name} did not run: pip install playwright")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"], timeout=120_000)
        yield browser
        browser.close()


def images(page) -> int:
    return int(page.get_attribute("#canvas", "data-images") or 0)


def settle(page) -> None:
    """Wait until no new picture has come for half a second."""
    last, still = -1, 0
    while still < 2:
        page.wait_for_timeout(250)
        now = images(page)
        still = still + 1 if now == last and now else 0
        last = now


def fitted(page, words: str) -> None:
    """Wait for the end of a fit, and for words in its status."""
    page.wait_for_function(
        "(words) => document.querySelector('#status')?.textContent.match(words)"
        " && !document.querySelector('#cut').disabled",
        arg=words,
        timeout=WAIT,
    )


@pytest.mark.slow
def test_from_a_mesh_file_to_a_cut_file(chromium, tmp_path):
    surface = load("hypar", resolution=24)
    write_obj(tmp_path / "roof.obj", surface.vertices, Loops.from_lists(surface.faces.tolist()))
    (tmp_path / "broken.stl").write_text("solid nothing\nfacet normal 0 0\n", "utf-8")
    with page_process.PageProcess("paraboloid", "--cells", "3x3") as served:
        context = chromium.new_context(viewport={"width": 1280, "height": 800}, accept_downloads=True)
        context.set_default_timeout(WAIT)
        page = context.new_page()
        defects, elsewhere = [], []
        page.on("pageerror", lambda problem: defects.append(str(problem)))
        page.on("request", lambda asked: elsewhere.append(asked.url))
        page.goto(served.address)
        page.focus("#option-min_angle")
        page.keyboard.press("Control+A")
        page.keyboard.type("4")
        fitted(page, "Certified, 36 tiles")
        assert page.input_value("#option-min_angle") == "4", "reports of a fit take nothing from what is being typed"
        page.keyboard.press("Enter")

        page.set_input_files("#file", tmp_path / "roof.obj")
        page.wait_for_function("document.querySelector('#sample').value === ''", timeout=WAIT)
        fitted(page, "Certified, 3")
        page.fill("#option-tiles", "60")
        page.press("#option-tiles", "Enter")
        fitted(page, "Certified, [56][0-9] tiles")

        page.select_option("#coloring", "hole/gaussian_curvature")
        page.wait_for_selector(".colorbar .label :text('Holes: Gaussian curvature K')")
        settle(page)
        box = page.locator("#canvas").bounding_box()
        # the opened sheet is as much hole as tile: somewhere on it a hole is hit
        for k in range(12):
            before = images(page)
            page.mouse.click(box["x"] + (0.70 + 0.01 * k) * box["width"], box["y"] + 0.5 * box["height"])
            page.wait_for_function(
                "(before) => Number(document.querySelector('#canvas').dataset.images) > before", arg=before
            )
            settle(page)
            if page.inner_text("#picked-title").startswith("Hole"):
                break
        assert re.fullmatch(r"Hole \d+", page.inner_text("#picked-title"))
        numbers = dict(line.split("\t")[:2] for line in page.inner_text("#picked").splitlines())
        assert -0.6 < float(numbers["Gaussian curvature K"]) < 0.0, "a saddle"

        with page.expect_download(timeout=WAIT) as coming:
            page.click("#cut")
        assert coming.value.suggested_filename == "roof-cut.svg"
        coming.value.save_as(tmp_path / "cut.svg")
        root = ElementTree.parse(tmp_path / "cut.svg").getroot()
        assert root.tag.endswith("svg")
        assert {"cut", "hinge", "outline"} <= {element.get("id") for element in root.iter()}

        page.set_input_files("#file", tmp_path / "broken.stl")
        page.wait_for_selector("#notice :text('broken.stl: expected')")
        assert page.input_value("#option-tiles") == "60"

        count = len(elsewhere)
        page.reload()
        fitted(page, "Certified, [56][0-9] tiles")
        assert page.input_value("#option-tiles") == "60" and len(elsewhere) > count
        settle(page)
        other = context.new_page()
        other.goto(served.address)
        other.wait_for_selector("text=open in 2 tabs")
        other.select_option("#coloring", "tile/area")
        page.wait_for_function("document.querySelector('#coloring').value === 'tile/area'")
        other.close()

        page.click("#undo")
        page.wait_for_function("document.querySelector('#coloring').value === 'hole/gaussian_curvature'")
        assert defects == []
        assert all(url.startswith((served.address, "blob:")) for url in elsewhere), "nothing comes from elsewhere"
        assert served.interrupt()[0] == 0
        page.wait_for_selector("text=No connection to kirisurf")
