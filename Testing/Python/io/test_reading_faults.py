"""Files that fail, are cut or are replaced while they are read: one of the two files as a whole, or an error that says why not."""

from __future__ import annotations

import os

import numpy as np
import pytest
import SimpleITK as sitk

from AIFReconLib.errors import FileFormatError, OutputError, SequenceFormatError, VolumeFormatError
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.io.disk import regular_files
from AIFReconLib.io.foreign.openers import open_images
from AIFReconLib.io.foreign.options import ImportOptions
from AIFReconLib.io.foreign.poses.files import read_poses
from AIFReconLib.io.metafile import opening
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.io.sequence.writer import write_sequence
from AIFReconLib.io.transform.files import write_transform
from AIFReconLib.io.volume.files import read_volume
from AIFReconLib.sweep.frames import FrameRecord, TrackedSequence

FRAMES = np.random.default_rng(0).integers(0, 256, (6, 30, 40), dtype=np.uint8)


@pytest.mark.parametrize("order", [np.ascontiguousarray, np.asfortranarray], ids=["C", "Fortran"])
def test_an_array_is_refused_frame_by_frame_where_it_is_cut_or_vanishes_and_as_an_archive(tmp_path, order):
    file = tmp_path / "a.npy"
    np.save(file, order(FRAMES))
    stack = open_images([file]).stack
    np.testing.assert_array_equal(stack[3], FRAMES[3])
    for damage in (lambda: os.truncate(file, file.stat().st_size // 2), file.unlink):
        damage()
        with pytest.raises(FileFormatError, match="frame 5 cannot be read"):
            stack[5]
    with open(file, "wb") as archive:
        np.savez(archive, a=FRAMES)
    with pytest.raises(FileFormatError, match="archive of arrays"):
        open_images([file])


@pytest.mark.parametrize("suffix", [".mha", ".mhd", ".nrrd"])
def test_the_header_of_one_version_is_not_read_with_the_pixels_of_another(tmp_path, monkeypatch, suffix):
    """A writer replaces the file after its header was opened, and before its pixels are looked up."""
    path = tmp_path / f"s{suffix}"

    def write(version):
        images = np.full((3, 4, 5), version, np.uint8)
        write_sequence(TrackedSequence(images, [FrameRecord(float(version))] * 3), path, compress=False)

    def replaced_meanwhile(path):
        write(1)
        return format_of(path)

    write(0)
    format_of = opening.format_of
    monkeypatch.setattr(opening, "format_of", replaced_meanwhile)
    with pytest.raises(SequenceFormatError, match=r"changed while it was read|data file s\.raw is missing"):
        read_sequence(path)


@pytest.mark.parametrize("suffix", [".nii", ".nrrd"])
def test_a_volume_that_is_written_to_while_it_is_read_is_refused(tmp_path, monkeypatch, suffix):
    path = tmp_path / f"v{suffix}"
    Volume(np.ones((3, 4, 5), np.uint8), np.eye(4)).write(path)
    of, name = (sitk.ImageFileReader, "ReadImageInformation") if suffix == ".nii" else (sitk, "ReadImage")
    read = getattr(of, name)

    def meanwhile(*given, **named):
        image = read(*given, **named)
        with open(path, "ab") as file:
            file.write(b"\0")
        return image

    monkeypatch.setattr(of, name, meanwhile)
    with pytest.raises(VolumeFormatError, match="changed while it was read"):
        read_volume(path)


def test_a_table_that_is_written_to_while_it_is_read_is_refused(tmp_path, monkeypatch):
    (tmp_path / "p.csv").write_text("x,y,z,qw,qx,qy,qz\n" + "1,2,3,1,0,0,0\n" * 9, encoding="utf-8")
    stamps = iter(range(99))
    monkeypatch.setattr(regular_files, "stamp", lambda _: next(stamps))
    with pytest.raises(FileFormatError, match="changed while it was read"):
        read_poses(tmp_path / "p.csv", ImportOptions())


@pytest.mark.parametrize("content", ["", "#Insight Transform File V1.0\n"])
def test_a_transform_that_came_out_incomplete_does_not_get_its_name(tmp_path, monkeypatch, content):
    def write(_transform, name):
        with open(name, "w", encoding="utf-8") as file:
            file.write(content)

    monkeypatch.setattr(sitk, "WriteTransform", write)
    with pytest.raises(OutputError, match="came out incomplete"):
        write_transform(np.eye(4), tmp_path / "t.tfm")
    assert list(tmp_path.iterdir()) == []
