"""Targets that read one file: sequences, volumes, configurations, poses, transforms, images."""

from __future__ import annotations

import gzip
import zlib
from functools import partial
from pathlib import Path

import numpy as np

from AIFReconLib.effective_settings import asked_imaging
from AIFReconLib.errors import AIFReconError
from AIFReconLib.io.foreign.calibration import read_calibration
from AIFReconLib.io.foreign.openers import open_images
from AIFReconLib.io.foreign.options import ImportOptions
from AIFReconLib.io.foreign.poses.files import read_poses
from AIFReconLib.io.metafile.metaimage import ELEMENT_TYPES, FORMAT_KEYS
from AIFReconLib.io.plus.configuration import read_plus_configuration
from AIFReconLib.io.plus.importance_mask import read_importance_mask
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.io.sequence.transforms import read_transform_sequence
from AIFReconLib.io.transform.files import read_transform
from AIFReconLib.io.volume.files import read_volume
from AIFReconLib.io.volume.label_files import read_labels
from AIFReconLib.provenance.settings_files import read_settings
from AIFReconLib.recipe.recipe import KEPT
from AIFReconLib.sweep.configuration import NO_CONFIGURATION

from . import foreign_seeds, seeds
from .target import Target

METAIMAGE_WORDS = tuple(
    word.encode()
    for word in (
        *sorted(FORMAT_KEYS), *ELEMENT_TYPES, "LOCAL", "LIST", "data.raw", "/dev/zero", "../data.raw", "True", "False", "domain",
        "list", "time", "UNA", "MNX", "RF_IQ_LINE", "BRIGHTNESS", "INVALID", "Seq_Frame0001_",
        "Seq_Frame0001_ImageToReferenceTransform", "Transform",
    )
)  # fmt: skip
NRRD_WORDS = tuple(
    word.encode()
    for word in (
        "type", "dimension", "sizes", "encoding", "endian", "kinds", "space", "space directions", "space origin", "data file", "byte skip",
        "line skip", "spacings", "raw", "gzip", "gz", "ascii", "hex", "uint8", "short", "double", "block", "little", "big", "domain",
        "space", "list", "vector", "none", "???", "RGB-color", "(1,0,0)", "none", "right-anterior-superior", "left-posterior-superior-time",
        "scanner-xyz", "axis 3 index values", "axis 3 index type", "axis 0 item 5 Note", "LIST", "data.raw", "/dev/zero",
    )
)  # fmt: skip


