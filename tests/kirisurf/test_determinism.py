"""Same input, spec and version: the same bytes, on one thread or several, whatever ran before in the process.

A limit of time is the one option that may not keep this: how far a solve comes until then is up to the machine.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.kirisurf.fits_in_a_row import CASES

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(__file__).with_name("fits_in_a_row.py")
SMALL = [case for case in CASES if case != "large"]


def _ran(folder: Path, cases: list[str], threads: int, seed: str, cores: set[int]) -> dict[str, object]:
    counts = {name: str(threads) for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")}
    # the child sets its cores itself: between fork and exec nothing is safe in a process with threads
    start = (
        f"import os, sys; os.sched_setaffinity(0, {cores}); os.execv(sys.executable, [sys.executable, *sys.argv[1:]])"
    )
    child = subprocess.run(
        [sys.executable, "-c", start, str(PROGRAM), str(folder), *cases],
        env={**os.environ, **counts, "PYTHONHASHSEED": seed, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert child.returncode == 0, child.stderr[-3000:]
    found: dict[str, object] = json.loads(child.stdout)
    return found


def _different(one: dict, other: dict) -> list[str]:
    return [
        f"{case}: {name}"
        for case in one["cases"]
        for name in one["cases"][case]
        if one["cases"][case][name] != other["cases"][case].get(name)
    ]


@pytest.mark.slow
def test_the_bytes_do_not_depend_on_threads_hashes_and_what_ran_before(tmp_path: Path) -> None:
    cores = os.sched_getaffinity(0)
    alone = _ran(tmp_path / "alone", SMALL, 1, "0", {min(cores)})
    together = _ran(tmp_path / "together", SMALL[::-1], 4, "1", cores)
    assert {case: set(files) for case, files in alone["cases"].items()} == {
        case: set(files) for case, files in together["cases"].items()
    }
    assert all("deployed.obj" in files and "curvature.csv" in files for files in alone["cases"].values())
    assert _different(alone, together) == []


@pytest.mark.slow
def test_a_sheet_that_a_team_factors_has_the_bytes_of_one_thread(tmp_path: Path) -> None:
    cores = os.sched_getaffinity(0)
    if len(cores) < 2:
        pytest.skip("one thread against two was not tried: this process may use one core only")
    alone = _ran(tmp_path / "alone", ["large"], 1, "0", {min(cores)})
    team = _ran(tmp_path / "team", ["large"], 2, "1", cores)
    assert (alone["workers"], team["workers"]) == (1, 2)
    assert _different(alone, team) == []
