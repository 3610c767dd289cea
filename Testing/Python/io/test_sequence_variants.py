"""Every kind of sequence file that Plus and Slicer write, each checked by where a bright pixel lies in Reference, in millimeters."""

from __future__ import annotations

import numpy as np
import pytest
from sweeps import rigid
from variant_files import (
    COLUMNS,
    DEEP,
    EXPECTED,
    FRAMES,
    IMAGE_TO_PROBE,
    IMAGE_TO_REFERENCE,
    PROBE_TO_TRACKER,
    REFERENCE_TO_TRACKER,
    ROWS,
    header_transforms,
    landmarks_mm,
    numbers,
    pictures,
    poses,
    recorded,
    slicer_images,
    slicer_transforms,
)

from AIFReconLib.errors import SequenceFormatError
from AIFReconLib.geometry.transform_graph import TransformName
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.sweep.configuration import PlusConfiguration
from AIFReconLib.sweep.poses import sweep_poses

BLANK_TIMES = {f"Seq_Frame{n:04d}_Station": "a word" for n in range(FRAMES)}

ONE = {"pixels": pictures()[:1], "fields": {key: value for key, value in poses().items() if "Frame0000" in key}}
FOUR = {"DimSize": DEEP, "NDims": "4"}
CODES = ("MF", "MFD", "mf", "MN", "MND", "MNA", "UF", "UFA", "UFD", "UN", "UNA", "UND")
METAIMAGES = {
    "plain": {},
    "time last": {"Kinds": "domain domain time"},
    "no kinds": {"Kinds": None},
    "four dimensions": {"Kinds": "domain domain domain list", **FOUR},
    "four dimensions, no kinds": {"Kinds": None, **FOUR},
    "one picture": {**ONE, "NDims": "2", "DimSize": f"{COLUMNS} {ROWS}", "Kinds": "domain domain"},
    "one picture as a slice": {**ONE, "Kinds": "domain domain domain"},
    "no type, no orientation": {"UltrasoundImageType": None, "UltrasoundImageOrientation": None},
    "type as Slicer spells it": {"UltrasoundImageType": "BRIGHTNESSBRIGHTNESS"},
    **{code: {"pixels": pictures(flips=code[:2].upper()), "UltrasoundImageOrientation": code} for code in CODES},
    **{kind: {"pixels": pictures(kind)} for kind in ("<i2", ">i2", "<f4", ">f4", "<f8")},
    "color": {"pixels": pictures(color=True), "UltrasoundImageType": "RGB_COLOR"},
    "no timestamps": {"fields": poses(times=False)},
    "custom fields": {"fields": {"CustomFieldNames": "Operator Note", "Operator": "J. D. = me", **poses(), **BLANK_TIMES}},
    "frame numbers without zeros": {"fields": poses("Seq_Frame{n}_")},
    "lower-case first letter": {"fields": poses(probe="probeToTracker")},
    "header transforms": {"fields": header_transforms()},
}
COLOR = {"pixels": pictures(color=True)}
NRRDS = {
    "time last": {"kinds": "domain domain time"},
    "no kinds": {"kinds": None},
    "four dimensions": {"kinds": "domain domain domain list", "sizes": DEEP, "dimension": "4"},
    "color in four dimensions": {**COLOR, "kinds": "RGB-color domain domain domain list", "sizes": f"3 {DEEP}", "dimension": "5"},
    "orientation": {"pixels": pictures(flips="UN"), "fields": {"ultrasound image orientation": "UN", **poses()}},
    **{name: METAIMAGES[name] for name in ("plain", ">i2", "no timestamps", "lower-case first letter", "header transforms")},
    "color": COLOR,
}


@pytest.mark.parametrize(("name", "suffix"), [*((name, ".mha") for name in METAIMAGES), *((name, ".nrrd") for name in NRRDS)])
def test_a_landmark_lies_where_it_should(tmp_path, name, suffix):
    variant = (METAIMAGES if suffix == ".mha" else NRRDS)[name]
    sequence = read_sequence(recorded(tmp_path / f"sweep.igs{suffix}", **variant))
    np.testing.assert_allclose(landmarks_mm(sequence), EXPECTED[: 1 if name.startswith("one") else None], atol=1e-9)


