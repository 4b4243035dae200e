"""`kirisurf demo`: the main job on a bundled surface."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from kirisurf.cli.output import Outcome, Output
from kirisurf.cli.parser import add_command

SAMPLE = "car_hood"
_FOLDER = "demo"
_TEXT = f"""\
Designs a sheet for the bundled surface {SAMPLE!r}, from the mesh to the report, in about a minute. The last line
names the report; open it in a browser. Without -o the run goes to ./{_FOLDER}, where it replaces an earlier demo."""

_EXAMPLES = """\
  kirisurf demo                          write ./demo
  kirisurf demo -o runs/first            write another folder
  kirisurf demo --sample dome            another bundled surface"""


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = add_command(commands, "demo", "run the main job on a bundled surface, start to report", _TEXT, _EXAMPLES)
    parser.add_argument("-o", "--output", metavar="DIR", help=f"run folder: new or empty (default: {_FOLDER})")
    parser.add_argument("--overwrite", action="store_true", help="replace an old run in DIR")
    parser.add_argument("--sample", metavar="NAME", default=SAMPLE, help=f"sample surface (default: {SAMPLE})")
    parser.add_argument("--no-pictures", action="store_true", help="write no pictures")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace, output: Output) -> Outcome:
    """Run the command."""
    from kirisurf.cli.job import run_job
    from kirisurf.errors import ParameterError
    from kirisurf.spec import FitSpec
    from kirisurf.targets import is_sample, resolved, samples

    if not is_sample(arguments.sample):
        names = ", ".join(sample.name for sample in samples())
        raise ParameterError(f"--sample: expected one of {names}, got {arguments.sample!r}")
    folder = arguments.output or _FOLDER
    overwrite = arguments.overwrite or (arguments.output is None and _is_demo(Path(folder)))
    spec = resolved(FitSpec(target=arguments.sample))
    return run_job(spec, folder, overwrite, not arguments.no_pictures, output)


def _is_demo(folder: Path) -> bool:
    """Whether a folder holds a run on a sample surface, which the demo may replace unasked."""
    from kirisurf.targets import samples

    try:
        name = json.loads((folder / "result.json").read_text(encoding="utf-8"))["target"]["name"]
    except (OSError, ValueError, KeyError, TypeError):
        return False
    return name in [sample.name for sample in samples()]
