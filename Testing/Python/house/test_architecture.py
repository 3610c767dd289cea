"""The rooms of the project stand in one order, imports run down it, and the drawing in docs/developers.md shows them so."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[3]
LIBRARY = REPOSITORY / "AIFReconLib"
MODULE = REPOSITORY / "AIFRecon"
DRAWING = ElementTree.parse(REPOSITORY / "docs" / "images" / "architecture.svg").getroot()

ROOMS = (
    *("AIFRecon.py", "AIFReconGui/panel", "AIFReconGui/fields", "AIFReconGui"),
    *("AIFReconScene/picture", "AIFReconScene/live", "AIFReconScene/registration", "AIFReconScene/display"),
    *("AIFReconScene/volumes", "AIFReconScene/inputs", "AIFReconScene/sweep"),
    "AIFReconScene",
    *("commands", "batch", "terminal"),
    "worker",
    *("live/replay", "live/session", "live/pairing", "live/wire"),
    *("guidance", "paths"),
    *("evaluation", "simulation", "reconstruction", "inspection", "provenance", "compounding"),
    *("calibration", "registration", "bone", "resolve"),
    *("io/foreign", "io/sequence", "io/plus", "io/volume", "io/transform", "io/metafile", "io/disk"),
    *("sweep", "imaging", "holes", "recipe", "geometry", "machine"),
    *("compounding/methods", "progress", "errors", "message", "remedies", "arrays"),
)
"""From the top to the bottom: a room may import those that come after it. Folders, and the files that lie beside them."""
