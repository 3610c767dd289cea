"""A small made-up patient on disk, as a user has it: sweep, Plus configuration, labels and their registration."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from sweeps import rigid, sphere_bone

from AIFReconLib.commands.parser import main
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample, TransformStatus
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.io.sequence.writer import write_sequence
from AIFReconLib.io.transform.files import write_transform
from AIFReconLib.sweep.configuration import PlusConfiguration
from AIFReconLib.sweep.frames import FrameRecord, TrackedSequence

COLUMNS, ROWS, SPACING = 40, 30, (0.4, 0.5)
IMAGE_TO_PROBE = rigid((4.0, -3.0, 8.0), (2.0, -1.0, 5.0)) @ np.diag([*SPACING, 0.45, 1.0])
LABELS_TO_REFERENCE = rigid((10.0, 20.0, -5.0), (30.0, -12.0, 7.0))

CONFIGURATION = """<PlusConfiguration version="2.1">
  <CoordinateDefinitions>
    <Transform From="Image" To="Probe" Matrix="{matrix}" />
  </CoordinateDefinitions>
  <ScanConversion TransducerGeometry="LINEAR" ImagingDepthMm="15" TransducerWidthMm="16" OutputImageSizePixel="40 30"
    OutputImageSpacingMmPerPixel="0.4 0.5" />
  <VolumeReconstruction ReferenceCoordinateFrame="Reference" ImageCoordinateFrame="Image" OutputSpacing="{spacing}" />
</PlusConfiguration>
"""


@dataclass(frozen=True)
class Patient:
    """Paths of the files, and the sequence that was written."""

    sweep: Path
    config: Path
    labels: Path
    transform: Path
    sequence: TrackedSequence

    @property
    def reconstruct(self) -> list[str]:
        """The usual command line, up to the output."""
        return ["reconstruct", str(self.sweep), "--config", str(self.config)]

    @property
    def bone(self) -> list[str]:
        """The usual bone options."""
        return ["--bone-labels", str(self.labels), "--bone-sigma-mm", "1.6", "--bone-transform", str(self.transform)]


def tracked_sequence(count=6, seed=0, statuses=None, images=None, matrices=None) -> TrackedSequence:
    """Frames about the origin of Reference, tracked as Plus does it: Probe and Reference in Tracker."""
    rng = np.random.default_rng(seed)
    reference_to_tracker = rigid((0.0, 40.0, 10.0), (100.0, 50.0, -900.0))
    records = []
    for number in range(count):
        image_to_reference = rigid(rng.normal(0, 12, 3), rng.normal(0, 1, 3)) @ rigid(translation=(-8.0, -7.0, 0.0))
        probe_to_tracker = reference_to_tracker @ image_to_reference @ np.linalg.inv(IMAGE_TO_PROBE @ np.diag([2.5, 2.0, 1 / 0.45, 1.0]))
        if matrices is not None and matrices.get(number) is not None:
            probe_to_tracker = matrices[number]
        status = (statuses or {}).get(number, TransformStatus.OK)
        records.append(
            FrameRecord(
                timestamp=10.0 + 0.05 * number,
                transforms={
                    TransformName("Probe", "Tracker"): TransformSample(probe_to_tracker, status),
                    TransformName("Reference", "Tracker"): TransformSample(reference_to_tracker),
                },
            )
        )
    if images is None:
        images = rng.integers(1, 256, (count, ROWS, COLUMNS), dtype=np.uint8)
    return TrackedSequence(images, records)


def calibrated(sequence: TrackedSequence | None = None, **configuration) -> TrackedSequence:
    """A sequence with its calibration, and with more of a configuration."""
    transforms = {TransformName("Image", "Probe"): TransformSample(IMAGE_TO_PROBE)}
    known = PlusConfiguration(**{"path": Path("made-up.xml"), "transforms": transforms, **configuration})
    return replace(sequence or tracked_sequence(), configuration=known)


def write_configuration(path: Path, attributes: str = "", holes: str = "", spacing: str = "1 1 1", matrix=IMAGE_TO_PROBE) -> Path:
    """The patient's Plus configuration, with more attributes of its VolumeReconstruction and elements of its HoleFilling."""
    text = CONFIGURATION.format(matrix=" ".join(map(repr, matrix.ravel().tolist())), spacing=spacing)
    path.write_text(text.replace('" />\n</Plus', f'" {attributes}><HoleFilling>{holes}</HoleFilling></VolumeReconstruction>\n</Plus'))
    return path


def write_patient(folder: Path, sequence: TrackedSequence | None = None, compress: bool = True, spacing: str = "1 1 1") -> Patient:
    """Write all files of a patient into `folder`."""
    sequence = sequence or tracked_sequence()
    patient = Patient(
        folder / "sweep.igs.mha", folder / "PlusDeviceSet.xml", folder / "labels.nrrd", folder / "CTToReference.tfm", sequence
    )
    write_sequence(sequence, patient.sweep, compress=compress)
    write_configuration(patient.config, spacing=spacing)
    inside = sphere_bone(center=(0.0, 0.0, 0.0)).inside
    assert inside is not None
    labels = np.pad(inside.array, 3)
    shift = rigid(translation=(-3, -3, -3))
    Volume(labels, np.linalg.inv(LABELS_TO_REFERENCE) @ inside.ijk_to_reference @ shift).write(patient.labels)
    write_transform(LABELS_TO_REFERENCE, patient.transform)
    return patient


def write_patient_with_bone(folder: Path, echo: int = 240) -> Patient:
    """A patient in a new folder, whose images show tissue, an echo of this gray level in rows 19 and 20, and next to nothing below."""
    folder.mkdir()
    images = np.random.default_rng(0).integers(20, 60, (6, ROWS, COLUMNS), dtype=np.uint8)
    images[:, 21:] //= 20
    images[:, 19:21] = echo
    return write_patient(folder, tracked_sequence(images=images))


def refused(arguments, capsys, folder):
    """Run a command that must fail: exit code 2, one line on stderr, nothing written. Returns the line."""
    code = main([str(argument) for argument in arguments])
    captured = capsys.readouterr()
    assert code == 2, captured
    assert captured.err.count("\n") == 1, captured.err
    assert captured.err.startswith("aifrecon")
    assert list(folder.iterdir()) == [], "something was left behind"
    return captured.err
