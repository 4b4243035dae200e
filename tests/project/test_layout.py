"""The house: which folders there are, and how long a module may be."""

from __future__ import annotations

import ast
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("kirisurf", "analysis", "viewers", "sample_surfaces")
MODULES = sorted(module for package in PACKAGES for module in (ROOT / package).rglob("*.py"))
LONGEST = 400


def test_top_level_holds_the_four_packages_and_no_other() -> None:
    found = {folder.name for folder in ROOT.iterdir() if (folder / "__init__.py").is_file()}
    assert found == set(PACKAGES)


def test_top_level_files_are_there() -> None:
    wanted = [
        "pyproject.toml",
        "constraints.txt",
        "Makefile",
        "README.md",
        "LICENSE",
        "CHANGELOG.md",
        ".ci/run",
        ".ci/set-up",
    ]
    assert {name for name in wanted if not (ROOT / name).is_file()} == set()


def test_tests_mirror_the_packages() -> None:
    rooms = {path.name for path in (ROOT / "tests").iterdir() if any(path.rglob("test_*.py"))}
    assert set(PACKAGES) <= rooms


def test_modules_are_short() -> None:
    lengths = {
        str(path.relative_to(ROOT)): len(path.read_text(encoding="utf-8").splitlines())
        for path in (*MODULES, *(ROOT / "tests").rglob("*.py"))
    }
    assert {name: length for name, length in lengths.items() if length > LONGEST} == {}


def test_modules_say_what_they_are() -> None:
    silent = [
        str(path.relative_to(ROOT))
        for path in MODULES
        if ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) is None
    ]
    assert silent == []


def test_no_module_is_named_after_nothing() -> None:
    empty_names = {"utils", "util", "helpers", "manager", "core", "data", "misc", "common"}
    assert [str(path.relative_to(ROOT)) for path in MODULES if path.stem in empty_names] == []
