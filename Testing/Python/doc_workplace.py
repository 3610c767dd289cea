"""A folder with every file that README.md and docs/ name in their commands: tiny, made up, and of the kind that the name says."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
from dicom_samples import write_dicom
from doc_pages import REPOSITORY, blocks
from files import COLUMNS, IMAGE_TO_PROBE, LABELS_TO_REFERENCE, ROWS, tracked_sequence, write_patient
from made_pictures import write_pictures
from made_tables import Recording, motive
from made_wires import recording, write_phantom
from variant_files import slicer_images, slicer_transforms

from AIFReconLib.geometry.labels import Labels
from AIFReconLib.geometry.transform_graph import TransformName
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.io.plus.configuration import read_plus_configuration
from AIFReconLib.io.plus.phantom import read_wire_phantom
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.io.sequence.writer import write_sequence
from AIFReconLib.io.transform.files import write_transform
from AIFReconLib.io.volume.label_files import read_labels
from AIFReconLib.live.replay.server import ReplayServer
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.sweep.frames import TrackedSequence
from AIFReconLib.sweep.poses import sweep_poses

FRAMES = 8
ECHO_ROW = 19
"""Where the images show bone: a bright line in gray tissue, with darkness behind it."""


def bone_images() -> np.ndarray:
    """Frames of tissue with a bright line and its shadow, (frames, rows, columns)."""
    images = np.random.default_rng(0).integers(30, 60, (FRAMES, ROWS, COLUMNS), dtype=np.uint8)
    images[:, ECHO_ROW - 1 : ECHO_ROW + 1] = 250
    images[:, ECHO_ROW + 1 :] = 2
    return images


def _ct_of(labels: Labels) -> Volume:
    """Dense bone in muscle, 20 mm of it around, in air."""
    more = [int(np.ceil(20 / step)) for step in labels.spacing[::-1]]
    bone = np.pad(labels.array > 0, [(n, n) for n in more])
    values = np.pad(np.where(bone, 1500, 50).astype(np.int16), 4, constant_values=-1000)
    shift = np.eye(4)
    shift[:3, 3] = [-n - 4 for n in more[::-1]]
    return Volume(values, labels.ijk_to_reference @ shift)


def make_workplace(folder: Path) -> Path:
    """Write all files into `folder`, and return it."""
    patient = write_patient(folder, tracked_sequence(FRAMES, images=bone_images()))
    shutil.copy(patient.labels, folder / "lumbar.nrrd")
    shutil.copy(patient.config, folder / "Probe.xml")
    shutil.copy(patient.labels, folder / "lumbar-segmentation.nrrd")
    write_transform(IMAGE_TO_PROBE, folder / "ImageToProbe.tfm")
    write_transform(LABELS_TO_REFERENCE, folder / "CTToReference.tfm")
    write_transform(np.eye(4), folder / "correction.tfm")
    sequence = read_sequence(patient.sweep, config=patient.config)
    volume = reconstruct(sequence).intensity
    for name in ("volume.nrrd", "average.nrrd", "weighted.nrrd", "planned.nrrd"):
        volume.write(folder / name)
    _ct_of(read_labels(patient.labels)).write(folder / "ct.nrrd")
    _write_frames(sequence, folder)
    # The page says of its first block that it is this file
    (folder / "my_methods.py").write_text(next(blocks(REPOSITORY / "docs" / "own-method.md")).text, "utf-8")
    _write_optical_tracking(sequence, folder)
    shutil.copy(patient.sweep, folder / "water.igs.mha")
    write_sequence(recording(read_wire_phantom(write_phantom(folder / "PlusDeviceSet_fCal.xml")), 30, place=None), folder / "wires.igs.mha")
    slicer_images(folder / "Image.seq.nrrd")
    slicer_transforms(folder / "ImageToReference.seq.mha")
    slicer_transforms(folder / "Transform.seq.mha")
    return folder


def _write_frames(sequence: TrackedSequence, folder: Path) -> None:
    """Pictures, and a table of rigid poses of the image, pixel size taken out."""
    write_pictures(folder / "frames", np.asarray(sequence.images))
    poses = sweep_poses(sequence).image_to_reference
    spacing = np.linalg.norm(poses[0][:3, :3], axis=0)
    rows = ["time," + ",".join(f"m{i}{j}" for i in range(4) for j in range(4))]
    for number, pose in enumerate(poses):
        rigid_pose = pose @ np.diag([*(1 / spacing), 1.0])
        rows.append(",".join(map(repr, [0.05 * number, *rigid_pose.ravel().tolist()])))
    (folder / "poses.csv").write_text("\n".join(rows), "utf-8")


def _write_optical_tracking(sequence: TrackedSequence, folder: Path) -> None:
    """A cine in DICOM, Motive's table of the rigid bodies on probe and patient, a calibration, and a mask for each vertebra."""
    shutil.copy(folder / "ImageToProbe.tfm", folder / "calibration.tfm")
    write_dicom(folder / "cine.dcm", np.asarray(sequence.images), FrameTime=50.0)
    bodies = [[record.transforms[TransformName(tool, "Tracker")].matrix for record in sequence.records] for tool in ("Probe", "Reference")]
    times = 0.05 * np.arange(len(sequence))
    good = np.ones((2, len(sequence)), bool)
    table = motive(Recording(np.array(bodies), times, good, ["Probe", "Patient"], np.random.default_rng(0)))
    (folder / "motive.csv").write_text(table.text, "utf-8")
    (folder / "segmentations").mkdir()
    labels = read_labels(folder / "labels.nrrd")
    Volume((labels.array > 0).astype(np.uint8), labels.ijk_to_reference).write(folder / "segmentations" / "vertebrae_L3.nii.gz")


def serve(folder: Path) -> ReplayServer:
    """A server that sends the sweep of the folder over and over, as Plus would."""
    sequence = replace(read_sequence(folder / "sweep.igs.mha"), configuration=read_plus_configuration(folder / "PlusDeviceSet.xml"))
    server = ReplayServer(sequence, port=0, rate=60.0, loop=True)
    server.start()
    return server
