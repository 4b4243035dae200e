"""From an exception to the sentence that the user reads and the exit code; never a traceback unasked."""

from __future__ import annotations

import errno

INTERRUPTED = 130
INTERNAL = 70
_PARAMETER, _OUTPUT, _LIMIT = 2, 7, 6


def explained(problem: BaseException) -> tuple[int, str]:
    """Return the exit code and the message of an exception."""
    from kirisurf.errors import KirisurfError

    if isinstance(problem, KirisurfError):
        return problem.exit_code, str(problem)
    if isinstance(problem, KeyboardInterrupt):
        return INTERRUPTED, "interrupted: nothing was saved, and nothing old was changed"
    if isinstance(problem, MemoryError) or _is_lack_of_memory(problem):
        return _LIMIT, "expected enough memory, got too little: try fewer tiles or a coarser target"
    if isinstance(problem, OSError) and problem.errno in (errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EFBIG):
        return _OUTPUT, f"expected room to write, got: {problem.strerror}; nothing old was changed"
    if isinstance(problem, FileNotFoundError) and problem.filename is None:
        # what Python says where a relative path starts at a folder that was deleted
        return _PARAMETER, "expected a current folder, got one that is gone: change to another, or give absolute paths"
    what = " ".join(str(problem).split()) or "no message"
    return INTERNAL, (
        f"internal error: {type(problem).__name__}: {what[:300]} "
        "(a defect of kirisurf, not of your input; --debug shows where; please report it with the command)"
    )


def _is_lack_of_memory(problem: BaseException) -> bool:
    """Memory may also run out while the system loads a library or starts a process."""
    if isinstance(problem, OSError):
        return problem.errno == errno.ENOMEM
    said = str(problem).lower()
    return isinstance(problem, ImportError) and ("failed to map segment" in said or "cannot allocate memory" in said)
