"""Lets a ParaView of before 5.12 load Python plugins under Python 3.11: put this folder on PYTHONPATH and start it.

That ParaView asks for a function that Python no longer has, before it looks at any plugin. Python imports a module of
this name by itself when it starts, and only then anything is changed.
"""

from __future__ import annotations

import inspect

if __name__ == "sitecustomize" and not hasattr(inspect, "getargspec"):
    inspect.getargspec = inspect.getfullargspec  # type: ignore[attr-defined]
