"""One call from sequence to volume: where settings, region and probe come from, and what is told of it."""

from __future__ import annotations

import numpy as np
import pytest
from files import calibrated, tracked_sequence, write_patient
from sweeps import sphere_bone

from AIFReconLib.errors import BeamGeometryError, NoUsableFramesError, OperationCanceled, SequenceFormatError
from AIFReconLib.geometry.transform_graph import TransformStatus
from AIFReconLib.imaging.beams import ProbeGeometry
from AIFReconLib.imaging.region import ClipRectangle, ImageRegion
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.message import advised
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.terminal.remedies import in_options

FULL = ImageRegion(ClipRectangle((0, 0), (39, 29)))
WHOLE = ReconstructionSettings(clip_px=(0, 0, 39, 29))


def rectangle_images(count=6):
    """Bright ultrasound in columns 5 to 34 and rows 3 to 26 of a black image."""
    images = np.zeros((count, 30, 40), np.uint8)
    images[:, 3:27, 5:35] = np.random.default_rng(0).integers(60, 256, (count, 24, 30))
    return images


def test_a_clip_rectangle_that_is_the_whole_image_is_told_of_its_black_surround():
    sequence = calibrated(tracked_sequence(images=rectangle_images()), region=FULL, spacing=(2.0,) * 3)
    result = reconstruct(sequence)
    (note,) = (note for note in result.notes if "clip rectangle" in note)
    assert "whole image of 40 x 30 pixels" in note
    assert "clip_px=(5, 3, 29, 23)" in advised(note)
    assert "--clip-px 5 3 29 23" in in_options(result.messages[result.notes.index(note)])
    assert reconstruct(calibrated(method="maximum", spacing=(2.0,) * 3), WHOLE).method == "maximum"


PART = ImageRegion(ClipRectangle((5, 3), (9, 9)))


@pytest.mark.parametrize(
    ("images", "configuration", "pixels", "said"),
    [
        (None, {"scan_region": PART}, 100, ""),
        (None, {"scan_region": PART, "probe": ProbeGeometry("linear"), "scan_pixel": (7.0, 7.0)}, 30 * 40, "ScanConversion is not used"),
        (rectangle_images(), {"region": ImageRegion(ClipRectangle((0, 0), (38, 28)))}, 29 * 39, ""),
        (rectangle_images(), {}, 24 * 30, "Recognized in the images: a linear probe"),
    ],
)
def test_what_is_ultrasound_the_configuration_says_else_the_images(images, configuration, pixels, said):
    result = reconstruct(calibrated(tracked_sequence(images=images), **configuration), ReconstructionSettings(spacing=1.0))
    assert result.hits.array.sum() == pytest.approx(6 * pixels, rel=0.1 if "Recognized" in said else 0)
    assert any(said in note for note in result.notes)


@pytest.mark.parametrize(("scan", "said"), [({"scan_pixel": (7.0, 7.0)}, "ScanConversion is not used"), ({}, 'probe="linear"')])
def test_images_and_configurations_that_tell_no_beams_are_an_error_when_they_are_needed(scan, said):
    told = {"scan_region": PART, "probe": ProbeGeometry("linear"), **scan} if scan else {}
    with pytest.raises(BeamGeometryError, match=said):
        reconstruct(calibrated(**told), ReconstructionSettings(spacing=1.0, method="aif"), sphere_bone())


def test_skipping_past_every_tracked_frame_is_an_error():
    lost = dict.fromkeys((0, 3), TransformStatus.OUT_OF_VIEW)
    with pytest.raises(NoUsableFramesError, match="smaller skip"):
        reconstruct(calibrated(tracked_sequence(statuses=lost)), ReconstructionSettings(skip=3, spacing=1.0, clip_px=WHOLE.clip_px))


def test_progress_rises_from_0_to_1_and_cancels():
    seen = []
    settings = ReconstructionSettings(method="aif", spacing=1.0, hole_limit=2.0)
    sequence = calibrated(region=FULL, probe=ProbeGeometry("linear"))
    reconstruct(sequence, settings, sphere_bone(), progress=lambda fraction, message: seen.append(fraction) or True)
    assert (seen[0], seen[-1]) == (0.0, 1.0)
    assert seen == sorted(seen)
    with pytest.raises(OperationCanceled):
        reconstruct(sequence, settings, sphere_bone(), progress=lambda fraction, message: fraction < 0.5)


def test_a_file_cut_short_behind_the_last_tracked_frame_is_noticed(tmp_path):
    """Nobody would look at those frames, but their absence says that the header is wrong."""
    patient = write_patient(tmp_path, tracked_sequence(statuses=dict.fromkeys((4, 5), TransformStatus.OUT_OF_VIEW)))
    header, data = patient.sweep.read_bytes().split(b"ElementDataFile = LOCAL\n")
    header = header.replace(b"DimSize = 40 30 6", b"DimSize = 40 31 6")
    patient.sweep.write_bytes(header + b"ElementDataFile = LOCAL\n" + data)
    sequence = read_sequence(patient.sweep, config=patient.config)
    with pytest.raises(SequenceFormatError):
        reconstruct(sequence, ReconstructionSettings(spacing=1.0))
