"""`kill -9` at a random moment loses nothing and leaves nothing half done; 200 rounds: see killing.py."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from tests.kirisurf.batch.killing import rounds


@pytest.mark.slow
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="the system does not tell who the children are")
def test_a_batch_that_was_killed_ends_as_one_that_was_not(tmp_path: Path) -> None:
    counts = rounds(4, tmp_path, seed=7, longest=8.0)
    assert counts["finished and equal"] >= 1
    assert sum(counts.values()) > counts["finished and equal"]
