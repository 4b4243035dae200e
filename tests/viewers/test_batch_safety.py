"""Whatever names and messages say, a page of a batch runs its own script alone and leads nowhere but below itself."""

from __future__ import annotations

import base64
import hashlib
import re
from urllib.parse import unquote

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.viewers.batch_summary import HOSTILE, PNG, BatchPage, item, summary
from viewers.batch_page import batch_page
from viewers.batch_rows import report_address


@pytest.mark.parametrize("text", HOSTILE)
def test_hostile_texts_are_text(text):
    bad = item(
        text,
        target=text,
        options={"tessellation": text, text: text},
        outcome=text,
        is_expected=False,
        reason=text,
        warnings=[text],
        failures=[text],
        status=text,
        folder=text,
    )
    changes = [{"measure": text, "before": text, "now": text, "verdict": "worse", "sentence": text}]
    comparison = {
        "baseline": text,
        "tolerances": {text: {"relative": 0.1, "absolute": 0, "better": text}},
        "counts": {"worse": 1, "missing": 1},
        "items": [
            {"name": text, "verdict": "worse", "changes": changes},
            {"name": text + "gone", "verdict": "missing", "changes": []},
        ],
    }
    told = summary(
        [bad, item()], title=text, spec=text, kirisurf=text, varied=["tessellation", text], comparison=comparison
    )
    check_harmless(batch_page(told, {text: PNG}))


@settings(max_examples=40, deadline=None)
@given(st.text(st.characters(), min_size=1, max_size=40), st.text(max_size=40))
def test_any_text_is_text(name, other):
    bad = item(name, target=other, reason=other, outcome="crashed", is_expected=False, folder=name)
    check_harmless(batch_page(summary([bad], title=other), {name: PNG}))


def check_harmless(html: str) -> None:
    """One script, the one that the page allows; no handlers; links that lead below the page; nothing from elsewhere."""
    html.encode("utf-8")
    page = BatchPage(html)
    script = html.split("<script>")[1].split("</script>")[0]
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    (policy,) = [a["content"] for tag, a in page.tags if tag == "meta" and "http-equiv" in a]
    assert "default-src 'none'" in policy and f"script-src 'sha256-{digest}';" in policy
    names = [tag for tag, _ in page.tags]
    assert names.count("script") == 1 and not {"img", "iframe", "object", "link", "base", "form"} & set(names)
    assert not [key for _, a in page.tags for key in a if key.startswith("on") or key in ("src", "srcset")]
    assert all(link["href"].startswith(("./", "#")) for link in page.having("href"))
    assert set(re.findall(r"url\((.{5})", html)) <= {"data:"}
    assert not re.search(r"[\x00-\x09\x0b-\x1f\x7f\u202a-\u202e\u2066-\u2069]", html)


def test_links_lead_to_the_reports(tmp_path):
    names = [
        "plain",
        "a b",
        "q'uo\"te",
        "-rf",
        "per%20cent",
        "hash#1?x=2",
        "\u00e9\u4e2d",
        "x" * 200,
        "back\\slash",
        "caf\udce9",
    ]
    items = []
    for k, name in enumerate(names):
        folder = tmp_path / "runs" / name
        folder.mkdir(parents=True)
        (folder / "report.html").write_text(str(k), "utf-8")
        items.append(item(name, folder=f"runs/{name}"))
    page = BatchPage(batch_page(summary(items), {}))
    links = [a["href"] for a in page.having("href") if a["href"].startswith("./")]
    found = [(tmp_path / unquote(link, errors="surrogateescape")).read_text("utf-8") for link in links]
    assert set(found) == {str(k) for k in range(len(names))}
    assert not [link for link in links if set(link) & set(" \"'<>\\?#")]


@pytest.mark.parametrize("folder", [None, "", "/", "..", "runs/../../x", "a\0b", 7, "\ud800"])
def test_a_folder_that_is_none_has_no_link(folder):
    assert report_address(folder) is None
    page = BatchPage(batch_page(summary([item(folder=folder)]), {}))
    assert all(link["href"].startswith("#") for link in page.having("href"))


@pytest.mark.parametrize("folder", ["/etc", "//host/share", "https://host/x", "javascript:1"])
def test_no_link_leaves_the_folder_of_the_page(folder):
    address = report_address(folder)
    assert address.startswith("./") and "//" not in address and ":" not in address
