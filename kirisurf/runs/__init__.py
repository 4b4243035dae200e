"""The run folder: written as one transaction, read back with its hashes checked."""

from kirisurf.runs.folder import RunFolder
from kirisurf.runs.run import Run, read_run

__all__ = ["Run", "RunFolder", "read_run"]
