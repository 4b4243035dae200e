"""Seconds of a solve by its parts, measured by wrapping the methods that do them.

A part's time is its own: what a wrapped method spends in another wrapped one counts there and nowhere else, and
only what happens inside a solver's `solve` counts, so that the parts never exceed the solve.
"""

from __future__ import annotations

import functools
import importlib
import inspect
import pkgutil
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

PARTS = ("evaluate", "assemble", "symbolic", "factor", "substitute", "rest")
SOLVERS = ("InteriorPoint", "Peer")
METHODS = {
    "evaluate": {
        "Problem": ("objective", "gradient", "equality_rows", "inequality_rows", "violations"),
        "Linearization": ("at", "renewed", "_at"),
        "Scaled": ("project",),
    },
    "assemble": {
        "Linearization": ("hessian",),
        "Assembly": ("__init__", "hessian", "normal", "shift", "matrix", "jacobian"),
    },
    "symbolic": {"Symbolic": ("__init__",)},
    "factor": {"Cholesky": ("__init__",)},
    "substitute": {"KktFactor": ("solve",), "Cholesky": ("solve",)},
    "rest": dict.fromkeys(SOLVERS, ("solve",)),
}
BLOCKS = ("residual", "jacobian", "curvature")
"""Methods of the blocks, all of which count as evaluation."""
NEEDED = (
    "InteriorPoint.solve",
    "Scaled.project",
    "Linearization.at",
    "Linearization.hessian",
    "Assembly.hessian",
    "Symbolic.__init__",
    "Cholesky.__init__",
    "Cholesky.solve",
)
"""Without these the split says little; the table then names them."""


class Stopwatch:
    """Splits the time inside `rest` methods among the parts; put the methods back with `stop`.

    Attributes
    ----------
    seconds : dict of str to float
    found : set of str
        Names of the wrapped methods, with their class.
    """

    def __init__(self) -> None:
        self.seconds = dict.fromkeys(PARTS, 0.0)
        self.found: set[str] = set()
        self._running: list[str] = []
        self._since = 0.0
        self._thread = threading.get_ident()
        self._undo: list[Callable[[], None]] = []

    @property
    def missing(self) -> tuple[str, ...]:
        """Names in `NEEDED` that no class has any more."""
        return tuple(name for name in NEEDED if name not in self.found)

    def reset(self) -> None:
        """Start again from zero."""
        self.seconds = dict.fromkeys(PARTS, 0.0)

    def start(self) -> None:
        """Wrap whatever is there of the known methods, wherever their classes live in kirisurf."""
        for owner in _classes():
            for part, methods in METHODS.items():
                for name in methods.get(owner.__name__, ()):
                    self.wrap(owner, name, part)
            if _is_block(owner):
                for name in BLOCKS:
                    self.wrap(owner, name, "evaluate")

    def stop(self) -> None:
        """Put the methods back."""
        while self._undo:
            self._undo.pop()()

    def wrap(self, owner: type, name: str, part: str) -> None:
        """Time every call of a method that a class defines itself; nothing happens where it does not."""
        method = vars(owner).get(name)
        kind = type(method) if isinstance(method, (classmethod, staticmethod)) else None
        function = method.__func__ if isinstance(method, (classmethod, staticmethod)) else method
        if not inspect.isfunction(function):
            return

        @functools.wraps(function)
        def timed(*args: Any, **options: Any) -> Any:
            if threading.get_ident() != self._thread or not (self._running or part == "rest"):
                return function(*args, **options)
            self._switch()
            self._running.append(part)
            try:
                return function(*args, **options)
            finally:
                self._switch()
                self._running.pop()

        setattr(owner, name, timed if kind is None else kind(timed))
        self._undo.append(lambda: setattr(owner, name, method))
        self.found.add(f"{owner.__name__}.{name}")

    def _switch(self) -> None:
        now = time.perf_counter()
        if self._running:
            self.seconds[self._running[-1]] += now - self._since
        self._since = now


def _classes() -> Iterator[type]:
    """All classes that the computing modules of kirisurf define."""
    import kirisurf

    for module in pkgutil.walk_packages(kirisurf.__path__, "kirisurf."):
        if module.name.startswith(("kirisurf.cli", "kirisurf.__main__")) or module.name.endswith("_worker"):
            continue
        try:
            loaded = importlib.import_module(module.name)
        except ImportError:
            # an optional library, or a module in the middle of a change: what needs it will say so
            continue
        for found in list(vars(loaded).values()):
            if inspect.isclass(found) and found.__module__ == module.name:
                yield found


def _is_block(owner: type) -> bool:
    return owner.__module__.startswith(("kirisurf.constraints", "kirisurf.objective"))
