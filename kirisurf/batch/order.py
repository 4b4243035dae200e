"""What a batch hands to the process that makes one run, and what comes back: plain values, as JSON lines."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any


@dataclass(frozen=True)
class Order:
    """One run that is to be made.

    Attributes
    ----------
    options : mapping
        The resolved spec, as `FitSpec.as_dict` gives it.
    folder : str
        Run folder; an older run in it is replaced.
    pictures : bool
    seconds : float
        Wall-clock limit.
    memory_mb : float
        Limit on memory of its own.
    """

    options: Mapping[str, Any]
    folder: str
    pictures: bool
    seconds: float
    memory_mb: float

    def line(self) -> bytes:
        """Return the order as one line of ASCII."""
        return json.dumps(asdict(self)).encode("ascii") + b"\n"

    @classmethod
    def of(cls, line: bytes | str) -> Order:
        """Read an order back."""
        return cls(**json.loads(line))


@dataclass(frozen=True)
class Answer:
    """How the process of one run ended.

    Attributes
    ----------
    code : int
        Exit code, as the command line's.
    message : str
        The error, where there was one.
    end : str
        What ended it from outside: 'time limit', 'memory limit', 'crashed'; empty where it ended by itself.
    said : tuple of str
        Last lines of its standard error.
    seconds, peak_mb : float
        Wall-clock time, and most memory that was resident.
    """

    code: int
    message: str = ""
    end: str = ""
    said: tuple[str, ...] = field(default_factory=tuple)
    seconds: float = 0.0
    peak_mb: float = 0.0

    def line(self) -> bytes:
        """Return the answer as one line of ASCII."""
        return json.dumps(asdict(self)).encode("ascii") + b"\n"

    @classmethod
    def of(cls, line: bytes | str) -> Answer:
        """Read an answer back."""
        values = json.loads(line)
        return cls(**{**values, "said": tuple(values["said"])})
