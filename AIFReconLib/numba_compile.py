"""How loops are compiled: once per machine where a folder can be written to, without fused or reordered arithmetic, and without the GIL."""

from __future__ import annotations

from numba import __version__ as VERSION
from numba import njit

__all__ = ["VERSION", "compiled", "inlined"]

_OPTIONS = {"nogil": True, "error_model": "numpy", "fastmath": False}


def compiled(function):
    """`function` compiled when it is first called; the code is kept on disk for the next time.

    Notes
    -----
    numba keeps it beside the source, else in the user's cache folder (or where NUMBA_CACHE_DIR says). Where neither can be written to
    it is compiled anew in every process. A kernel calls only `inlined` functions of its own file, because the kept code is told to be
    out of date by that file alone.
    """
    try:
        return njit(cache=True, **_OPTIONS)(function)
    except RuntimeError:
        return njit(**_OPTIONS)(function)


def inlined(function):
    """`function` to be called by a `compiled` one of the same file."""
    return njit(**_OPTIONS)(function)
