"""Every kind of sequence file that Plus and Slicer write, each checked by where a bright pixel lies in Reference, in millimeters."""

from __future__ import annotations

import gzip
import tracemalloc

import numpy as np
import pytest
from sweeps import rigid
from variant_files import (
    COLUMNS,
    DEEP,
    EXPECTED,
    FLAT,
    FRAMES,
    IMAGE_TO_PROBE,
    IMAGE_TO_REFERENCE,
    PROBE_TO_TRACKER,
    REFERENCE_TO_TRACKER,
    ROWS,
    Variant,
    header_transforms,
    landmarks_mm,
    numbers,
    pictures,
    poses,
    rgb,
    slicer_images,
    slicer_transforms,
    time_last,
)

from AIFReconLib.errors import SequenceFormatError
from AIFReconLib.geometry.transform_graph import TransformName, TransformStatus
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.sweep.configuration import PlusConfiguration
from AIFReconLib.sweep.poses import sweep_poses

BLANK_TIMES = {f"Seq_Frame{n:04d}_Station": "a word" for n in range(FRAMES)}

METAIMAGES = {
    "plain": Variant(),
    "compressed": Variant(compressed=True),
    "time last": Variant(changes=time_last("domain domain time", FLAT, "3")),
    "no kinds": Variant(changes=time_last(None, FLAT, "3")),
    "four dimensions": Variant(changes=time_last("domain domain domain list", DEEP, "4")),
    "four dimensions, time last": Variant(changes=time_last("domain domain domain time", DEEP, "4")),
    "four dimensions, no kinds": Variant(changes=time_last(None, DEEP, "4")),
    "no type, no orientation": Variant(changes={"UltrasoundImageType": None, "UltrasoundImageOrientation": None}),
    "type as Slicer spells it": Variant(changes={"UltrasoundImageType": "BRIGHTNESSBRIGHTNESS"}),
    "marked near": Variant(pictures(flips="MN"), changes={"UltrasoundImageOrientation": "MN"}),
    "unmarked far": Variant(pictures(flips="UF"), changes={"UltrasoundImageOrientation": "UFD"}),
    "unmarked near": Variant(pictures(flips="UN"), changes={"UltrasoundImageOrientation": "UNA"}),
    "short": Variant(pictures("<i2")),
    "short, big-endian": Variant(pictures(">i2")),
    "unsigned short, big-endian, compressed": Variant(pictures(">u2"), compressed=True),
    "float": Variant(pictures("<f4")),
    "float, big-endian": Variant(pictures(">f4")),
    "double": Variant(pictures("<f8")),
    "color": Variant(rgb(), changes={"ElementNumberOfChannels": "3", "UltrasoundImageType": "RGB_COLOR"}),
    "no timestamps": Variant(fields=poses(times=False)),
    "custom fields": Variant(fields={"CustomFieldNames": "Operator Note", "Operator": "J. D. = me", **poses(), **BLANK_TIMES}),
    "frame numbers without zeros": Variant(fields=poses("Seq_Frame{n}_")),
    "frame numbers of eight digits": Variant(fields=poses("Seq_Frame{n:08d}_")),
    "lower-case first letter": Variant(fields=poses(probe="probeToTracker")),
    "header transforms": Variant(fields=header_transforms()),
}
NRRDS = {
    "plain": Variant(),
    "compressed": Variant(compressed=True),
    "time last": Variant(changes={"kinds": "domain domain time"}),
    "no kinds": Variant(changes={"kinds": None}),
    "four dimensions": Variant(changes={"kinds": "domain domain domain list", "sizes": DEEP, "dimension": "4"}),
    "short, big-endian": Variant(pictures(">i2")),
    "float": Variant(pictures("<f4"), compressed=True),
    "color": Variant(rgb(), changes={"kinds": "vector domain domain list", "sizes": f"3 {FLAT}", "dimension": "4"}),
    "color in four dimensions": Variant(
        rgb(), changes={"kinds": "RGB-color domain domain domain list", "sizes": f"3 {DEEP}", "dimension": "5"}
    ),
    "orientation": Variant(pictures(flips="UN"), {"ultrasound image orientation": "UN", **poses()}),
    "lower-case first letter": Variant(fields=poses(probe="probeToTracker")),
    "header transforms": Variant(fields=header_transforms()),
    "no timestamps": Variant(fields=poses(times=False)),
}


@pytest.mark.parametrize("name", METAIMAGES)
def test_a_landmark_in_a_metaimage_lies_where_it_should(tmp_path, name):
    sequence = read_sequence(METAIMAGES[name].write_mha(tmp_path / "sweep.igs.mha"))
    np.testing.assert_allclose(landmarks_mm(sequence), EXPECTED, atol=1e-9)


