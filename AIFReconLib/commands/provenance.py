"""Where a volume comes from, for its file's header: version, method, every setting, and the inputs with their sizes."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterable
from dataclasses import asdict
from pathlib import Path

from .. import __version__
from ..compounding.reconstructor import Reconstruction
from ..terminal.options import settings_from

OF_THE_RUN = {
    *("run", "log", "quiet", "verbose", "host", "port"),
    *("output", "report", "preview", "record", "score", "hits", "mask", "cosine"),
}
"""Options that say where frames come from, where to write and what to print, and change no voxel."""


def provenance(arguments: argparse.Namespace, result: Reconstruction, inputs: Iterable[Path | None]) -> dict[str, str]:
    """The fields of a header, each a line of ASCII.

    Parameters
    ----------
    arguments : Namespace
        Of the command.
    result : Reconstruction
    inputs : paths
        Files that were read; None is passed over. Of paths only the names are kept: folders may name a patient.

    Notes
    -----
    Settings are as they were given, defaults included, by the options' names; what the configuration or the images decided is in the
    method and the hole limit beside them.
    """
    settings = {**asdict(settings_from(arguments)), "best_cosine": arguments.cosine is not None}
    given = {name: value for name, value in vars(arguments).items() if name not in OF_THE_RUN and value not in (None, [])}
    files = [{"name": path.name, "bytes": path.stat().st_size} for path in dict.fromkeys(inputs) if path is not None]
    return {
        "AIFRecon_version": __version__,
        "AIFRecon_method": result.method,
        "AIFRecon_hole_limit_mm": f"{result.hole_limit:g}",
        "AIFRecon_frames": str(result.frames_inserted),
        "AIFRecon_settings": json.dumps({**settings, **given}, default=_name, sort_keys=True),
        "AIFRecon_inputs": json.dumps(files),
    }


def _name(value: object) -> str:
    return value.name if isinstance(value, Path) else str(value)
