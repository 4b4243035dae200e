"""Exceptions of kirisurf, each with the exit code that the command line returns for it.

Bad input is an exception that names what was expected and what arrived; a numerical outcome is a
status (:mod:`kirisurf.status`), never an exception.
"""

from __future__ import annotations


class KirisurfError(Exception):
    """Base of every error that a user can cause; `exit_code` is that of the command line."""

    exit_code = 70


class ParameterError(KirisurfError, ValueError):
    """A wrong parameter: an unknown option, a value out of range, a run folder that exists."""

    exit_code = 2


class UnreadableError(KirisurfError):
    """An input that is missing, unsupported, damaged or unsafe to read."""

    exit_code = 3


class UnusableError(KirisurfError, ValueError):
    """An input that was read but cannot be used: topology, degeneracy, numbers that are not finite."""

    exit_code = 4


class LimitError(KirisurfError):
    """A limit of time or memory was reached before a result could be saved."""

    exit_code = 6


class OutputError(KirisurfError, OSError):
    """An output that cannot be written: full disk, no permission, locked. Nothing old was lost."""

    exit_code = 7
