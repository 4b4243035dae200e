"""Batches measured: throughput, memory over many items, poison. A Markdown table on standard output and in a file.

python tests/benchmarks/batch.py                 all of it, some minutes
python tests/benchmarks/batch.py --items 20      smaller
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

from tests.benchmarks.run import Report
from tests.kirisurf.batch.killing import children
from tests.kirisurf.batch.trees import POISON, differences

ROOT = Path(__file__).resolve().parents[2]
POISONS = ("segfault", "abort", "exit", "glutton", "raise", "hang", "segfault-2", "abort-2", "exit-2", "raise-2")
HEAD = (
    "| batch of 8x8 tiles | items | workers | seconds | a fit | efficiency | peak MB |",
    "|---|---|---|---|---|---|---|",
)
LEGEND = (
    "efficiency: items x seconds of one fit / (workers x seconds), of one alone, start of the program included, and "
    "of one in a batch that makes one at a time. peak MB: batch and hosts together, resident, without the runs; first, "
    "middle and last tenth of the items."
)


def main() -> None:
    """Measure what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--items", type=int, default=100, help="items of the batches whose time is taken")
    parser.add_argument("--many", type=int, default=500, help="items of the batch whose memory is followed")
    parser.add_argument("--output", default=str(ROOT / "build" / "bench-batch.md"))
    arguments = parser.parse_args()
    report = Report(Path(arguments.output))
    with tempfile.TemporaryDirectory(prefix="kirisurf-") as made:
        folder, n = Path(made), arguments.items
        alone = sorted(seconds_of(_fit(folder / f"alone-{k}")) for k in range(3))[1]
        report.add(*HEAD, f"| one `kirisurf fit` | 1 | 1 | {alone:.2f} | {alone:.2f} | | |")
        one = 0.0
        for workers, items in ((1, max(n // 3, 2)), (2, n)):
            seconds, _ = followed(_batch(folder, f"w{workers}", items, workers))
            each = seconds / items
            one = each if workers == 1 else one
            shares = f"{alone / workers / each:.2f} of one alone, {one / workers / each:.2f} of one at a time"
            report.add(f"| batch | {items} | {workers} | {seconds:.1f} | {each:.2f} | {shares} | |")
        names = [path.name for path in (folder / "w1" / "runs").iterdir()]
        same = sum(not differences(folder / "w1" / "runs" / name, folder / "w2" / "runs" / name) for name in names)
        report.add(f"| by 1 and by 2 workers | {len(names)} | | | | {same} byte for byte the same | |")
        seconds, memory = followed(_batch(folder, "many", arguments.many, 2))
        tenth = max(1, len(memory) // 10)
        parts = (memory[tenth : 2 * tenth], memory[len(memory) // 2 :][:tenth], memory[-2 * tenth : -tenth])
        peaks = ", ".join(f"{max(part):.0f}" for part in parts)
        report.add(f"| batch | {arguments.many} | 2 | {seconds:.1f} | {seconds / arguments.many:.2f} | | {peaks} |")
        report.add(poisoned(folder), "", LEGEND)


def seconds_of(words: list[str]) -> float:
    """Return the wall-clock seconds of a command."""
    began = time.perf_counter()
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return time.perf_counter() - began


def followed(words: list[str]) -> tuple[float, list[float]]:
    """Return the seconds of a batch, and the memory of it and its hosts in MB, four times a second."""
    began, memory = time.perf_counter(), list[float]()
    process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def follow() -> None:
        while process.poll() is None:
            memory.append(sum(_resident(each) for each in (process.pid, *children(process.pid))))
            time.sleep(0.25)

    thread = threading.Thread(target=follow)
    thread.start()
    if process.wait() != 0:
        raise SystemExit(f"expected a batch that ends with 0, got {process.returncode}: {' '.join(words)}")
    seconds = time.perf_counter() - began
    thread.join()
    return seconds, memory


def poisoned(folder: Path) -> str:
    """Run 100 items of which 10 are poison, and return a row on what came of it."""
    (folder / "poison").mkdir()
    (folder / "poison" / "sitecustomize.py").write_text(POISON)
    words = _batch(folder, "poisoned", 90, 2, POISONS)
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(folder / "poison"), str(ROOT)])}
    began = time.perf_counter()
    ended = subprocess.run([*words, "--json"], env=environment, capture_output=True, text=True, check=False)
    seconds = time.perf_counter() - began
    items = json.loads(ended.stdout)["items"]
    done = [item["name"] for item in items if item["code"] == 0]
    same = sum(not differences(folder / "poisoned" / "runs" / name, folder / "alone-0") for name in done)
    recorded = sum(item["code"] not in (0, 1) and item["folder"] is None for item in items)
    words_ = f"code {ended.returncode}, {len(done)} done, {same} of them byte for byte as alone, {recorded} recorded"
    return f"| 90 and 10 that are poison | {len(items)} | 2 | {seconds:.1f} | | {words_} | |"


def _fit(folder: Path) -> list[str]:
    return [
        sys.executable,
        "-m",
        "kirisurf",
        "fit",
        "hypar",
        "--cells",
        "4x4",
        "--no-pictures",
        "-q",
        "-o",
        str(folder),
    ]


def _batch(folder: Path, name: str, n: int, workers: int, poison: tuple[str, ...] = ()) -> list[str]:
    names = [f"fit-{k:04d}" for k in range(n)]
    for k, each in enumerate(poison):
        names.insert(9 * k + 4, each)
    items = "".join(f'[[items]]\ntarget = "hypar"\nname = "{each}"\ncells = "4x4"\n' for each in names)
    spec = folder / f"{name}.toml"
    spec.write_text(f"[limits]\nseconds = 30\nmemory_mb = 1500\n{items}")
    words = [sys.executable, "-m", "kirisurf", "batch", str(spec), "-o", str(folder / name), "-q"]
    return [*words, "--workers", str(workers)]


def _resident(process: int) -> float:
    try:
        return int(Path(f"/proc/{process}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6
    except (OSError, IndexError, ValueError):
        return 0.0


if __name__ == "__main__":
    main()
