"""`kirisurf samples`: what is bundled."""

from __future__ import annotations

import argparse
from typing import Any

from kirisurf.cli.output import Outcome, Output
from kirisurf.cli.parser import add_command

_TEXT = """\
Sample surfaces and planar outlines are made on the spot from their formulas; the name stands for the target
wherever a TARGET is asked for. Tessellations are listed with their linear stretch from closed to open (two
numbers where it depends on the direction). Those with a file are examples of how a unit cell of your own is
written: --tessellation FILE takes it."""

_EXAMPLES = """\
  kirisurf samples
  kirisurf samples --json
  kirisurf fit peaks -o runs/peaks"""


def add(commands: Any) -> None:
    """Add the command to the parser."""
    about = "list the sample surfaces, tessellations and planar outlines"
    parser = add_command(commands, "samples", about, _TEXT, _EXAMPLES)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace, output: Output) -> Outcome:
    """Run the command."""
    import dataclasses

    from kirisurf import outlines
    from kirisurf.targets import samples

    found = samples()
    tessellations = _tessellations()
    width = max(len(each) for each in [sample.name for sample in found] + [each["name"] for each in tessellations])
    output.product("sample surfaces:")
    for sample in found:
        unit = f"; in {sample.units}" if sample.units != "1" else ""
        paper = "; published target" if sample.published else ""
        output.product(f"  {sample.name:<{width}}  {sample.title} (outline: {sample.outline}{unit}{paper})")
    output.product("tessellations:")
    for each in tessellations:
        most, least = each["stretch"]
        stretch = f"{most:.3f}" if most - least < 1e-6 else f"{most:.3f} and {least:.3f}"
        reached = f"stretch 1 to {stretch}" if each["moves"] else f"stretch 1 or {stretch}, nothing between"
        note = f"; file {each['file']}" if each["file"] else ""
        output.product(f"  {each['name']:<{width}}  {each['title']} ({reached}{note})")
    planar = [
        {"name": name, "title": outlines.title(name), "published": outlines.is_published(name)}
        for name in outlines.names()
    ]
    output.product("planar outlines:")
    for each in planar:
        paper = " (published target)" if each["published"] else ""
        output.product(f"  {each['name']:<{width}}  {each['title']}{paper}")
    surfaces = [dataclasses.asdict(sample) for sample in found]
    return Outcome(0, {"samples": surfaces, "tessellations": tessellations, "outlines": planar})


def _tessellations() -> list[dict[str, Any]]:
    """What is known of every tessellation."""
    from kirisurf.unit_cells import catalog

    listed = []
    for entry in catalog():
        cell, file = entry.cell(), None if entry.file is None else str(entry.file)
        listed.append(
            {
                "name": entry.name,
                "title": entry.title,
                "tiles": len(cell.tiles),
                "stretch": [float(stretch) for stretch in cell.stretches],
                "moves": entry.moves,
                "file": file,
            }
        )
    return listed
