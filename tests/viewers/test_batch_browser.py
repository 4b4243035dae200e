"""The page of a batch in a real Chromium: sorted, narrowed, printed; nothing on it runs but its own script."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest

from tests.viewers.batch_summary import CRASHED, HOSTILE, PNG, change, compared, item, matrix, summary
from viewers.batch_page import batch_page

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)


@pytest.fixture
def chromium(request):
    name = request.node.name
    if CHROMIUM is None:
        pytest.skip(f"{name} did not run: there is no Chromium; on Debian or Ubuntu: apt-get install chromium")
    playwright = pytest.importorskip("playwright.sync_api", reason=f"{name} did not run: pip install playwright")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"], timeout=120_000)
        yield browser
        browser.close()


def opened(browser, html: str, folder: Path):
    """The page in a browser, and what went wrong in it or was asked for from elsewhere."""
    (folder / "page.html").write_text(html, "utf-8")
    page = browser.new_page(viewport={"width": 1280, "height": 900})
    page.set_default_timeout(120_000)
    wrong: list[str] = []
    page.on("console", lambda message: wrong.append(message.text))
    page.on("pageerror", lambda problem: wrong.append(str(problem)))
    page.on("dialog", lambda dialog: (wrong.append(dialog.message), dialog.dismiss()))
    page.on("request", lambda asked: wrong.append(asked.url) if asked.url.startswith("http") else None)
    page.goto((folder / "page.html").as_uri())
    return page, wrong


@pytest.mark.slow
def test_the_table_sorts_and_narrows_in_a_browser(chromium, tmp_path):
    seconds = [3.0, None, 1e-5, 20.0, 3.0, float("inf"), 0.5]
    items = [item(f"roof-{k}", target=f"t{10 - k}", seconds=value) for k, value in enumerate(seconds)]
    items[2] |= {**CRASHED, "seconds": 1e-5}
    items[4]["certified"] = False
    worse = {"roof-6": ("worse", [change("coverage", 0.9, 0.8, "worse")])}
    page, wrong = opened(chromium, batch_page(compared(items, **worse), {"roof-0": PNG}), tmp_path)

    def shown() -> list[int]:
        return page.eval_on_selector_all(
            "#all-items tbody tr", "rows => rows.filter(r => !r.hidden).map(r => +r.dataset.item)"
        )

    def head(words: str):
        return page.locator("#all-items thead th", has_text=words)

    assert shown() == list(range(7)) and page.inner_text("#shown") == "7 items"
    head("seconds").locator("[role=button]").click()
    assert shown() == [2, 6, 0, 4, 3, 5, 1] and head("seconds").get_attribute("aria-sort") == "ascending"
    head("seconds").locator("[role=button]").press("Enter")
    # missing last both ways, equal ones in the order of the batch
    assert shown() == [5, 3, 0, 4, 6, 2, 1] and head("seconds").get_attribute("aria-sort") == "descending"
    head("target").locator("[role=button]").press("Space")
    assert shown() == [6, 5, 4, 3, 2, 1, 0]
    assert page.locator("#all-items [aria-sort]").count() == 1
    head("outcome").locator("[role=button]").click()
    assert shown()[-1] == 2
    head("certified").locator("[role=button]").click()
    assert (shown()[0], shown()[-1]) == (4, 2)
    head("baseline").locator("[role=button]").click()
    assert shown()[0] == 6

    page.fill("#filter", "ROOF-3")
    assert shown() == [3] and page.inner_text("#shown") == "1 of 7 items"
    page.fill("#filter", "quad signal")
    assert shown() == [2]
    page.fill("#filter", "")
    crashed = page.locator("button[data-filter]", has_text="crashed")
    crashed.click()
    assert shown() == [2] and crashed.get_attribute("aria-pressed") == "true"
    crashed.click()
    assert len(shown()) == 7 and crashed.get_attribute("aria-pressed") == "false"
    page.locator("a[data-filter]", has_text="worse").click()
    assert shown() == [6]
    # sorting what is narrowed keeps it so
    head("seconds").locator("[role=button]").click()
    assert shown() == [6] and wrong == []


@pytest.mark.slow
def test_nothing_hostile_runs_in_a_browser(chromium, tmp_path):
    items = [
        item(f"{text} {k}", target=text, reason=text, outcome="crashed", is_expected=False)
        for k, text in enumerate(HOSTILE)
    ]
    page, wrong = opened(chromium, batch_page(summary(items, title=HOSTILE[0]), {}), tmp_path)
    page.locator("#all-items thead [role=button]").first.click()
    page.wait_for_timeout(200)
    assert wrong == [] and page.locator("#all-items tbody tr").count() == len(items)
    # what got past the escaping would still not run: only the page's own script may
    with page.expect_console_message(lambda message: "Content Security Policy" in message.text):
        page.evaluate("document.body.insertAdjacentHTML('beforeend', '<img src=x onerror=\"window.ran = 1\">')")
    page.wait_for_timeout(200)
    assert page.evaluate("window.ran") is None


@pytest.mark.slow
def test_without_scripts_all_is_there_and_prints_on_whole_sheets(chromium, tmp_path):
    items = matrix(20)
    (tmp_path / "page.html").write_text(batch_page(summary(items), {}), "utf-8")
    plain = chromium.new_context(java_script_enabled=False).new_page()
    plain.goto((tmp_path / "page.html").as_uri())
    assert plain.locator("#all-items tbody tr").count() == len(items)
    assert plain.locator("#filter").is_hidden() and plain.locator("button:visible").count() == 0
    plain.pdf(path=tmp_path / "page.pdf", prefer_css_page_size=True)
    boxes = re.findall(rb"/MediaBox \[0 0 ([\d.]+) ([\d.]+)\]", (tmp_path / "page.pdf").read_bytes())
    assert boxes and all((round(float(w)), round(float(h))) in ((842, 595), (841, 595)) for w, h in boxes)
