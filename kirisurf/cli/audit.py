"""`kirisurf audit`: certify any pair of states."""

from __future__ import annotations

import argparse
from typing import Any

from kirisurf.cli.output import Outcome, Output
from kirisurf.cli.parser import add_command

_NOT_WITHIN = 5
_TEXT = """\
DEPLOYED and CONTRACTED are OBJ or VTP files with the same polygons on the same vertices, ours or another
program's: tiles that hinge share a vertex, the two sides of a slit have their own, which coincide in the
contracted state. Everything is recomputed from the files. Lengths are over the median deployed tile edge,
angles in radians. Without --target the rows on the target are not judged.

exit codes: 0 every row passes, 5 a row fails, 3 a file is unreadable, 4 a file is unusable"""

_EXAMPLES = """\
  kirisurf audit runs/hood/deployed.obj runs/hood/contracted.obj --target hood.stl
  kirisurf audit deployed.obj contracted.obj --json > certificate.json"""


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = add_command(commands, "audit", "certify a pair of states: every residual, pass or fail", _TEXT, _EXAMPLES)
    parser.add_argument("deployed", metavar="DEPLOYED", help="deployed state, OBJ or VTP")
    parser.add_argument("contracted", metavar="CONTRACTED", help="contracted state, OBJ or VTP")
    parser.add_argument("--target", metavar="TARGET", help="mesh file or name of a sample surface")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace, output: Output) -> Outcome:
    """Run the command."""
    from kirisurf.cli.certificate_table import certificate_table
    from kirisurf.judging import audit

    certificate = audit(arguments.deployed, arguments.contracted, arguments.target)
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
