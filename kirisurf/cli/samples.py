"""`kirisurf samples`: what is bundled."""

from __future__ import annotations

import argparse
from typing import Any

from kirisurf.cli.output import Outcome, Output
from kirisurf.cli.parser import add_command

_TEXT = """\
Sample surfaces are made on the spot from their formulas; the name stands for the surface wherever a TARGET is
asked for."""

_EXAMPLES = """\
  kirisurf samples
  kirisurf samples --json
  kirisurf fit peaks -o runs/peaks"""


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = add_command(commands, "samples", "list the sample surfaces and tessellations", _TEXT, _EXAMPLES)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace, output: Output) -> Outcome:
    """Run the command."""
    import dataclasses

    from kirisurf.targets import samples

    found = samples()
    width = max(len(sample.name) for sample in found)
    output.product("sample surfaces:")
    for sample in found:
        unit = f"; in {sample.units}" if sample.units != "1" else ""
        paper = "; published target" if sample.published else ""
        output.product(f"  {sample.name:<{width}}  {sample.title} (outline: {sample.outline}{unit}{paper})")
    output.product("tessellations:")
    output.product(f"  {'quad':<{width}}  rotating squares; 4x4 unit cells are 8x8 tiles")
    return Outcome(
        0, {"samples": [dataclasses.asdict(sample) for sample in found], "tessellations": [{"name": "quad"}]}
    )