def test_a_frame_without_an_image_is_skipped_and_moves_no_other(tmp_path):
    sequence = read_sequence(recorded(tmp_path / "sweep.mha", fields={**poses(), "Seq_Frame0001_ImageStatus": "INVALID"}))
    assert sweep_poses(sequence).skipped() == {"no image (INVALID)": [1]}
    np.testing.assert_allclose(landmarks_mm(sequence)[[0, 2]], EXPECTED[[0, 2]], atol=1e-9)


def test_frames_beyond_the_ten_thousandth_are_found(tmp_path):
    count = 10_003
    pixels = np.zeros((count, ROWS, COLUMNS), np.uint8)
    pixels[10_001, 3, 5] = 100
    fields = {"ReferenceToTrackerTransform": numbers(REFERENCE_TO_TRACKER), "ImageToProbeTransform": numbers(IMAGE_TO_PROBE)}
    fields |= {f"Seq_Frame{n:04d}_ProbeToTrackerTransform": numbers(PROBE_TO_TRACKER[1]) for n in (9_999, 10_000, 10_001)}
    sequence = read_sequence(recorded(tmp_path / "long.mha", pixels, fields, compressed=True))
    found = sweep_poses(sequence)
    assert found.usable.tolist() == [9_999, 10_000, 10_001]
    row, column = np.unravel_index(int(np.argmax(sequence.images[10_001])), (ROWS, COLUMNS))
    np.testing.assert_allclose((found.image_to_reference[10_001] @ (column, row, 0, 1))[:3], EXPECTED[1], atol=1e-9)


def test_a_transform_spelled_in_two_ways_is_refused_with_both_keys(tmp_path):
    path = recorded(tmp_path / "sweep.mha", fields={**poses(), "Seq_Frame0001_probeToTrackerTransform": numbers(np.eye(4))})
    with pytest.raises(SequenceFormatError, match=r"frame 1, ProbeToTracker is given twice, as ProbeToTrackerTransform and as probeTo"):
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


@pytest.mark.parametrize(
    ("frame", "told", "said"),
    [
        ("Image", {}, "geometry of their own"),
        ("Video", {"image_frame": "Video"}, "transforms of Video now include"),
        ("Video", {"config": PlusConfiguration(image_frame="Video")}, "transforms of Video now include"),
        ("Video", {}, "nothing includes"),
    ],
)
def test_the_volume_nodes_own_geometry_is_part_of_the_pose_whatever_the_image_is_called(tmp_path, frame, told, said):
    """In Slicer, a transform acts on what IJKToRAS makes of a pixel."""
    geometry = rigid((0.0, 0.0, 30.0), (7.0, -2.0, 1.0)) @ np.diag([0.25, 0.5, 1.0, 1.0])
    matrices = [pose @ np.linalg.inv(geometry) for pose in IMAGE_TO_REFERENCE]
    images = slicer_images(tmp_path / "i.seq.nrrd", matrix=geometry)
    transforms = slicer_transforms(tmp_path / "t.seq.mha", matrices=matrices)
    sequence = read_sequence(images, transform_sequences={f"{frame}ToReference": transforms}, **told)
    assert said in sequence.notes[-1]
    placed = sweep_poses(sequence, f"{frame}ToReference").image_to_reference
    np.testing.assert_allclose(placed, matrices if said == "nothing includes" else IMAGE_TO_REFERENCE, atol=1e-9)


def test_transforms_are_taken_at_the_time_of_the_image(tmp_path):
    """The tracker ran at its own rate: poses at 10.0 and 10.2 place the image of 10.1 halfway."""
    ends = [rigid((0, 0, 0), (0, 0, 0)), rigid((0, 0, 40.0), (10.0, 0, 0))]
    transforms = slicer_transforms(tmp_path / "t.seq.mha", name="ProbeToReference", matrices=ends, times=(10.0, 10.2))
    sequence = read_sequence(slicer_images(tmp_path / "i.seq.nrrd"), transform_sequences={"ProbeToReference": transforms})
    found = sequence.records[1].transforms[TransformName("Probe", "Reference")].matrix
    np.testing.assert_allclose(found, rigid((0, 0, 20.0), (5.0, 0, 0)), atol=1e-9)


