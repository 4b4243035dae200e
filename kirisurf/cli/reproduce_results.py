"""What the parts of `kirisurf reproduce` share: the folder, progress, the records of designs, and the verdict."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from kirisurf.cli.output import Outcome, Output
from kirisurf.errors import OutputError, ParameterError
from kirisurf.formats import write_obj
from kirisurf.formats.atomic import write_bytes, write_text
from kirisurf.reproducing import Numbers, Reproduced, Shape, Wanted, all_reproduced
from kirisurf.runs.record import json_text, versions

PARTLY = 8
UNDRAWN = 1
_REASONS = 3


def opened_folder(path: str, overwrite: bool) -> Path:
    """Return a folder that can be written, made where there is none: what is wrong with it is told before all work.

    Raises
    ------
    ParameterError
        Where it holds something and may not be overwritten.
    OutputError
        Where it cannot be made or written.
    """
    folder = Path(os.path.abspath(path))
    try:
        folder.mkdir(parents=True, exist_ok=True)
        holds = any(folder.iterdir())
    except OSError as problem:
        raise OutputError(f"{folder}: expected a folder to write to, got: {problem.strerror or problem}") from None
    if holds and not overwrite:
        raise ParameterError(f"{folder}: expected a new or empty folder, got one with files (--overwrite writes there)")
    probe = folder / ".kirisurf-probe"
    write_bytes(probe, b"")
    probe.unlink()
    return folder


def run_all(wanted: Sequence[Wanted], jobs: int, output: Output) -> list[Reproduced]:
    """Make designs, saying each as it is finished; returned in the order given."""
    found: dict[str, Reproduced] = {}
    for result in all_reproduced(wanted, jobs):
        found[result.name] = result
        output.message(f"[{len(found)}/{len(wanted)}] {sentence(result)}")
    return [found[each.name] for each in wanted]


def sentence(result: Reproduced) -> str:
    """Return one line on a result."""
    if result.numbers is None:
        return f"{result.name}: failed: {result.reason}"
    verdict = "reproduced" if not result.shortcomings else "NOT reproduced"
    return (
        f"{result.name}: {verdict}, {result.tiles} tiles, rows {result.numbers.largest:.0e}, "
        f"smallest edge {result.numbers.smallest_edge:.2f} ({result.seconds:.1f} s)"
    )


def brief(reasons: Sequence[str]) -> tuple[str, ...]:
    """Return the first reasons and how many more there are: a design far off fails nearly every row."""
    more = len(reasons) - _REASONS
    return tuple(reasons) if more < 1 else (*reasons[:_REASONS], f"and {more} more (see the .csv)")


def record_of(result: Reproduced) -> dict[str, Any]:
    """Return the numbers of a result as a flat record, the same names for every result."""
    return {
        "name": result.name,
        "tiles": result.tiles,
        "status": result.status,
        "reproduced": not result.shortcomings,
        "seconds": round(result.seconds, 3),
        **numbers_record(result.numbers),
        "shortcomings": "; ".join(result.shortcomings),
    }


def numbers_record(numbers: Numbers | None, prefix: str = "") -> dict[str, Any]:
    """Return the numbers of a certificate as a flat record."""
    names = [name for name in Numbers.__dataclass_fields__ if name != "failures"]
    return {f"{prefix}{name}": None if numbers is None else getattr(numbers, name) for name in names}


def write_records(folder: Path, name: str, records: Sequence[Mapping[str, Any]], beside: Mapping[str, Any]) -> None:
    """Write NAME.csv (the records) and NAME.json (the same with what stands beside them, and versions).

    Raises
    ------
    OutputError
        Where a file cannot be written.
    """
    lines = io.StringIO(newline="")
    writer = csv.DictWriter(lines, list(records[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(records)
    write_text(folder / f"{name}.csv", lines.getvalue())
    write_text(folder / f"{name}.json", json_text({"designs": list(records), **beside, "versions": versions()}))


def write_designs(folder: Path, results: Sequence[Reproduced]) -> None:
    """Write both states of every design as `designs/NAME_deployed.obj` and `designs/NAME_contracted.obj`.

    Raises
    ------
    OutputError
        Where a file cannot be written.
    """
    inner = opened_folder(str(folder / "designs"), overwrite=True)
    for result in results:
        if isinstance(result.shape, Shape):
            for state in ("deployed", "contracted"):
                write_obj(inner / f"{result.name}_{state}.obj", getattr(result.shape, state), result.shape.tiles)


def verdict(results: Sequence[Reproduced], product: Path, output: Output, undrawn: str, beside: Any) -> Outcome:
    """Say which designs were not reproduced and why, name what was written, and return the outcome."""
    failed = {result.name: result.shortcomings for result in results if result.shortcomings}
    for name, reasons in failed.items():
        output.warning(f"{name}: {'; '.join(brief(reasons))}")
    if undrawn:
        output.warning(undrawn)
    output.message(f"{len(results) - len(failed)} of {len(results)} designs reproduced")
    output.product(str(product))
    code = PARTLY if failed else UNDRAWN if undrawn else 0
    return Outcome(
        code,
        {"folder": str(product.parent), "designs": len(results), "failed": {k: list(v) for k, v in failed.items()}}
        | dict(beside),
    )
