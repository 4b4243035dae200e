"""Every file of a corpus of foreign and hostile files through `kirisurf fit`: does each end in its class?

    python tests/corpus/classes.py CORPUS                    a table on standard output; code 1 where a file disagrees
    python tests/corpus/classes.py CORPUS -o table.md        the same in a file
    python tests/corpus/classes.py CORPUS --only ply vtp     files with one of these words in their name

CORPUS holds the folders `nasty` and `targets`, each with an `index.tsv`. Every file is fitted by a process of its own,
with limits on time and memory; it has to end by itself, without a traceback, with a sentence that names the file
where it is refused, with a run whose record agrees with the exit code where it is not, and without opening any
other file or socket.
"""

from __future__ import annotations

import argparse
import csv
import json
import re
import shutil
import sys
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from tests.corpus.child import Ended, run

FOLDERS = ("nasty", "targets")
OPTIONS = ("--tiles", "24", "--no-pictures", "--max-seconds", "20")
SECONDS, MEMORY_MB, AT_ONCE = 60.0, 4000, 2
LOADS = "LOADS"
UNREADABLE = {"PARSE", "UNSUPPORTED", "SEC"}
SENTENCES = (
    ("TOPO", r"expected one piece with one boundary loop"),
    ("EMPTY", r"an empty file|STL with none"),
    ("NOFACES", r"vertices without any face|points and none|without curves|polygons, got \d+ points"),
    ("NONFINITE", r"expected finite"),
    ("RANGE", r"would (over|under)flow|too few digits|smaller numbers"),
    ("DEGENERATE", r"faces with an area|with an extent|an area, got|too narrow|cannot be flattened"),
    ("WRONGTYPE", r"\(PolyData\)"),
)
"""What cannot be used (code 4), by what its sentence says."""
KINDS = {"disk": LOADS, "patches": LOADS, "cuttable": "TOPO", "closed": "TOPO"}
"""Class of a target by its kind in the index."""
OTHERWISE = {
    # Listed as damaged, but it is a whole and valid file (a box, the seed of somebody's fuzzing): closed, so refused.
    "meshoptimi__fuzz.glb": "TOPO",
}


@dataclass(frozen=True)
class Entry:
    """One file of the corpus and what its index expects."""

    path: Path
    expected: str

    @property
    def classes(self) -> set[str]:
        """Classes that are accepted."""
        if self.path.name in OTHERWISE:
            return {OTHERWISE[self.path.name]}
        found = {part.partition("(")[0].rstrip("?") for part in self.expected.split("/")}
        accepted = set(found)
        if found & UNREADABLE:
            accepted |= UNREADABLE
        if found - UNREADABLE - {"OK", "WARN", "TOPO"}:  # what cannot be used may be refused at the door
            accepted |= UNREADABLE
        if found & {"OK", "WARN"}:  # they have to load; whether a sheet can cover them is another question
            accepted |= {LOADS, "TOPO"}
        if any(part.startswith("FIT-") for part in found):
            accepted |= {LOADS}
        return accepted


@dataclass(frozen=True)
class Judged:
    """How one file ended, and what is wrong with that."""

    entry: Entry
    ended: Ended
    found: str
    sentence: str
    faults: tuple[str, ...]

    @property
    def cells(self) -> tuple[str, ...]:
        """A row of the table."""
        code = self.ended.death or str(self.ended.code)
        verdict = "; ".join(self.faults) or "agrees"
        return (
            self.entry.path.name,
            self.entry.expected,
            self.found,
            code,
            f"{self.ended.seconds:.1f}",
            verdict,
            self.sentence,
        )


def entries(corpus: Path, words: Sequence[str] = ()) -> list[Entry]:
    """Return the files that the indices of a corpus list, those with one of the words in their name where any is given.

    Examples
    --------
    >>> entries(Path("nowhere"))
    []
    """
    found = []
    for folder in FOLDERS:
        index = corpus / folder / "index.tsv"
        if index.is_file():
            with index.open(encoding="utf-8", newline="") as file:
                for row in csv.DictReader(file, delimiter="\t"):
                    expected = row.get("expected") or KINDS[row["kind"]]
                    found.append(Entry(corpus / folder / row["file"], expected))
    return [entry for entry in found if not words or any(word in entry.path.name for word in words)]


def found_class(code: int | None, messages: str) -> str:
    """Return the class that an exit code and what was said on standard error belong to.

    Examples
    --------
    >>> found_class(4, "kirisurf: a.stl: expected triangles, got an STL with none"), found_class(70, "")
    ('EMPTY', 'NONE')
    """
    if code in (0, 1, 5, 6):
        return LOADS
    if code == 3:
        return "PARSE"
    if code == 4:
        return next((name for name, sentence in SENTENCES if re.search(sentence, messages)), "UNUSABLE")
    return "NONE"


