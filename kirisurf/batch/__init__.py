"""Many fits: each in a process with limits, kept when the batch is started again, compared with a baseline."""

from kirisurf.batch.fitting import fit_batch

__all__ = ["fit_batch"]
