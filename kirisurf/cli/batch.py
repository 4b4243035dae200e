"""`kirisurf batch`: many fits, in parallel or on a cluster, resumed, and compared with a baseline."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kirisurf.cli.fit import add_spec_options, given_options
from kirisurf.cli.output import Outcome, Output
from kirisurf.cli.parser import add_command, number, whole
from kirisurf.errors import OutputError, ParameterError

if TYPE_CHECKING:
    from kirisurf.batch.engines import Engine
    from kirisurf.batch.folder import BatchFolder
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
    from kirisurf.batch.baseline import read_baseline
    from kirisurf.batch.folder import BatchFolder
    from kirisurf.batch.reading import read_batch
    from kirisurf.batch.running import Asking, run_batch
    from kirisurf.batch.writing import batch_text
    from kirisurf.cli.batch_progress import progress_of

    spec = _limited(read_batch(arguments.batch, given_options(arguments)), arguments)
    target = _baseline_file(arguments)
    before = None
    if arguments.baseline is not None and not (target is not None and not target.exists()):
        before = read_baseline(arguments.baseline)
    asking = Asking(
        arguments.pictures,
        arguments.again,
        before,
        Path(arguments.baseline or "").name,
        Path(arguments.batch).name,
    )
    for note in spec.notes:
        output.message(f"note: {note}")
    with BatchFolder(arguments.output, batch_text(spec)) as folder:
        forgotten = folder.forgotten(spec)
        engine = _engine(arguments, folder)
        with progress_of(spec, output) as progress:
            summary = run_batch(spec, folder, engine, asking, progress.told)
        outcomes = progress.outcomes
        if target is not None:
            _accept(target, spec, outcomes, before, output)
    return _told(summary, folder, forgotten, target is not None, output)


def _limited(spec: BatchSpec, arguments: argparse.Namespace) -> BatchSpec:
    """The batch with the limits that were given here."""
    from dataclasses import asdict, replace

    given = {"seconds": arguments.limit_seconds, "memory_mb": arguments.limit_memory}
    changed = {name: value for name, value in given.items() if value is not None}
    return replace(spec, limits=type(spec.limits).of({**asdict(spec.limits), **changed}))


def _baseline_file(arguments: argparse.Namespace) -> Path | None:
    """The file that is to be written anew, if any."""
    if not arguments.accept:
        return None
    if arguments.baseline is None:
        raise ParameterError("--accept: expected together with --baseline FILE, got it alone")
    path = Path(arguments.baseline)
    if path.is_dir() or path.suffix.lower() != ".toml":
        raise ParameterError(f"--accept: expected --baseline to name a .toml file, got {arguments.baseline!r}")
    if not path.absolute().parent.is_dir():
        raise OutputError(f"{path}: expected a folder to write to, got one that does not exist")
    return path


def _engine(arguments: argparse.Namespace, folder: BatchFolder) -> Engine:
    """Who makes the runs."""
    from kirisurf.batch.engines import on_this_machine
    from kirisurf.solvers.team import n_cores

    if arguments.scheduler is not None:
        if arguments.workers is not None:
            raise ParameterError("--workers: expected without --scheduler, whose workers are its own, got both")
        from kirisurf.batch.cluster import on_cluster

        return on_cluster(arguments.scheduler, folder.path)
    workers = n_cores() if arguments.workers is None else arguments.workers
    if not 1 <= workers <= 1024:
        raise ParameterError(f"--workers: expected a whole number from 1 to 1024, got {workers}")
    return on_this_machine(workers)


def _accept(path: Path, spec: BatchSpec, outcomes: Any, before: Any, output: Output) -> None:
    """Write the baseline anew."""
    from kirisurf.batch.baseline import baseline_text
    from kirisurf.formats.atomic import write_text

    write_text(path, baseline_text([outcomes[item.name] for item in spec.items], before))
    output.message(f"baseline: {path} ({len(spec.items)} items)")


def _told(
    summary: dict[str, Any], folder: BatchFolder, forgotten: tuple[str, ...], is_accepted: bool, output: Output
) -> Outcome:
    """Say how the batch went, the verdict last."""
    from kirisurf.cli.batch_progress import comparison_lines, summary_lines

    for line in summary_lines(summary):
        output.message(line)
    for line in comparison_lines(summary):
        output.message(line)
    code = 0
    if forgotten:
        names = ", ".join(forgotten[:5]) + (", ..." if len(forgotten) > 5 else "")
        output.warning(f"{len(forgotten)} runs in {folder.path} belong to no item of this batch and were left: {names}")
        code = 1
    compared = summary["comparison"]
    same = {each["name"] for each in (compared or {}).get("items", ()) if each["verdict"] == "same"}
    stated = {item["name"] for item in summary["items"] if item["expect"] != [0, 1] and item["expect"] != (0, 1)}
    if any(item["code"] == 1 and item["name"] not in same | stated for item in summary["items"]):
        code = 1
    if compared is not None and compared["counts"]["missing"] and not is_accepted:
        code = 1
    if summary["counts"]["unexpected"]:
        code = 8
    if compared is not None and compared["counts"]["worse"] and not is_accepted:
        code = 8
    report = folder.path / "report.html"
    output.product(str(report))
    return Outcome(code, {**summary, "exit_code": code, "folder": str(folder.path), "report": str(report)})