@pytest.mark.parametrize("times", [(10.0, 10.1, 10.2), None])
def test_a_pose_that_slicer_calls_invalid_costs_its_frame_and_without_times_the_number_counts(tmp_path, times):
    transforms = slicer_transforms(tmp_path / "t.seq.mha", statuses=("OK", "OK", "INVALID"), times=times)
    sequence = read_sequence(slicer_images(tmp_path / "i.seq.nrrd"), transform_sequences={"ImageToReference": transforms})
    assert sweep_poses(sequence).usable.tolist() == [0, 1]
    np.testing.assert_allclose(landmarks_mm(sequence)[:2], EXPECTED[:2], atol=1e-9)
    assert any("for lack of times" in note for note in sequence.notes) == (times is None)


UNFIT = {
    "Seq_Frame0001_ImageToReferenceTransform =1 2 3": "frame 1, ImageToReferenceTransform must be 16 numbers; got 3",
    "Seq_Frame0001_ImageToReferenceTransform =1 2 x": "frame 1, ImageToReferenceTransform must be .*'x' is not a number",
    "Seq_Frame0001_Timestamp = soon": "frame 1, Timestamp must be a number of seconds; 'soon' is not a number",
    "Seq_Frame0002_Timestamp = 700": r"fits the images .10\.000 to 10\.200 s",
}


@pytest.mark.parametrize(("line", "expected"), UNFIT.items())
def test_a_transform_sequence_that_does_not_fit_is_explained(tmp_path, line, expected):
    path = slicer_transforms(tmp_path / "t.seq.mha", times=(700.0, 700.1, 700.2) if "700" in line else (10.0, 10.1, 10.2))
    key = line.split(" =")[0]
    path.write_text("\n".join(line if old.startswith(key + " =") else old for old in path.read_text().split("\n")))
    with pytest.raises(SequenceFormatError, match=expected):
        read_sequence(slicer_images(tmp_path / "i.seq.nrrd"), transform_sequences={"ImageToReference": path})
    with pytest.raises(SequenceFormatError, match="must hold the transform StylusToTracker; got ProbeToTracker, ReferenceToTracker"):
        read_sequence(recorded(tmp_path / "i.mha"), transform_sequences={"StylusToTracker": recorded(tmp_path / "s.mha")})


@pytest.mark.parametrize("compressed", [False, True])
def test_an_interleaved_sequence_that_is_cut_short_is_refused(tmp_path, compressed):
    path = slicer_images(tmp_path / "i.seq.nrrd", interleaved=True, compressed=compressed)
    path.write_bytes(path.read_bytes()[:-9])
    with pytest.raises(SequenceFormatError, match="cut short"):
        read_sequence(path).images[0]


@pytest.mark.parametrize(
    ("suffix", "changes", "sizes"),
    [
        (".mha", {"ElementSpacing": "0.2 0.3 1"}, [(0.2, 0.3)] * 3),
        (".mha", {"ElementSpacing": None, "ElementSize": "0.2 0.3 1"}, [(0.2, 0.3)] * 3),
        (".mha", {"ElementSpacing": None, "Seq_Frame0000_ElementSpacing": "0.2 0.3 0.2"}, [(0.2, 0.3), None, None]),
        (".mha", {"ElementSpacing": "7 7 7", "Seq_Frame0000_ElementSpacing": "0.2 0.3"}, [(0.2, 0.3), (7.0, 7.0), (7.0, 7.0)]),
        (".mha", {"ElementSpacing": None, "Seq_Frame0001_micronsPerPixel": "150"}, [None, (0.15, 0.15), None]),
        (".nrrd", {"spacings": "0.2 0.3 nan"}, [(0.2, 0.3)] * 3),
        (".nrrd", {"space dimension": "2", "space directions": "(0.2,0) (0,-0.3) none"}, [(0.2, 0.3)] * 3),
    ],
)
def test_the_size_of_a_pixel_that_a_file_states_is_known_of_its_frames(tmp_path, suffix, changes, sizes):
    sequence = read_sequence(recorded(tmp_path / f"sweep{suffix}", **changes))
    assert [record.stated_spacing for record in sequence.records] == sizes