def _check_sequence(path: Path) -> None:
    sequence = read_sequence(path)
    frames, rows, columns = sequence.images.shape
    assert len(sequence.records) == frames > 0
    assert min(rows, columns) > 0
    for record in sequence.records:
        assert record.timestamp is None or np.isfinite(record.timestamp)
        assert all(sample.matrix.shape == (4, 4) and sample.matrix.dtype == np.float64 for sample in record.transforms.values())
    for number in {0, frames // 2, frames - 1}:
        image = sequence.images[number]
        assert image.shape == (rows, columns)
        assert image.dtype == sequence.images.dtype


def _check_acquisition(path: Path) -> None:
    foreign_seeds.spread(path)
    _check_sequence(path)


def _check_transform_sequence(path: Path) -> None:
    for time, sample in read_transform_sequence(path, "ImageToReference"):
        assert time is None or np.isfinite(time)
        assert sample.matrix.shape == (4, 4)


def _check_volume(path: Path) -> None:
    volume = read_volume(path)
    assert volume.array.ndim == 3
    assert volume.array.size > 0
    assert volume.array.dtype.kind in "iuf"
    assert np.isfinite(volume.ijk_to_reference).all()
    assert (volume.grid.spacing > 0).all()


def _check_labels(path: Path) -> None:
    labels = read_labels(path)
    assert labels.array.ndim == 3
    assert labels.array.dtype.kind in "iu"
    assert labels.array.min() >= 0


def _check_configuration(path: Path) -> None:
    configuration = read_plus_configuration(path)
    assert all(np.isfinite(s.matrix).all() for s in configuration.transforms.values() if s.status.value == "OK")
    assert configuration.skip > 0
    assert all(np.isfinite(configuration.spacing or (1,)))
    assert min(configuration.spacing or (1,)) > 0
    grid = configuration.grid()
    assert grid is None or (min(grid.size) > 0 and np.isfinite(grid.ijk_to_reference).all())


def _check_poses(path: Path) -> None:
    """Every convention that a user may have stated; refused by all of them is refused."""
    refusals = []
    for form in (ImportOptions(), ImportOptions(quaternion_order="wxyz", column_major=True), ImportOptions(euler_order="ZYX")):
        try:
            table = read_poses(path, form)
        except AIFReconError as error:
            refusals.append(error)
            continue
        assert table.matrices.shape[1:] == (4, 4)
        assert len(table.matrices) > 0
        finite = table.matrices[np.isfinite(table.matrices).all(axis=(1, 2))]
        assert np.allclose(finite[:, 3], (0, 0, 0, 1))
        assert table.times is None or table.times.shape == table.matrices.shape[:1]
    if len(refusals) == 3:
        raise refusals[0]


def _check_settings(path: Path) -> None:
    kept = read_settings(path)
    grid, (_, probe) = kept.recipe.grid, asked_imaging(kept.recipe, NO_CONFIGURATION)
    assert grid is None or np.isfinite(grid.ijk_to_reference).all()
    assert probe is None or probe.kind in ("linear", "sector")


def _check_matrix(matrix: np.ndarray) -> None:
    assert matrix.shape == (4, 4)
    assert np.isfinite(matrix).all()
    assert np.isfinite(np.linalg.inv(matrix)).all()


def _check_images(path: Path) -> None:
    images = open_images([path])
    assert len(images.stack) == images.stack.shape[0] > 0
    assert images.times is None or len(images.times) == len(images.stack)
    assert images.spacing is None or min(images.spacing) > 0
    for number in {0, len(images.stack) - 1}:
        image = images.stack[number]
        assert image.shape == images.stack.shape[1:]
        assert image.dtype == images.stack.dtype
        assert image.dtype.kind in "iuf"


def _check_mask(path: Path) -> None:
    mask = read_importance_mask(path)
    assert mask.ndim == 2
    assert mask.dtype == np.float32
    assert mask.min() >= 0
    assert 0 < mask.max() <= 1


def _deflated(data: bytes) -> bytes:
    """The bytes behind the header, compressed: the header promises what it likes."""
    head, mark, payload = data.partition(b"ElementDataFile = LOCAL\n")
    return head + b"CompressedData = True\n" + mark + zlib.compress(payload, 1)


def _detached(data: bytes) -> bytes:
    return data.replace(b"ElementDataFile = LOCAL", b"ElementDataFile = data.raw")


def _gzipped(data: bytes) -> bytes:
    return gzip.compress(data, 1, mtime=0)


def _plain_metaimages() -> list[bytes]:
    return [seeds.metaimage(CompressedData=None), seeds.metaimage(CompressedData=None, DimSize="3 2 3", ElementType="MET_FLOAT")]


XML_WORDS = tuple(
    b"<!DOCTYPE a> <!ENTITY &lt; &#0; &#x41; <a> </a> <![CDATA[ ]]> <!-- --> <?a?> utf-16 ascii LINEAR MEAN LATEST ON OFF FanAngles "
    b'FanOrigin Compounding Calculation FanDepth DISTANCE_WEIGHT_INVERSE Status="INVALID" ProbeToTracker'.split()
)
TEXT_WORDS = tuple(
    b'x y z qx qw q1 q4 m00 m33 rx e0 time time_ms image status null true [] {} [ ] { } , ; " - # // nan quaternion matrix'.split()
)
SEQUENCES = (
    Target("sequence-metaimage", "sweep.mha", _check_sequence, seeds.metaimage_sequences, words=METAIMAGE_WORDS),
    Target("sequence-compressed", "sweep.mha", _check_sequence, _plain_metaimages, _deflated, words=METAIMAGE_WORDS),
    Target("sequence-detached", "sweep.mhd", _check_sequence, seeds.metaimage_sequences, _detached, words=METAIMAGE_WORDS),
    Target("sequence-nrrd", "sweep.seq.nrrd", _check_sequence, seeds.nrrd_sequences, words=NRRD_WORDS),
    Target("sequence-bundle", "sweep.mrb", _check_sequence, foreign_seeds.scenes, foreign_seeds.bundled, words=XML_WORDS),
    Target("sequence-arrays", "sweep.npz", _check_sequence, foreign_seeds.archives),
    Target("sequence-custusx", f"{foreign_seeds.ACQUISITION}.fts", _check_acquisition, foreign_seeds.acquisitions, words=TEXT_WORDS),
    Target("sequence-ros-1", "sweep.bag", _check_sequence, partial(foreign_seeds.bags, ".bag")),
    Target("sequence-mcap", "sweep.mcap", _check_sequence, partial(foreign_seeds.bags, ".mcap")),
    Target("sequence-ros-2", "sweep.db3", _check_sequence, partial(foreign_seeds.bags, ".db3")),
    Target("transform-sequence", "move.seq.mha", _check_transform_sequence, seeds.metaimage_sequences, words=METAIMAGE_WORDS),
)
VOLUMES = (
    Target("volume-metaimage", "ct.mha", _check_volume, lambda: seeds.volumes(".mha"), words=METAIMAGE_WORDS),
    Target("volume-nrrd", "ct.nrrd", _check_volume, lambda: seeds.volumes(".nrrd"), words=NRRD_WORDS),
    Target("labels-nrrd", "bone.seg.nrrd", _check_labels, lambda: seeds.volumes(".nrrd"), words=NRRD_WORDS),
    Target("volume-nifti", "ct.nii", _check_volume, seeds.nifti),
    Target("volume-nifti-compressed", "ct.nii.gz", _check_volume, seeds.nifti, _gzipped),
)
SETTINGS_WORDS = tuple(f"{name} ".encode() for name in KEPT) + TEXT_WORDS
TRANSFORM_WORDS = tuple(
    b"AffineTransform_double_3_3 Euler3DTransform_float_3_3 CompositeTransform_double_3_3 BSplineTransform_double_3_3 "
    b"DisplacementFieldTransform_double_3_3 AffineTransform_double_2_2 Similarity3DTransform_double_3_3 ScaleTransform_double_3_3 "
    b"Transform Parameters FixedParameters QuaternionRigidTransform_double_3_3 ThinPlateSplineKernelTransform_double_3_3 #Transform".split()
)
TEXTS = (
    Target("configuration", "plus.xml", _check_configuration, seeds.configurations, words=XML_WORDS),
    Target("poses-csv", "poses.csv", _check_poses, seeds.pose_tables, words=TEXT_WORDS),
    Target("poses-json", "poses.json", _check_poses, seeds.pose_json, words=TEXT_WORDS),
    Target("settings-json", "settings.json", _check_settings, lambda: seeds.settings(".json"), words=SETTINGS_WORDS),
    Target("settings-toml", "settings.toml", _check_settings, lambda: seeds.settings(".toml"), words=SETTINGS_WORDS),
    Target("calibration", "calibration.txt", lambda p: _check_matrix(read_calibration(p)[1]), seeds.calibrations, words=TRANSFORM_WORDS),
    Target("transform-text", "move.tfm", lambda p: _check_matrix(read_transform(p)), seeds.transform_texts, words=TRANSFORM_WORDS),
)
IMAGES = (
    Target("pictures", "frame.png", _check_images, seeds.pictures),
    Target("tiff", "frame.tif", _check_images, foreign_seeds.tiffs),
    Target("dicom", "frame.dcm", _check_images, seeds.dicom),
    Target("numpy", "images.npy", _check_images, seeds.arrays),
    *(Target(f"importance-mask-{kind}", f"mask.{kind}", _check_mask, partial(seeds.masks, f".{kind}")) for kind in ("png", "jpg", "tif")),
)
