"""The real recordings and their Plus configurations, where they are: AIFRECON_DATA_DIR, else shared/data beside the repository."""

import os
import pathlib
import unittest

SPINE, BONE = "SpinePhantomFreehand.igs.mha", "BoneUltrasound_L14.igs.mha"
SPINE_CALIBRATION = "SpinePhantom_NN_MEAN.xml"
"""Its image axes lie 2.7 degrees off a right angle, and its pixels are not quite square: as calibrations are."""


def folder() -> pathlib.Path:
    """The folder of the recordings; a test that asks for it is skipped where there is none."""
    given = os.environ.get("AIFRECON_DATA_DIR")
    found = pathlib.Path(given) if given else pathlib.Path(__file__).resolve().parents[3] / "shared" / "data"
    if not found.is_dir():
        raise unittest.SkipTest(f"no real recordings in {found} (set AIFRECON_DATA_DIR)")
    return found


def recordingOf(configuration: pathlib.Path) -> pathlib.Path:
    """The recording that a configuration goes with."""
    return folder() / (BONE if configuration.name.startswith("Bone") else SPINE)
