"""Every target by its name."""

from __future__ import annotations

from .command_targets import COMMANDS
from .file_targets import IMAGES, SEQUENCES, TEXTS, VOLUMES
from .live_targets import LIVE

TARGETS = {target.name: target for target in (*SEQUENCES, *VOLUMES, *TEXTS, *IMAGES, *LIVE, *COMMANDS)}
