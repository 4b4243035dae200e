"""What the tests of batches share: poison for processes, and trees that are compared."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from kirisurf.batch.hosting import Host
from kirisurf.batch.order import Order
from kirisurf.spec import FitSpec
from tests.kirisurf.batch.trees import POISON


@pytest.fixture(scope="session")
def poison(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder for PYTHONPATH: processes that find it there go wrong for some run folders, as `POISON` says."""
    folder = tmp_path_factory.mktemp("poison")
    (folder / "sitecustomize.py").write_text(POISON, encoding="utf-8")
    return folder


@pytest.fixture
def poisoned(poison: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(filter(None, [str(poison), os.environ.get("PYTHONPATH")])))


@pytest.fixture(scope="module")
def host() -> Iterator[Host]:
    found = Host()
    yield found
    found.close()


def order(folder: Path, seconds: float = 120.0, memory_mb: float = 4000.0, **options: object) -> Order:
    spec = FitSpec(**{"target": "hypar", "cells": (1, 1), **options})
    return Order(spec.as_dict(), str(folder), False, seconds, memory_mb)


def record(folder: Path) -> dict:
    return json.loads((folder / "result.json").read_text(encoding="utf-8"))
