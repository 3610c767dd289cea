"""Work for worker processes, in a file that takes them no time to import."""

from __future__ import annotations

import os
import sys


def double_or_die(number: int) -> int:
    """Twice the number; one below 0 ends the process."""
    if number < 0:
        os._exit(1)
    return 2 * number


def look_in(folder: str) -> None:
    """From now on find the modules of this folder, as those of the folder that a program is started in."""
    sys.path.insert(0, folder)
