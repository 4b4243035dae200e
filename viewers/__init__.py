"""Showing a finished design: pictures, charts, reports and windows. Nothing is computed here."""

import logging
import os
import sys

# Where matplotlib keeps its list of fonts, and that it makes one, is no news for whoever wants a picture.
logging.getLogger("matplotlib").addHandler(logging.NullHandler())

if os.environ.get("MPLBACKEND"):
    try:
        import matplotlib  # noqa: F401
    except ValueError:
        # It names a window that there is none of, and matplotlib does not load then; ours draws to files alone.
        del os.environ["MPLBACKEND"]
        for name in [name for name in sys.modules if name.partition(".")[0] == "matplotlib"]:
            del sys.modules[name]
