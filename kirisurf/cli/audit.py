"""`kirisurf audit`: certify any pair of states."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from kirisurf.cli.output import Outcome, Output
from kirisurf.cli.parser import add_command
from kirisurf.errors import ParameterError

_NOT_WITHIN = 5
_TEXT = """\
DEPLOYED and CONTRACTED are OBJ or VTP files with the same polygons on the same vertices, ours or another
program's: tiles that hinge share a vertex, the two sides of a slit have their own, which coincide in the
contracted state. Everything is recomputed from the files. Lengths are over the median deployed tile edge,
angles in radians. Without --target the rows on the target are not judged. --holes writes the holes of the
deployed sheet with their curvature as named fields, beside the target's own where there is one.

exit codes: 0 every row passes, 5 a row fails, 3 a file is unreadable, 4 a file is unusable"""

_EXAMPLES = """\
  kirisurf audit runs/hood/deployed.obj runs/hood/contracted.obj --target hood.stl
  kirisurf audit deployed.obj contracted.obj --json > certificate.json
  kirisurf audit deployed.obj contracted.obj --holes holes.vtp"""


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = add_command(commands, "audit", "certify a pair of states: every residual, pass or fail", _TEXT, _EXAMPLES)
    parser.add_argument("deployed", metavar="DEPLOYED", help="deployed state, OBJ or VTP")
    parser.add_argument("contracted", metavar="CONTRACTED", help="contracted state, OBJ or VTP")
    parser.add_argument("--target", metavar="TARGET", help="mesh file or name of a sample surface")
    parser.add_argument("--holes", metavar="FILE.vtp", help="write the holes with their curvature, replacing FILE")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace, output: Output) -> Outcome:
    """Run the command."""
    from kirisurf.cli.certificate_table import certificate_table
    from kirisurf.judging import audit

    if arguments.holes is not None and Path(arguments.holes).suffix.lower() != ".vtp":
        raise ParameterError(f"--holes: expected a file that ends in .vtp, got {arguments.holes}")
    certificate = audit(arguments.deployed, arguments.contracted, arguments.target)
    if arguments.holes is not None:
        _write_holes(arguments)
    output.product(certificate_table(certificate.rows, certificate.limits))
    for sentence in certificate.failures:
        output.warning(sentence)
    output.product("passed" if certificate.passed else f"failed: {len(certificate.failures)} of the rows")
    return Outcome(
        0 if certificate.passed else _NOT_WITHIN,
        {
            "passed": certificate.passed,
            "certificate": dict(certificate.rows),
            "failures": list(certificate.failures),
            "limits": dict(certificate.limits),
            "pieces": certificate.pieces,
            "flipped": certificate.flipped,
            "edge_length": certificate.edge_length,
            "beside": dict(certificate.extra),
        },
    )


def _write_holes(arguments: argparse.Namespace) -> None:
    from kirisurf.field_units import UNIT_OF_LENGTH, described_file
    from kirisurf.formats import read_fields, write_vtp
    from kirisurf.judging import measured_holes, origin_of

    found = measured_holes(arguments.deployed, arguments.contracted, arguments.target)
    unit = None
    if Path(arguments.deployed).suffix.lower() == ".vtp":
        named = list(read_fields(arguments.deployed).about.get(UNIT_OF_LENGTH, ()))
        unit = str(named[0]) if named else None
    about = described_file("holes", found.fields, unit, origin_of(arguments.deployed))
    write_vtp(arguments.holes, found.points, found.holes, None, found.fields, about)
