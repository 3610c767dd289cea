"""The application's start: its modules are made one after the other in the order of their names, then loaded in that order.

A loadable module brings the classes of its nodes and logics into `slicer` when it is made; a scripted module that comes before it finds
none of them. Once all modules are made they are loaded, those that a module depends on before it, and `startupCompleted` is told.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

import slicer

from . import modules

_LIBRARY = re.compile(r"vtkSlicer(\w+)Module(Logic|MRML|MRMLDisplayableManager|VTKWidgets)")
"""The Python library that a class comes from names its module."""


def classes_of_modules() -> dict[str, dict[str, type]]:
    """What each loadable module brings into `slicer`: its classes by name, by the module's name."""
    found: dict[str, dict[str, type]] = {}
    for name, kind in list(vars(slicer).items()):
        library = _LIBRARY.fullmatch(str(getattr(kind, "__module__", "")).rpartition(".")[2])
        if isinstance(kind, type) and library is not None:
            found.setdefault(library[1], {})[name] = kind
    return found


def start(application, paths) -> dict:
    """Starts the application with scripted modules from these files beside its own; the modules by name.

    Raises what a module raises when it is imported, made or set up, and KeyError where one depends on a module that is not there.
    """
    classes, own = classes_of_modules(), dict(application.moduleManager().loaded)
    sample_data = sys.modules.pop("SampleData")
    scripted = {Path(path).stem: str(path) for path in paths}
    for name in [name for kinds in classes.values() for name in kinds]:
        delattr(slicer, name)
    for name in own:
        modules.forget(application, name)
    made = {}
    try:
        for name in sorted({*classes, *own, "SampleData", *scripted}):
            vars(slicer).update(classes.pop(name, {}))
            if name == "SampleData":
                sys.modules[name] = sample_data
            if name in scripted:
                made[name] = modules.instantiate(scripted[name])
        for name in sorted({*own, *made}):
            _load(application, name, {**own, **made})
    finally:
        for kinds in classes.values():
            vars(slicer).update(kinds)
        sys.modules["SampleData"] = sample_data
        for name in own:
            modules.register(application, own[name])
    application.startupCompleted.emit()
    return made


def _load(application, name: str, made: dict) -> None:
    if name in application.moduleManager().loaded:
        return
    for needed in made[name].dependencies:
        _load(application, needed, made)
    modules.load(application, made[name])
