"""How much memory a reconstruction needs and how much there is, so that a too fine spacing is an answer and not a crash."""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from ..arrays import Floats
from ..errors import InsufficientMemoryError

SAFETY = 0.9
"""Part of the free memory that a volume may take."""

CONTROL_GROUP = Path("/sys/fs/cgroup")
"""Where Linux tells what a container may use."""

HANDY_SPACINGS = tuple(
    round(step * n, 2)
    for step, first, last in ((0.01, 1, 20), (0.05, 5, 20), (0.1, 11, 20), (0.5, 5, 20), (1.0, 11, 50))
    for n in range(first, last + 1)
)
"""mm, rising; what a message may suggest."""


def available_memory() -> int | None:
    """Bytes that this process may still allocate; None where the system does not tell.

    Notes
    -----
    The lesser of the system's free memory and the control group's limit (containers).
    """
    limits = [n for n in (_system_free(), _cgroup_free()) if n is not None]
    return max(min(limits), 0) if limits else None


def require_memory(
    size: tuple[int, int, int],
    spacing: Sequence[float] | Floats,
    bytes_per_voxel: int,
    available: int | None = None,
    *,
    most: int | None = None,
) -> None:
    """Raise `InsufficientMemoryError` unless a volume with this many bytes per voxel fits.

    Parameters
    ----------
    size : tuple of 3 int
        Voxels along i, j, k.
    spacing : (3,) mm
        For the advice in the message.
    available : int or None
        Bytes; asked from the system by default.
    most : int or None
        Voxels beyond which it does not fit, whatever the memory; by default `MAXIMUM_VOXELS`.
    """
    most = MAXIMUM_VOXELS if most is None else most
    available = available_memory() if available is None else available
    voxels = math.prod(size)
    needed = voxels * bytes_per_voxel
    if (available is None or needed <= SAFETY * available) and voxels <= most:
        return
    usable = most * bytes_per_voxel if available is None else min(SAFETY * available, most * bytes_per_voxel)
    fits = _spacing_that_fits(size, spacing, usable / bytes_per_voxel)
    box, pitch = " x ".join(map(str, size)), " x ".join(f"{s:.3g}" for s in spacing)
    can_be = f"at most {_gigabytes(usable)}" if available is None else _gigabytes(usable)
    raise InsufficientMemoryError(
        f"A volume of {box} voxels ({pitch} mm) needs {_gigabytes(needed)} of memory, and {can_be} can be used.",
        "No spacing would fit: free some memory, or choose a smaller box." if fits is None else "A spacing of {fits:g} mm would fit.",
        fits=fits,
    )


def require_bytes(path: Path, needed: int, available: int | None) -> None:
    """Raise `InsufficientMemoryError` unless the voxels of a file, so many bytes, fit into what is available."""
    if available is not None and needed > SAFETY * available:
        raise InsufficientMemoryError(
            f"{path}: its voxels need {needed / 1e9:.1f} GB of memory, and {available / 1e9:.1f} GB are free. Resample it, or free "
            "some memory."
        )


def _gigabytes(count: float) -> str:
    return f"{count / 1e9:.1f} GB" if count >= 1e8 else f"{count / 1e6:.1f} MB"


def _spacing_that_fits(size: tuple[int, int, int], spacing: Sequence[float] | Floats, most_voxels: float) -> float | None:
    """The finest handy spacing, the same along every axis, at which the same box has at most so many voxels; None for none."""
    # Half a voxel to spare, because the size was rounded
    extent = [(n - 0.5) * float(pitch) for n, pitch in zip(size, spacing, strict=True)]
    for fits in HANDY_SPACINGS:
        if math.prod(math.floor(mm / fits + 0.5) + 1 for mm in extent) <= most_voxels:
            return fits
    return None


def _system_free() -> int | None:
    meminfo = Path("/proc/meminfo")
    if meminfo.is_file():
        for line in meminfo.read_text("utf-8").splitlines():
            if line.startswith("MemAvailable:"):
                return int(line.split()[1]) * 1024
    if sys.platform == "win32":
        return _windows_free()
    try:
        # macOS does not report free memory without a shell; half of what is installed is a fair guess
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 2
    except (ValueError, OSError, AttributeError):
        return None


def _windows_free() -> int | None:
    # Said again, because a type checker on another system knows no windll
    if sys.platform != "win32":
        return None
    import ctypes

    class MemoryStatus(ctypes.Structure):
        _fields_ = [("length", ctypes.c_ulong), ("load", ctypes.c_ulong)] + [
            (name, ctypes.c_ulonglong)
            for name in ("total", "available", "total_page", "available_page", "total_virtual", "available_virtual", "extended")
        ]

    status = MemoryStatus(length=ctypes.sizeof(MemoryStatus))
    if not ctypes.windll.kernel32.GlobalMemoryStatusEx(ctypes.byref(status)):
        return None
    return int(min(status.available, status.available_virtual))


def _cgroup_free() -> int | None:
    # What files left in the cache counts as used, but is given back on demand
    try:
        limit = (CONTROL_GROUP / "memory.max").read_text("utf-8").strip()
        if limit == "max":
            return None
        statistics = dict(line.split() for line in (CONTROL_GROUP / "memory.stat").read_text("utf-8").splitlines())
        return int(limit) - int((CONTROL_GROUP / "memory.current").read_text("utf-8")) + int(statistics.get("inactive_file", 0))
    except (OSError, ValueError):
        return None


MAXIMUM_VOXELS = 2**31 - 1
"""Of what is worked in one part: voxel numbers are kept as 32-bit integers."""

LARGEST_GRID = 2**36
"""Voxels of a grid, more than any memory holds."""