@pytest.mark.parametrize("name", NRRDS)
def test_a_landmark_in_an_nrrd_lies_where_it_should(tmp_path, name):
    sequence = read_sequence(NRRDS[name].write_nrrd(tmp_path / "sweep.igs.nrrd"))
    np.testing.assert_allclose(landmarks_mm(sequence), EXPECTED, atol=1e-9)


def test_a_single_frame_of_two_dimensions_lies_where_it_should(tmp_path):
    fields = {key: value for key, value in poses().items() if "Frame0000" in key}
    variant = Variant(pictures()[:1], fields, changes=time_last("domain domain", f"{COLUMNS} {ROWS}", "2"))
    np.testing.assert_allclose(landmarks_mm(read_sequence(variant.write_mha(tmp_path / "still.mha"))), EXPECTED[:1], atol=1e-9)


@pytest.mark.parametrize("kind", ["RF_I_LINE_Q_LINE", "RF_IQ_LINE", "RF_REAL"])
def test_radio_frequency_data_are_refused_with_the_reason(tmp_path, kind):
    variant = Variant(changes={"UltrasoundImageType": kind, "UltrasoundImageOrientation": "FM"})
    with pytest.raises(SequenceFormatError, match=f"radio-frequency data .type {kind}, orientation FM.*Export B-mode frames"):
        read_sequence(variant.write_mha(tmp_path / "rf.mha"))


def test_a_frame_without_an_image_is_skipped_and_moves_no_other(tmp_path):
    variant = Variant(fields={**poses(), "Seq_Frame0001_ImageStatus": "INVALID"})
    sequence = read_sequence(variant.write_mha(tmp_path / "sweep.mha"))
    found = sweep_poses(sequence)
    assert found.skipped() == {"no image (INVALID)": [1]}
    np.testing.assert_allclose(landmarks_mm(sequence)[[0, 2]], EXPECTED[[0, 2]], atol=1e-9)


def test_frames_beyond_the_ten_thousandth_are_found(tmp_path):
    count = 10_003
    pixels = np.zeros((count, ROWS, COLUMNS), np.uint8)
    pixels[10_001, 3, 5] = 100
    fields = {"ReferenceToTrackerTransform": numbers(REFERENCE_TO_TRACKER), "ImageToProbeTransform": numbers(IMAGE_TO_PROBE)}
    fields |= {f"Seq_Frame{n:04d}_ProbeToTrackerTransform": numbers(PROBE_TO_TRACKER[1]) for n in (9_999, 10_000, 10_001)}
    variant = Variant(pixels, fields, compressed=True, changes={"DimSize": f"{COLUMNS} {ROWS} {count}"})
    sequence = read_sequence(variant.write_mha(tmp_path / "long.mha"))
    found = sweep_poses(sequence)
    assert found.usable.tolist() == [9_999, 10_000, 10_001]
    row, column = np.unravel_index(int(np.argmax(sequence.images[10_001])), (ROWS, COLUMNS))
    np.testing.assert_allclose((found.image_to_reference[10_001] @ (column, row, 0, 1))[:3], EXPECTED[1], atol=1e-9)


def test_a_transform_spelled_in_two_ways_is_refused_with_both_keys(tmp_path):
    variant = Variant(fields={**poses(), "Seq_Frame0001_probeToTrackerTransform": numbers(np.eye(4))})
    with pytest.raises(SequenceFormatError, match=r"frame 1, ProbeToTracker is given twice, as ProbeToTrackerTransform and as probeTo"):
        read_sequence(variant.write_mha(tmp_path / "sweep.mha"))


@pytest.mark.parametrize("code", ["??", "XX"])
def test_an_unknown_orientation_is_refused_with_the_way_out(tmp_path, code):
    path = Variant(changes={"UltrasoundImageOrientation": code}).write_mha(tmp_path / "sweep.mha")
    with pytest.raises(SequenceFormatError, match=r"did not know it.*say it with orientation"):
        read_sequence(path)


# Slicer's own files


@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize("color", [False, True])
@pytest.mark.parametrize("interleaved", [False, True])
def test_a_landmark_in_slicers_sequences_lies_where_it_should(tmp_path, interleaved, color, compressed):
    images = slicer_images(tmp_path / "Image.seq.nrrd", interleaved=interleaved, color=color, compressed=compressed)
    transforms = slicer_transforms(tmp_path / "ImageToReference.seq.mha")
    sequence = read_sequence(images, transform_sequences={"ImageToReference": transforms})
    np.testing.assert_allclose(landmarks_mm(sequence), EXPECTED, atol=1e-9)
    assert [record.timestamp for record in sequence.records] == [10.0, 10.1, 10.2]


