"""Waiting for what must come. How long it takes decides nothing, so that a busy machine fails no test."""

from __future__ import annotations

import time
from collections.abc import Callable

PATIENCE = 300.0
"""s: more than any machine needs, and less than the time after which pytest ends a test that hangs."""


def until(condition: Callable[[], object]) -> bool:
    """Wait until the condition holds; whether it does."""
    end = time.monotonic() + PATIENCE
    while not (held := bool(condition())) and time.monotonic() < end:
        time.sleep(0.005)
    return held
