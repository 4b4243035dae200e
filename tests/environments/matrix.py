"""Kirisurf in sanitized environments: a Markdown table on standard output and in a file.

    python tests/environments/matrix.py                      every row that needs nothing but this interpreter
    python tests/environments/matrix.py "one core" -o T.md   some rows, by name
    python tests/environments/matrix.py wheel sdist oldest newest
                                                             kirisurf as a package: minutes each, and the network
    python tests/environments/matrix.py --python PYTHON      with another interpreter that kirisurf is installed for

Ends with code 1 where a row fails.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from tests.environments.installed import HEAVY  # noqa: E402 (a script knows its own folder alone)
from tests.environments.rows import cheap  # noqa: E402
from tests.environments.running import Result, run_row  # noqa: E402

HEADER = ("environment", "what ran", "exit codes", "certified", "seconds", "verdict")


class Matrix:
    """Rows by name, each of them run once.

    Parameters
    ----------
    interpreter : path
        The Python that kirisurf is installed for.
    """

    def __init__(self, interpreter: str = sys.executable) -> None:
        self.rows = {row.name: row for row in cheap()}
        self._interpreter = interpreter
        self._done: dict[str, Result] = {}

    def result(self, name: str) -> Result:
        """Run a row, and before it the one that it must equal."""
        if name not in self._done:
            row = self.rows.get(name)
            expected = self.result(row.like).files if row and row.like and row.like != name else None
            with tempfile.TemporaryDirectory(prefix="environment-", ignore_cleanup_errors=True) as folder:
                scratch = Path(folder)
                self._done[name] = (
                    run_row(row, scratch, expected, self._interpreter) if row is not None else _heavy(name, scratch)
                )
        return self._done[name]


def _heavy(name: str, scratch: Path) -> Result:
    try:
        return HEAVY[name](scratch)
    except RuntimeError as problem:
        return Result(problems=(str(problem),))


def cells(name: str, result: Result) -> tuple[str, ...]:
    """Return the cells of a row of the table."""
    certified = {True: "yes", False: "no", None: "–"}[result.certified]
    codes, seconds = " ".join(map(str, result.codes)), f"{result.seconds:.1f}"
    return name, " ".join(result.ran), codes, certified, seconds, result.verdict.replace("|", "/")


def main(words: list[str] | None = None) -> int:
    """Run the rows and write the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", metavar="NAME", nargs="*", help="rows to run; default: all but the last four")
    parser.add_argument("-o", "--output", metavar="TABLE", type=Path, help="also write the table to a file")
    parser.add_argument("--python", metavar="PYTHON", default=sys.executable)
    given = parser.parse_args(words)
    matrix = Matrix(given.python)
    known = [*matrix.rows, *HEAVY]
    if unknown := sorted(set(given.names) - set(known)):
        parser.error(f"expected names of rows ({'; '.join(known)}), got {'; '.join(unknown)}")
    lines = [f"| {' | '.join(HEADER)} |", "|---" * len(HEADER) + "|"]
    print(*lines, sep="\n", flush=True)
    names = given.names or list(matrix.rows)
    for name in names:
        lines.append(f"| {' | '.join(cells(name, matrix.result(name)))} |")
        print(lines[-1], flush=True)
    if given.output is not None:
        given.output.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return int(any(matrix.result(name).problems for name in names))


if __name__ == "__main__":
    sys.exit(main())
