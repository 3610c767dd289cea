"""How loops are compiled: once per machine where a folder can be written to, without fused or reordered arithmetic, and without the GIL."""

from __future__ import annotations

import logging
from collections.abc import Callable
from functools import partial
from typing import Any, TypeVar

from numba import __version__ as VERSION
from numba import njit

logger = logging.getLogger(__name__)

__all__ = ["VERSION", "called", "compiled", "inlined"]

Kernel = TypeVar("Kernel", bound=Callable[..., object])
"""A loop over arrays; compiled, it is called as before."""

# numba notes thousands of lines about one kernel. Where the root logger takes all of them, as in Slicer, compiling takes ten times as long
if logging.getLogger("numba").level == logging.NOTSET:
    logging.getLogger("numba").setLevel(logging.WARNING)

# Nothing but Python calls kernels
_OPTIONS = {"no_cfunc_wrapper": True, "nogil": True, "error_model": "numpy", "fastmath": False}


def compiled(function: Kernel) -> Kernel:
    """`function` compiled when it is first called; the code is kept on disk for the next time.

    Notes
    -----
    numba keeps it beside the source, else in the user's cache folder (or where NUMBA_CACHE_DIR says). Where neither can be written to
    it is compiled anew in every process. A kernel calls only `called` and `inlined` functions of its own file, because the kept code is
    told to be out of date by that file alone.
    """
    try:
        dispatcher = njit(cache=True, **_OPTIONS)(function)
        dispatcher._cache.save_overload = partial(_saved, dispatcher._cache.save_overload)
    except RuntimeError as error:
        logger.info("%s is compiled anew in every process: its code cannot be kept (%s)", function.__name__, error)
        dispatcher = njit(**_OPTIONS)(function)
    kernel: Kernel = dispatcher
    return kernel


def inlined(function: Kernel) -> Kernel:
    """`function` to be called by a `compiled` one of the same file, and made part of it before it is compiled.

    Notes
    -----
    A call between compiled functions counts the references to every array that it hands over, each count a locked instruction: where
    rows of a few hundred pixels are handed over, that is a fifth of the time.
    """
    kernel: Kernel = njit(inline="always", **_OPTIONS)(function)
    return kernel


def called(function: Kernel) -> Kernel:
    """`function` of numbers alone, to be called by a `compiled` one of the same file.

    Notes
    -----
    There are no references to count. For numba to make it part of its callers, wherever they call it, would take longer than all else
    of some kernels; what returns several numbers is slower called than `inlined`.
    """
    kernel: Kernel = njit(no_cpython_wrapper=True, **_OPTIONS)(function)
    return kernel


def _saved(save: Callable[..., None], *arguments: Any) -> None:
    """Keep code, as numba does; a disk that is full costs time and nothing else."""
    try:
        save(*arguments)
    except OSError:
        logger.info("Compiled code cannot be kept", exc_info=True)