def test_the_volume_nodes_own_geometry_is_part_of_the_pose(tmp_path):
    """In Slicer, a transform acts on what IJKToRAS makes of a pixel."""
    geometry = rigid((0.0, 0.0, 30.0), (7.0, -2.0, 1.0)) @ np.diag([0.25, 0.5, 1.0, 1.0])
    matrices = [pose @ np.linalg.inv(geometry) for pose in IMAGE_TO_REFERENCE]
    images = slicer_images(tmp_path / "i.seq.nrrd", matrix=geometry)
    transforms = slicer_transforms(tmp_path / "t.seq.mha", matrices=matrices)
    sequence = read_sequence(images, transform_sequences={"ImageToReference": transforms})
    np.testing.assert_allclose(landmarks_mm(sequence), EXPECTED, atol=1e-9)
    assert "geometry of their own" in sequence.notes[-1]


@pytest.mark.parametrize("told", ["by name", "by configuration"])
def test_the_geometry_is_part_of_the_pose_whatever_the_image_is_called(tmp_path, told):
    geometry = rigid((0.0, 0.0, 30.0), (7.0, -2.0, 1.0)) @ np.diag([0.25, 0.5, 1.0, 1.0])
    images = slicer_images(tmp_path / "i.seq.nrrd", matrix=geometry)
    transforms = slicer_transforms(tmp_path / "t.seq.mha", matrices=[pose @ np.linalg.inv(geometry) for pose in IMAGE_TO_REFERENCE])
    how = {"image_frame": "Video"} if told == "by name" else {"config": PlusConfiguration(image_frame="Video")}
    sequence = read_sequence(images, transform_sequences={"VideoToReference": transforms}, **how)
    placed = sweep_poses(sequence, "VideoToReference").image_to_reference
    np.testing.assert_allclose(placed, IMAGE_TO_REFERENCE, atol=1e-9)
    assert "transforms of Video now include" in sequence.notes[-1]


def test_a_geometry_that_no_transform_includes_is_said(tmp_path):
    images = slicer_images(tmp_path / "i.seq.nrrd", matrix=np.diag([0.25, 0.5, 1.0, 1.0]))
    sequence = read_sequence(images, transform_sequences={"VideoToReference": slicer_transforms(tmp_path / "t.seq.mha")})
    assert "nothing includes" in sequence.notes[-1]


def test_transforms_are_taken_at_the_time_of_the_image(tmp_path):
    """The tracker ran at its own rate: poses at 10.0 and 10.2 place the image of 10.1 halfway."""
    ends = [rigid((0, 0, 0), (0, 0, 0)), rigid((0, 0, 40.0), (10.0, 0, 0))]
    transforms = slicer_transforms(tmp_path / "t.seq.mha", name="ProbeToReference", matrices=ends, times=(10.0, 10.2))
    sequence = read_sequence(slicer_images(tmp_path / "i.seq.nrrd"), transform_sequences={"ProbeToReference": transforms})
    found = sequence.records[1].transforms[TransformName("Probe", "Reference")].matrix
    np.testing.assert_allclose(found, rigid((0, 0, 20.0), (5.0, 0, 0)), atol=1e-9)


def test_a_pose_that_slicer_calls_invalid_costs_its_frame(tmp_path):
    transforms = slicer_transforms(tmp_path / "t.seq.mha", statuses=("OK", "OK", "INVALID"))
    sequence = read_sequence(slicer_images(tmp_path / "i.seq.nrrd"), transform_sequences={"ImageToReference": transforms})
    assert sequence.records[2].transforms[TransformName("Image", "Reference")].status is TransformStatus.MISSING


def test_without_times_frames_are_paired_by_their_number(tmp_path):
    transforms = slicer_transforms(tmp_path / "t.seq.mha", times=None)
    sequence = read_sequence(slicer_images(tmp_path / "i.seq.nrrd"), transform_sequences={"ImageToReference": transforms})
    np.testing.assert_allclose(landmarks_mm(sequence), EXPECTED, atol=1e-9)
    assert "for lack of times" in sequence.notes[0]


