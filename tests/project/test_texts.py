"""What the README, the licence and the changelog have to say."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
PLAIN = " ".join(README.split())


def test_licence_is_mit() -> None:
    text = (ROOT / "LICENSE").read_text(encoding="utf-8")
    assert text.startswith("MIT License")
    assert "kirisurf developers" in text


def test_readme_opens_with_a_picture_and_the_two_commands() -> None:
    opening = README[:1500]
    assert re.search(r"!\[[^\]]{20,}\]\(docs/pictures/\w+\.png\)", opening)
    assert "make demo" in opening
    assert "make test" in opening


@pytest.mark.parametrize(
    "sentence",
    [
        "Programming shape using kirigami tessellations",
        "Nature Materials 18, 999–1004 (2019)",
        "filed a patent on their algorithms",
        "MIT",
        "pymeshlab",
        "GPL",
    ],
)
def test_readme_states(sentence: str) -> None:
    assert sentence in PLAIN


def test_readme_links_lead_somewhere() -> None:
    links = [link for link in re.findall(r"\]\(([^)#]+)\)", README) if "://" not in link]
    assert links
    assert [link for link in links if not (ROOT / link).exists()] == []


def test_changelog_names_this_version() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert re.search(rf"^## {re.escape(project['version'])}\b", changelog, re.MULTILINE)


@pytest.mark.slow
def test_readme_python_example_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (example,) = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    names: dict[str, Any] = {}
    exec(compile(example, "the example in README.md", "exec"), names)
    n_vertices = names["design"].tessellation.n_vertices
    assert names["status"].exit_code == 0
    assert names["certificate"].passed
    assert names["opened"].shape == (n_vertices, 3)
    assert names["closed"].shape == (n_vertices, 2)
    assert "gaussian_curvature" in names["holes"].cell_data
    assert (tmp_path / "runs/hypar/result.json").is_file()