def judged(entry: Entry, folder: Path) -> Judged:
    """Fit one file into a new folder and judge how that ended; the folder is removed."""
    try:
        ended = run(["fit", "-o", str(folder), *OPTIONS, "--", str(entry.path)], SECONDS, MEMORY_MB)
        return judgement(entry, ended, _record(folder))
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def judgement(entry: Entry, ended: Ended, record: dict | None) -> Judged:
    """Judge how a file ended; `record` is what the run recorded, None where there is no run."""
    found = found_class(ended.code, ended.messages)
    errors = [line for line in ended.messages.splitlines() if line.startswith("kirisurf: ")]
    faults = []
    if ended.death:
        faults.append(f"did not end by itself ({ended.death})")
    elif found not in entry.classes:
        faults.append(f"expected {entry.expected}")
    if "Traceback (most recent call last)" in ended.messages + ended.output:
        faults.append("a traceback")
    if found == LOADS:
        faults += _faults_of_record(ended, record)
    elif not ended.death and (len(errors) != 1 or entry.path.name not in errors[0]):
        faults.append("expected one sentence that names the file")
    if found != LOADS and record is not None:
        faults.append("refused, and yet there is a run")
    others = sorted({line for line in ended.opened if entry.path.name not in line and not _is_about_fonts(line)})
    if others:
        faults.append(f"it did {others[0]}")
    return Judged(entry, ended, found, _sentence(ended, errors, record), tuple(faults))


def _is_about_fonts(line: str) -> bool:
    """Whether a file is Matplotlib's list of the system's fonts, or a font that it reads where it has no list yet."""
    return "fontlist-" in line or line.lower().endswith((".ttf", ".otf", ".ttc", ".afm"))


def _faults_of_record(ended: Ended, record: dict | None) -> Iterator[str]:
    if record is None:
        yield "no result.json"
        return
    if record["exit_code"] != ended.code:
        yield f"recorded code {record['exit_code']}"
    if record["certified"] != (ended.code in (0, 1)):
        yield "code and certificate disagree"


def _sentence(ended: Ended, errors: Sequence[str], record: dict | None) -> str:
    if record is not None:
        return "certified" if record["certified"] else str(record["reason"])
    return errors[0].removeprefix("kirisurf: ") if errors else (ended.messages.strip().splitlines() or [""])[-1]


def _record(folder: Path) -> dict | None:
    try:
        return dict(json.loads((folder / "result.json").read_text(encoding="utf-8")))
    except (OSError, ValueError):
        return None


def judged_corpus(found: Iterable[Entry], at_once: int = AT_ONCE) -> Iterator[Judged]:
    """Judge many files, some at a time, in order."""
    with tempfile.TemporaryDirectory(prefix="kirisurf-corpus-") as folder, ThreadPoolExecutor(at_once) as pool:
        yield from pool.map(lambda pair: judged(pair[1], Path(folder, str(pair[0]))), enumerate(found))


def main(arguments: Sequence[str] | None = None) -> int:
    """Judge a corpus and return 1 where a file disagrees."""
    parser = argparse.ArgumentParser(description="Fit every file of a corpus and compare with the expected class.")
    parser.add_argument("corpus", type=Path)
    parser.add_argument("-o", "--output", type=Path, help="write the table here too")
    parser.add_argument("--only", nargs="+", default=[], help="words of which one stands in the name of a file")
    given = parser.parse_args(arguments)
    found = entries(given.corpus, given.only)
    if not found:
        parser.error(f"expected index.tsv in {given.corpus}/nasty or {given.corpus}/targets, got no files")
    lines = ["| file | expected | ended as | code | seconds | verdict | sentence |", "|---|---|---|---|---|---|---|"]
    sys.stdout.write("\n".join(lines) + "\n")
    faulty = 0
    for one in judged_corpus(found):
        faulty += bool(one.faults)
        lines.append("| " + " | ".join(cell.replace("|", "/") for cell in one.cells) + " |")
        sys.stdout.write(lines[-1] + "\n")
        sys.stdout.flush()
    lines.append(f"\n{len(found)} files, {faulty} of them otherwise than expected.")
    sys.stdout.write(lines[-1] + "\n")
    if given.output is not None:
        given.output.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return 1 if faulty else 0


if __name__ == "__main__":
    sys.exit(main())
