"""BLAS on one thread while something is computed."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

from threadpoolctl import threadpool_limits

_Arguments = ParamSpec("_Arguments")
_Returned = TypeVar("_Returned")


def on_one_thread(function: Callable[_Arguments, _Returned]) -> Callable[_Arguments, _Returned]:
    """Return the function with BLAS on one thread inside.

    The sums are then the same whatever the number of cores. It is also faster: the small matrices of a sheet are not
    worth a second thread, and threads that wait for each other on a busy machine take several times as long.

    Examples
    --------
    >>> from threadpoolctl import threadpool_info
    >>> @on_one_thread
    ... def most_threads():
    ...     return max(pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas")
    >>> most_threads()
    1
    """

    @wraps(function)
    def limited(*args: _Arguments.args, **options: _Arguments.kwargs) -> _Returned:
        with threadpool_limits(1):
            return function(*args, **options)

    return limited
