"""What is installed: declared, pinned, and from no fixed address."""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from importlib import metadata
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
PINS = [line for line in (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines() if line and line[0] != "#"]
INSTALLED = ("cluster", "desktop", "repair", "test", "web")
"""Extras that the set-up installs."""
PACKAGES = {"kirisurf", "analysis", "viewers", "sample_surfaces"}


def _declared() -> list[Requirement]:
    extras = PROJECT["optional-dependencies"]
    return [
        Requirement(line) for line in (*PROJECT["dependencies"], *(line for name in INSTALLED for line in extras[name]))
    ]


def _needed(requirements: list[Requirement]) -> set[str]:
    """Return the names of all distributions that the requirements need on this machine, through all levels."""
    done: set[tuple[str, str]] = set()
    waiting = [(requirement, "") for requirement in requirements]
    while waiting:
        requirement, asked_with = waiting.pop()
        if requirement.marker and not requirement.marker.evaluate({"extra": asked_with}):
            continue
        name = canonicalize_name(requirement.name)
        for extra in {"", *requirement.extras}:
            if (name, extra) not in done:
                done.add((name, extra))
                waiting += [(Requirement(line), extra) for line in metadata.requires(name) or []]
    return {name for name, _ in done}


def _imported(package: str) -> set[str]:
    """Return the top-level names that the modules of a package import, also inside functions."""
    names = set()
    for path in (ROOT / package).rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                names |= {alias.name.split(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                names.add(node.module.split(".")[0])
    return names


def test_constraints_are_exact_and_name_no_address() -> None:
    assert PINS
    assert [line for line in PINS if not re.fullmatch(r"[A-Za-z0-9_.-]+==[A-Za-z0-9_.!+]+", line)] == []


def test_every_distribution_is_pinned_once() -> None:
    pinned = [canonicalize_name(line.split("==")[0]) for line in PINS]
    assert len(pinned) == len(set(pinned))
    assert _needed(_declared()) - set(pinned) == set()


def test_pins_are_within_the_declared_bounds() -> None:
    versions = {canonicalize_name(name): version for name, version in (line.split("==") for line in PINS)}
    outside = [str(r) for r in _declared() if not r.specifier.contains(versions[canonicalize_name(r.name)])]
    assert outside == []


def test_every_import_is_declared() -> None:
    distributions = metadata.packages_distributions()
    declared = {canonicalize_name(requirement.name) for requirement in _declared()}
    undeclared = {
        (package, name)
        for package in PACKAGES
        for name in _imported(package) - PACKAGES - sys.stdlib_module_names
        if not {canonicalize_name(owner) for owner in distributions.get(name, [])} & declared
    }
    assert undeclared == set()


def test_every_dependency_is_imported() -> None:
    """A dependency that nothing imports is a download for nothing; vtk is pyvista's, pinned because of its ABI."""
    modules = {"fonttools": "fontTools", "libigl": "igl", "pillow": "PIL", "tomli-w": "tomli_w"}
    imported = set().union(*(_imported(package) for package in PACKAGES))
    names = [requirement.name for requirement in map(Requirement, PROJECT["dependencies"])]
    assert [name for name in names if modules.get(name, name) not in imported | {"vtk"}] == []


def test_every_dependency_says_why() -> None:
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    lines = text.split("dependencies = [", 1)[1].split("\n]", 1)[0].strip().splitlines()
    assert len(lines) == len(PROJECT["dependencies"])
    assert [line for line in lines if not re.search(r"#.*(Apache|BSD|MIT|MPL|PSF)", line)] == []
