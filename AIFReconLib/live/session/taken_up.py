"""The old name of `resumed_recording`, kept for scripts for one release."""

from __future__ import annotations

from .resumed_recording import TakenUp

__all__ = ["TakenUp"]
