"""Import paths that the documentation once named and that lie elsewhere now: they go on working, with a warning that says where."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Sequence
from importlib import import_module
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType

MOVED = {
    "AIFReconLib.live.messages": "AIFReconLib.live.wire.messages",
    "AIFReconLib.live.sources": "AIFReconLib.live.wire.sources",
    "AIFReconLib.poses": "AIFReconLib.sweep.poses",
}
"""Old path to new path."""


class MovedModules(MetaPathFinder, Loader):
    """Finds modules under their old paths; what they hold is the very same."""

    def find_spec(self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None) -> ModuleSpec | None:
        """A module that was moved; None for any other."""
        return ModuleSpec(fullname, self) if fullname in MOVED else None

    def exec_module(self, module: ModuleType) -> None:
        """Fill the old module with the names of the new one."""
        new = MOVED[module.__name__]
        # The frames between this one and the import statement are the import system's own
        warnings.warn(f"{module.__name__} is {new} now", DeprecationWarning, stacklevel=2)
        names = vars(import_module(new))
        vars(module).update({name: value for name, value in names.items() if not name.startswith("__")})


def find_moved_modules() -> None:
    """Let imports find what was moved, once."""
    if not any(isinstance(finder, MovedModules) for finder in sys.meta_path):
        sys.meta_path.append(MovedModules())