def test_transforms_of_another_time_are_refused_with_both_times(tmp_path):
    transforms = slicer_transforms(tmp_path / "t.seq.mha", times=(700.0, 700.1, 700.2))
    with pytest.raises(SequenceFormatError, match=r"times 700\.000 to 700\.200 s. fits the images .10\.000 to 10\.200 s"):
        read_sequence(slicer_images(tmp_path / "i.seq.nrrd"), transform_sequences={"ImageToReference": transforms})


def test_a_transform_that_the_file_lacks_is_refused_with_those_it_has(tmp_path):
    path = Variant().write_mha(tmp_path / "sweep.mha")
    with pytest.raises(
        SequenceFormatError, match="must hold the transform StylusToTracker; got ProbeToTracker, ReferenceToTracker, ImageTo"
    ):
        read_sequence(slicer_images(tmp_path / "i.seq.nrrd"), transform_sequences={"StylusToTracker": path})


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("Seq_Frame0001_ImageToReferenceTransform =1 2 3", "frame 1, ImageToReferenceTransform must be 16 numbers; got 3"),
        ("Seq_Frame0001_ImageToReferenceTransform =1 2 x", "frame 1, ImageToReferenceTransform must be 16 numbers; 'x' is not a number"),
        ("Seq_Frame0001_Timestamp = soon", "frame 1, Timestamp must be a number of seconds; 'soon' is not a number"),
    ],
)
def test_a_damaged_transform_sequence_is_explained(tmp_path, line, expected):
    path = slicer_transforms(tmp_path / "t.seq.mha")
    key = line.split(" =")[0]
    path.write_text("\n".join(line if old.startswith(key + " =") else old for old in path.read_text().split("\n")))
    with pytest.raises(SequenceFormatError, match=expected):
        read_sequence(slicer_images(tmp_path / "i.seq.nrrd"), transform_sequences={"ImageToReference": path})


def test_an_interleaved_sequence_is_in_memory_once(tmp_path):
    path = tmp_path / "i.seq.nrrd"
    header = "NRRD0005\ntype: uchar\ndimension: 4\nsizes: 900 200 200 1\nkinds: list domain domain domain\nencoding: gzip\n"
    values = " ".join(map(str, range(900)))
    pixels = np.broadcast_to((np.arange(900) % 251).astype(np.uint8), (200 * 200, 900))
    path.write_bytes(f"{header}axis 0 index type:=numeric\naxis 0 index values:={values}\n\n".encode() + gzip.compress(pixels.tobytes(), 1))
    images = read_sequence(path).images
    tracemalloc.start()
    try:
        assert [int(images[n][150, 199]) for n in (0, 700, 250)] == [0, 700 % 251, 250]
        assert tracemalloc.get_traced_memory()[1] < 1.2 * pixels.size
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("compressed", [False, True])
def test_an_interleaved_sequence_that_is_cut_short_is_refused(tmp_path, compressed):
    path = slicer_images(tmp_path / "i.seq.nrrd", interleaved=True, compressed=compressed)
    path.write_bytes(path.read_bytes()[:-9])
    with pytest.raises(SequenceFormatError, match="cut short"):
        read_sequence(path).images[0]


@pytest.mark.parametrize(
    "changes",
    [
        {"ElementSpacing": "0.2 0.3 1"},
        {"ElementSize": "0.2 0.3 1"},
        {"Seq_Frame0000_ElementSpacing": "0.2 0.3 0.2"},
        {"Seq_Frame0000_ElementSpacing": "0.2 0.3", "ElementSpacing": "7 7 7"},
    ],
)
def test_the_size_of_a_pixel_that_a_metaimage_states_is_known_of_its_frames(tmp_path, changes):
    path = Variant(fields=poses(), changes={"ElementSpacing": None, **changes}).write_mha(tmp_path / "sweep.mha")
    assert read_sequence(path).records[0].stated_spacing == (0.2, 0.3)


def test_the_microns_of_a_clarius_are_a_size_of_a_pixel(tmp_path):
    path = Variant(changes={"ElementSpacing": None, "Seq_Frame0001_micronsPerPixel": "150"}).write_mha(tmp_path / "sweep.mha")
    assert [record.stated_spacing for record in read_sequence(path).records] == [None, (0.15, 0.15), None]


@pytest.mark.parametrize("changes", [{"spacings": "0.2 0.3 nan"}, {"space dimension": "2", "space directions": "(0.2,0) (0,-0.3) none"}])
def test_the_size_of_a_pixel_that_an_nrrd_states_is_known_of_its_frames(tmp_path, changes):
    path = Variant(changes=changes).write_nrrd(tmp_path / "sweep.nrrd")
    assert {record.stated_spacing for record in read_sequence(path).records} == {(0.2, 0.3)}
