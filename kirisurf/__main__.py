"""`python -m kirisurf`: the command line, with the current folder off Python's path.

Python puts the current folder first; a user's own analysis.py or viewers.py there would be taken for ours.
"""

from __future__ import annotations

import os
import sys


def _without_current_folder() -> None:
    home = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    try:
        here = os.getcwd()
    except OSError:  # it was deleted, or may not be read: nothing can be imported from it
        return
    # Where kirisurf itself runs from the current folder (a clone that is not installed), that folder has to stay.
    if not sys.flags.safe_path and sys.path and sys.path[0] in ("", here) and os.path.abspath(here) != home:
        del sys.path[0]


if __name__ == "__main__":
    _without_current_folder()
    try:
        from kirisurf.cli import main

        code = main()
    except KeyboardInterrupt:
        code = 130
    sys.exit(code)
