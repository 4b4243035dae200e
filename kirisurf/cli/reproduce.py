"""`kirisurf reproduce`: every published configuration, and the paper's figures, each by one command."""

from __future__ import annotations

import argparse
from typing import Any

from kirisurf.cli.output import Outcome, Output
from kirisurf.cli.parser import add_command, whole
from kirisurf.errors import ParameterError
from kirisurf.published import LARGEST
from kirisurf.spec import CLOSENESS

PUBLISHED = "published"
FIGURES = ("fig1", "fig2", "fig2a", "fig2b", "fig2c", "fig3", "fig4")
LARGEST_OF = ("fig2c", "fig2")
KINDS = ("2d", "3d")

_TEXT = f"""\
Makes again what Choi, Dudte and Mahadevan published (Nature Materials 18, 999-1004, 2019), in exact form:

  {PUBLISHED}  every planar and 3-D configuration: tessellation, target, cells, contracted shape. DIR receives
             published.csv, published.json, published.html (the table with pictures), and both states of
             every design as OBJ files in DIR/designs
  fig1       the regular pattern closed and open, what a general sheet has to meet, and a way from the one to the
             other (the quad pattern is the paper's; the rest says the same with a design of ours)
  fig2       fig2a, fig2b and fig2c, below one another in one picture
  fig2a      squares that open into a disc and into an egg
  fig2b      outlines of mixed and of zero curvature, from rectangles
  fig2c      circling the square: how the boundary layer shrinks with the number of tiles
  fig3       Fig. 3a: the energy of a square that opens into a disc, at several stiffnesses lambda of its slits; the
             lambda above which it no longer rests open by itself is found, and stated
  fig4       sheets that open into surfaces, with the curvature of their holes: a rectangle into the hyperbolic
             paraboloid, squares into the paraboloid and into peaks, and a sheet with a free rim into a hat

With --reference the published files are audited in the same way, and stand beside ours in the table.
A design counts as reproduced where it is certified with every row at most 1e-9 and its smallest tile edge is
at least 0.05 of the median.

exit codes: 0 all reproduced, 1 all reproduced but a picture could not be drawn, 2 wrong parameter, 3 reference
unreadable, 7 cannot write, 8 some were not reproduced (listed with the reasons)"""

_EXAMPLES = """\
  kirisurf reproduce published -o published --jobs 2
  kirisurf reproduce published -o curved --only 3d --reference path/to/published/files
  kirisurf reproduce published -o some --match quad_circle
  kirisurf reproduce fig2 -o fig2 --largest 8        without --largest, 1600 tiles in the end: many minutes"""


def add(commands: Any) -> None:
    """Add the command to the parser."""
    parser = add_command(commands, "reproduce", "make the published designs and figures again", _TEXT, _EXAMPLES)
    parser.add_argument("what", metavar="WHAT", help=" | ".join((PUBLISHED, *FIGURES)))
    parser.add_argument("-o", "--output", metavar="DIR", required=True, help="folder for the results: new or empty")
    parser.add_argument("--overwrite", action="store_true", help="write into a folder that holds something")
    parser.add_argument(
        "--reference", metavar="FOLDER", help=f"{PUBLISHED}: folder with 2d, 3d and targets, the published files"
    )
    parser.add_argument("--only", metavar="KIND", help=f"{PUBLISHED}: {' | '.join(KINDS)}")
    parser.add_argument("--match", metavar="TEXT", help=f"{PUBLISHED}: those with TEXT in their name")
    parser.add_argument(
        "--closeness", metavar="MODE", help=f"{PUBLISHED}: {' | '.join(CLOSENESS)}, as for fit (default: best)"
    )
    parser.add_argument("--jobs", metavar="N", type=whole, default=1, help="designs at a time (default: 1)")
    parser.add_argument(
        "--largest",
        metavar="N",
        type=whole,
        help=f"fig2, fig2c: cells a side of the largest pattern (default: {LARGEST})",
    )
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace, output: Output) -> Outcome:
    """Run the command."""
    what = arguments.what
    if what not in (PUBLISHED, *FIGURES):
        raise ParameterError(f"WHAT: expected one of {', '.join((PUBLISHED, *FIGURES))}, got {what!r}")
    if arguments.jobs < 1:
        raise ParameterError(f"--jobs: expected at least 1, got {arguments.jobs}")
    owners = dict.fromkeys(("reference", "only", "match", "closeness"), (PUBLISHED,)) | {"largest": LARGEST_OF}
    for name, owner in owners.items():
        given = getattr(arguments, name)
        if given is not None and what not in owner:
            raise ParameterError(f"--{name}: expected with {' or '.join(owner)} only, got {given!r} with {what}")
    if what == PUBLISHED:
        if arguments.only not in (None, *KINDS):
            raise ParameterError(f"--only: expected one of {', '.join(KINDS)}, got {arguments.only!r}")
        if arguments.closeness not in (None, *CLOSENESS):
            raise ParameterError(f"--closeness: expected one of {', '.join(CLOSENESS)}, got {arguments.closeness!r}")
        from kirisurf.cli.reproduce_published import reproduce_published

        return reproduce_published(arguments, output)
    if arguments.largest is not None and arguments.largest < 3:
        raise ParameterError(f"--largest: expected at least 3, got {arguments.largest}")
    from kirisurf.cli.reproduce_figures import reproduce_figure

    return reproduce_figure(arguments, output)
