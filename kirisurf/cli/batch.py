"""`kirisurf batch`: many fits, in parallel or on a cluster, resumed, and compared with a baseline."""

from __future__ import annotations

import argparse
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kirisurf.cli.fit import add_spec_options, given_options
from kirisurf.cli.output import Outcome, Output
from kirisurf.cli.parser import add_command, number, whole

if TYPE_CHECKING:
    from kirisurf.batch.reading import BatchSpec

_TEXT = """\
SPEC is a TOML file, a folder whose meshes and outlines are all fitted, or a table (CSV, TSV) with one fit a
row. DIR receives one run folder an item (runs/NAME), one record an item (outcomes/NAME.json), summary.csv,
summary.json, and report.html: all items with thumbnails, sortable, linked to their reports.

  # batch.toml
  targets = ["hypar", "meshes/*.stl", { target = "hood.obj", units = "mm" }]
  [options]                     # for every item
  closeness = "best"
  [matrix]                      # every combination
  tessellation = ["quad", "kagome"]
  tiles = [100, 300]
  [limits]                      # for one item
  seconds = 600
  memory_mb = 4000
  [tolerances]                  # relative, against a baseline
  distance_rms = 0.05

Also: title = "...", expect = [0, 1] (exit codes that count as expected, for all or for a target), and [[items]],
each a target with options and a name. A table has the columns target, any option of fit, name, expect.

Every item is made in a process of its own: a crash, a hang or a lack of memory is recorded as its outcome, and the
batch goes on. Started again, the batch keeps every finished run of the same inputs, options and version, and makes
the rest; nothing finished is lost, however it was ended. Options of fit given here hold for all items.

exit codes: 0 all as expected, 1 the same with warnings that need reading, 2 wrong parameter, 3 SPEC or baseline
unreadable, 7 DIR cannot be written, 8 some items failed or are worse than the baseline, 130 interrupted."""

_EXAMPLES = """\
  kirisurf batch batch.toml -o out                     all of it, on all cores
  kirisurf batch meshes -o out --tiles 200             every mesh in a folder
  kirisurf batch batch.toml -o out --baseline base.toml --accept
                                                       write the baseline
  kirisurf batch batch.toml -o new --baseline base.toml
                                                       compare: better, same, worse, new, missing
  kirisurf batch batch.toml -o new --baseline out      compare with another batch
  kirisurf batch batch.toml -o out --scheduler tcp://10.0.0.5:8786
                                                       on the workers of a Dask scheduler"""


def add(commands: Any) -> None:
    """Add the command to the parser."""
    about = "fit many targets, resume, and compare with a baseline"
    parser = add_command(commands, "batch", about, _TEXT, _EXAMPLES)
    parser.add_argument("batch", metavar="SPEC", help="batch.toml, a folder of targets, or a table (csv, tsv)")
    parser.add_argument("-o", "--output", metavar="DIR", required=True, help="new, empty, or that of a batch before")
    how = parser.add_argument_group("batch")
    how.add_argument("--workers", metavar="N", type=whole, help="items at a time; default: one a core")
    how.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="hand the items to the workers of a Dask scheduler that you trust, which see DIR and the targets "
        "under the same paths (needs the extra kirisurf[cluster])",
    )
    how.add_argument("--limit-seconds", metavar="S", type=number, help="wall-clock limit of one item; default: 3600")
    how.add_argument("--limit-memory", metavar="MB", type=number, help="memory limit of one item; default: 8000")
    how.add_argument("--pictures", action="store_true", help="draw every run's pictures (some seconds each)")
    how.add_argument("--again", action="store_true", help="make also what is finished but not as expected")
    how.add_argument("--baseline", metavar="DIR|FILE", help="compare with a baseline file, or with another batch")
    how.add_argument("--accept", action="store_true", help="write the baseline FILE anew from this batch")
    add_spec_options(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace, output: Output) -> Outcome:
    """Run the command."""
    from kirisurf.batch import fit_batch
    from kirisurf.batch.reading import read_batch
    from kirisurf.cli.batch_progress import progress_of

    spec = _limited(read_batch(arguments.batch, given_options(arguments)), arguments)
    for note in spec.notes:
        output.message(f"note: {note}")
    with progress_of(spec, output) as progress:
        summary = fit_batch(
            spec,
            arguments.output,
            workers=arguments.workers,
            scheduler=arguments.scheduler,
            baseline=arguments.baseline,
            accept=arguments.accept,
            pictures=arguments.pictures,
            again=arguments.again,
            told=progress.told,
        )
    if arguments.accept:
        output.message(f"baseline: {arguments.baseline} ({len(spec.items)} items)")
    return _told(summary, Path(arguments.output).absolute(), arguments.accept, output)


def _limited(spec: BatchSpec, arguments: argparse.Namespace) -> BatchSpec:
    """The batch with the limits that were given here."""
    given = {"seconds": arguments.limit_seconds, "memory_mb": arguments.limit_memory}
    changed = {name: value for name, value in given.items() if value is not None}
    return replace(spec, limits=type(spec.limits).of({**asdict(spec.limits), **changed}))


def _told(summary: dict[str, Any], folder: Path, is_accepted: bool, output: Output) -> Outcome:
    """Say how the batch went, the verdict last."""
    from kirisurf.batch.items import FINE
    from kirisurf.cli.batch_progress import comparison_lines, summary_lines

    for line in summary_lines(summary):
        output.message(line)
    for line in comparison_lines(summary):
        output.message(line)
    code, forgotten = 0, summary["forgotten"]
    if forgotten:
        names = ", ".join(forgotten[:5]) + (", ..." if len(forgotten) > 5 else "")
        output.warning(f"{len(forgotten)} runs in {folder} belong to no item of this batch and were left: {names}")
        code = 1
    compared = summary["comparison"]
    same = {each["name"] for each in (compared or {}).get("items", ()) if each["verdict"] == "same"}
    stated = {item["name"] for item in summary["items"] if tuple(item["expect"]) != FINE}
    if any(item["code"] == 1 and item["name"] not in same | stated for item in summary["items"]):
        code = 1
    if compared is not None and compared["counts"]["missing"] and not is_accepted:
        code = 1
    if summary["counts"]["unexpected"]:
        code = 8
    if compared is not None and compared["counts"]["worse"] and not is_accepted:
        code = 8
    report = folder / "report.html"
    output.product(str(report))
    return Outcome(code, {**summary, "exit_code": code, "folder": str(folder), "report": str(report)})
