"""How a program with windows begins a scan; what scans is loaded in the worker alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..progress import Progress
from .scan_request import ScanRequest

if TYPE_CHECKING:
    from .scan import Scan


def begin_scan(request: ScanRequest, progress: Progress | None = None) -> Scan:
    """Begin a scan; to be kept in the worker."""
    from .scan import Scan

    return Scan(request, progress)
