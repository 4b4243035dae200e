"""Dense kernels of a factorization, on Fortran-ordered views, without the interpreter's lock.

SciPy's own wrappers of dgemm and dsyrk hold the lock while they compute, and copy views whose columns are
apart; the same routines are reached here through the pointers that SciPy publishes for Cython.
"""

from __future__ import annotations

import ctypes
from ctypes import byref, c_char, c_double, c_int, c_void_p
from typing import Any

import numpy as np
from scipy.linalg import cython_blas, cython_lapack


def _routine(module: Any, name: str, n_arguments: int) -> Any:
    """Return a routine as a ctypes function: all arguments are addresses, and the lock is released."""
    capsule = module.__pyx_capi__[name]
    name_of = ctypes.pythonapi.PyCapsule_GetName
    name_of.restype, name_of.argtypes = ctypes.c_char_p, [ctypes.py_object]
    pointer_of = ctypes.pythonapi.PyCapsule_GetPointer
    pointer_of.restype, pointer_of.argtypes = c_void_p, [ctypes.py_object, ctypes.c_char_p]
    signature = name_of(capsule)
    if signature.count(b",") != n_arguments - 1 or b", int *" not in signature:
        raise ImportError(f"expected {n_arguments} arguments of {name} with 32-bit integers, got {signature.decode()}")
    return ctypes.CFUNCTYPE(None, *[c_void_p] * n_arguments)(pointer_of(capsule, signature))


_gemm = _routine(cython_blas, "dgemm", 13)
_syrk = _routine(cython_blas, "dsyrk", 10)
_trsm = _routine(cython_blas, "dtrsm", 11)
_trsv = _routine(cython_blas, "dtrsv", 8)
_potrf = _routine(cython_lapack, "dpotrf", 5)

_L, _N, _R, _T = (byref(c_char(letter)) for letter in (b"L", b"N", b"R", b"T"))
_STEP = byref(c_int(1))
_MINUS, _ZERO, _ONE = (byref(c_double(number)) for number in (-1.0, 0.0, 1.0))


def _address(matrix: np.ndarray) -> int:
    return matrix.__array_interface__["data"][0]


def _leading(matrix: np.ndarray) -> Any:
    """Return the distance of columns, as the routines take it."""
    return byref(c_int(matrix.strides[1] >> 3))


def subtract_product(a: np.ndarray, b: np.ndarray, c: np.ndarray, fresh: bool = False) -> None:
    """Subtract a b' from c (m, n), where a is (m, k) and b (n, k); a `fresh` c counts as zero."""
    (m, n), k = c.shape, byref(c_int(a.shape[1]))
    beta = _ZERO if fresh else _ONE
    _gemm(
        _N,
        _T,
        byref(c_int(m)),
        byref(c_int(n)),
        k,
        _MINUS,
        _address(a),
        _leading(a),
        _address(b),
        _leading(b),
        beta,
        _address(c),
        _leading(c),
    )


def subtract_square(a: np.ndarray, c: np.ndarray, fresh: bool = False) -> None:
    """Subtract a a' from the lower half of c (m, m), where a is (m, k); a `fresh` c counts as zero."""
    n, k = byref(c_int(a.shape[0])), byref(c_int(a.shape[1]))
    beta = _ZERO if fresh else _ONE
    _syrk(_L, _N, n, k, _MINUS, _address(a), _leading(a), beta, _address(c), _leading(c))


def divide(triangle: np.ndarray, b: np.ndarray) -> None:
    """Replace b (m, k) by b times the transposed inverse of the lower triangle (k, k)."""
    m, k = byref(c_int(b.shape[0])), byref(c_int(b.shape[1]))
    _trsm(_R, _L, _T, _N, m, k, _ONE, _address(triangle), _leading(triangle), _address(b), _leading(b))


def factor(a: np.ndarray) -> None:
    """Replace the lower half of a (k, k) by its Cholesky factor.

    Raises
    ------
    numpy.linalg.LinAlgError
        Where a is not positive definite; numbers that are not finite may pass.
    """
    info = c_int(0)
    _potrf(_L, byref(c_int(a.shape[0])), _address(a), _leading(a), byref(info))
    if info.value:
        raise np.linalg.LinAlgError("the matrix is not positive definite")


def solve_triangle(triangle: np.ndarray, x: np.ndarray, transposed: bool = False) -> None:
    """Replace a contiguous x (k,) by the solution with a lower triangle (k, k), or with its transpose."""
    k, transpose = byref(c_int(len(x))), _T if transposed else _N
    _trsv(_L, transpose, _N, k, _address(triangle), _leading(triangle), _address(x), _STEP)
