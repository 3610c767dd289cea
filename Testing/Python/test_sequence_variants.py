"""Every kind of sequence file that Plus and Slicer write, each checked by where a bright pixel lies in Reference, in millimeters.

The files are written here, byte by byte, from the manuals' words, so that reader and writer of the library cannot share a mistake.
"""

from __future__ import annotations

import gzip
import tracemalloc
import zlib
from dataclasses import dataclass, field

import numpy as np
import pytest
from sweeps import rigid

from AIFReconLib.errors import SequenceFormatError, SettingsError
from AIFReconLib.geometry.transform_graph import TransformName, TransformStatus
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.sweep.poses import sweep_poses

COLUMNS, ROWS, FRAMES = 7, 5, 3
LANDMARKS = ((2, 1), (5, 3), (4, 0))
"""Column and row of the bright pixel of each frame, in MF orientation."""

IMAGE_TO_PROBE = rigid((3.0, -8.0, 15.0), (4.0, 5.0, 6.0)) @ np.diag([0.25, 0.5, 0.3, 1.0])
REFERENCE_TO_TRACKER = rigid((-20.0, 40.0, 10.0), (100.0, -50.0, 30.0))
PROBE_TO_TRACKER = [rigid((10.0 * n, -5.0, 3.0 * n), (20.0 + n, -3.0 * n, 7.0)) for n in range(FRAMES)]
EXPECTED = np.array(
    [(np.linalg.inv(REFERENCE_TO_TRACKER) @ PROBE_TO_TRACKER[n] @ IMAGE_TO_PROBE @ (*LANDMARKS[n], 0.0, 1.0))[:3] for n in range(FRAMES)]
)
TYPES = {"u1": "MET_UCHAR", "i2": "MET_SHORT", "u2": "MET_USHORT", "f4": "MET_FLOAT", "f8": "MET_DOUBLE"}
NRRD_TYPES = {"u1": "unsigned char", "i2": "short", "u2": "ushort", "f4": "float", "f8": "double"}


def numbers(matrix) -> str:
    return " ".join(repr(float(value)) for value in np.asarray(matrix).ravel())


def pictures(dtype: str = "u1", flips: str = "MF") -> np.ndarray:
    """Black frames with one bright pixel, as a file of this orientation stores them."""
    stack = np.zeros((FRAMES, ROWS, COLUMNS), dtype)
    for n, (column, row) in enumerate(LANDMARKS):
        stack[n, row if flips[1] == "F" else ROWS - 1 - row, column if flips[0] == "M" else COLUMNS - 1 - column] = 100
    return stack


def poses(prefix="Seq_Frame{n:04d}_", probe="ProbeToTracker", with_calibration=True, times=True) -> dict[str, str]:
    """The usual fields of all frames."""
    fields = {}
    for n in range(FRAMES):
        start = prefix.format(n=n)
        if times:
            fields[f"{start}Timestamp"] = repr(10.0 + 0.1 * n)
        fields[f"{start}{probe}Transform"] = numbers(PROBE_TO_TRACKER[n])
        fields[f"{start}{probe}TransformStatus"] = "OK"
        fields[f"{start}ReferenceToTrackerTransform"] = numbers(REFERENCE_TO_TRACKER)
        fields[f"{start}ReferenceToTrackerTransformStatus"] = "OK"
        if with_calibration:
            fields[f"{start}ImageToProbeTransform"] = numbers(IMAGE_TO_PROBE)
            fields[f"{start}ImageToProbeTransformStatus"] = "OK"
    return fields


@dataclass
class Variant:
    """One file: its header lines in order, its pixels, and how they are stored."""

    pixels: np.ndarray = field(default_factory=pictures)
    fields: dict[str, str] = field(default_factory=poses)
    compressed: bool = False
    changes: dict[str, str | None] = field(default_factory=dict)

    def write_mha(self, path):
        payload = zlib.compress(self.pixels.tobytes()) if self.compressed else self.pixels.tobytes()
        header = {
            "ObjectType": "Image",
            "NDims": "3",
            "AnatomicalOrientation": "RAI",
            "BinaryData": "True",
            "BinaryDataByteOrderMSB": "True" if self.pixels.dtype.str[0] == ">" else "False",
            "CompressedData": "True" if self.compressed else "False",
            "CompressedDataSize": str(len(payload)) + "      " if self.compressed else None,
            "DimSize": f"{COLUMNS} {ROWS} {FRAMES}",
            "ElementSpacing": "0.1 7 1",  # Plus does not use it, and neither may anyone else
            "Offset": "5 5 5",
            "Kinds": "domain domain list",
            "ElementType": TYPES[self.pixels.dtype.str[1:]],
            "UltrasoundImageOrientation": "MFA",
            "UltrasoundImageType": "BRIGHTNESS",
            **self.changes,
            **self.fields,
        }
        lines = [f"{key} = {value}\n" for key, value in header.items() if value is not None] + ["ElementDataFile = LOCAL\n"]
        path.write_bytes("".join(lines).encode() + payload)
        return path

    def write_nrrd(self, path):
        payload = gzip.compress(self.pixels.tobytes()) if self.compressed else self.pixels.tobytes()
        header = {
            "type": NRRD_TYPES[self.pixels.dtype.str[1:]],
            "dimension": "3",
            "sizes": f"{COLUMNS} {ROWS} {FRAMES}",
            "kinds": "domain domain list",
            "encoding": "gzip" if self.compressed else "raw",
            "endian": "big" if self.pixels.dtype.str[0] == ">" else "little",
            **self.changes,
        }
        lines = [f"{key}: {value}\n" for key, value in header.items() if value is not None]
        pairs = [f"{key}:={value}\n" for key, value in self.fields.items()]
        path.write_bytes(("NRRD0004\n# from a test\n" + "".join(lines + pairs) + "\n").encode() + payload)
        return path


def landmarks_mm(sequence) -> np.ndarray:
    """Where the brightest pixel of each frame lies in Reference, (frames, 3)."""
    placed = sweep_poses(sequence).image_to_reference
    found = [np.unravel_index(int(np.argmax(sequence.images[n])), (ROWS, COLUMNS)) for n in range(len(sequence))]
    return np.array([(placed[n] @ (column, row, 0.0, 1.0))[:3] for n, (row, column) in enumerate(found)])


def header_transforms() -> dict[str, str]:
    """Calibration and reference as transforms of the whole file."""
    fields = {key: value for key, value in poses(with_calibration=False).items() if "ReferenceToTracker" not in key}
    return {"ImageToProbeTransform": numbers(IMAGE_TO_PROBE), "ReferenceToTrackerTransform": numbers(REFERENCE_TO_TRACKER), **fields}


def rgb() -> np.ndarray:
    return np.repeat(pictures()[..., None], 3, axis=3)


def time_last(kinds: str, size: str, dimensions: str) -> dict[str, str]:
    return {"Kinds": kinds, "DimSize": size, "NDims": dimensions}


FLAT = f"{COLUMNS} {ROWS} {FRAMES}"
DEEP = f"{COLUMNS} {ROWS} 1 {FRAMES}"
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
    with pytest.raises(SequenceFormatError, match=r"did not know it.*--orientation"):
        read_sequence(path)


def test_the_caller_may_know_the_orientation_better(tmp_path):
    path = Variant(pictures(flips="UN"), changes={"UltrasoundImageOrientation": "??"}).write_mha(tmp_path / "sweep.mha")
    np.testing.assert_allclose(landmarks_mm(read_sequence(path, orientation="un")), EXPECTED, atol=1e-9)


def test_an_orientation_that_is_none_is_refused(tmp_path):
    with pytest.raises(SettingsError, match="Input orientation must be MF, MN, UF or UN; got 'left'"):
        read_sequence(Variant().write_mha(tmp_path / "sweep.mha"), orientation="left")


# Slicer's own files

IMAGE_TO_REFERENCE = [np.linalg.inv(REFERENCE_TO_TRACKER) @ pose @ IMAGE_TO_PROBE for pose in PROBE_TO_TRACKER]


def slicer_images(path, *, interleaved=False, color=False, compressed=True, times="10 10.1 10.2", unit="s", matrix=None, **attributes):
    """A volume sequence as Slicer's Sequences module writes it; interleaved as it did before 2022."""
    pixels = rgb() if color else pictures()
    if interleaved:
        pixels = np.moveaxis(pixels, 0, 2)  # (rows, columns, frames[, channels])
    ijk_to_ras = np.eye(4) if matrix is None else matrix
    ijk_to_lps = np.diag([-1.0, -1.0, 1.0, 1.0]) @ ijk_to_ras
    vectors = " ".join(f"({','.join(map(repr, ijk_to_lps[:3, axis].tolist()))})" for axis in range(3))
    axis, channel = (0, "RGB-color ") if interleaved else (3, "RGB-color ")
    blanks = '"" "" ""'
    sizes = f"{FRAMES} {COLUMNS} {ROWS} 1" if interleaved else DEEP
    header = {
        "type": "unsigned char",
        "dimension": "5" if color else "4",
        "space": "left-posterior-superior",
        "sizes": ("3 " if color else "") + sizes,
        "space directions": ("none " if color else "") + (f"none {vectors}" if interleaved else f"{vectors} none"),
        "kinds": (channel if color else "") + ("list domain domain domain" if interleaved else "domain domain domain list"),
        "labels": ('"" ' if color else "") + (f'"time" {blanks}' if interleaved else f'{blanks} "time"'),
        "units": ('"" ' if color else "") + (f'"{unit}" {blanks}' if interleaved else f'{blanks} "{unit}"'),
        "encoding": "gzip" if compressed else "raw",
        "space origin": f"({','.join(map(repr, ijk_to_lps[:3, 3].tolist()))})",
    }
    pairs = {
        "DataNodeClassName": "vtkMRMLVectorVolumeNode" if color else "vtkMRMLScalarVolumeNode",
        f"axis {axis} index type": "numeric",
        f"axis {axis} index values": times,
        **attributes,
    }
    text = "NRRD0005\n# Complete NRRD file format specification at:\n"
    text += "".join(f"{key}: {value}\n" for key, value in header.items())
    text += "".join(f"{key}:={value}\n" for key, value in pairs.items())
    data = pixels.tobytes()
    path.write_bytes((text + "\n").encode() + (gzip.compress(data) if compressed else data))
    return path


def slicer_transforms(path, name="ImageToReference", matrices=IMAGE_TO_REFERENCE, times=(10.0, 10.1, 10.2), statuses=("OK",) * 3):
    """A transform sequence as Slicer's Sequences module writes it: no images, the last line without an end."""
    lines = ["ObjectType = Image", "NDims = 3", "AnatomicalOrientation = RAI", "BinaryData = True", "CompressedData = False"]
    lines += [f"DimSize = 0 0 {len(matrices)}", "ElementSpacing = 1 1 1", "Offset = 0 0 0", "TransformMatrix = 1 0 0 0 1 0 0 0 1"]
    lines += ["ElementType = MET_UCHAR", "Kinds = domain domain list"]
    for n, matrix in enumerate(matrices):
        lines += [f"Seq_Frame{n:04d}_{name}Transform ={numbers(matrix)}", f"Seq_Frame{n:04d}_{name}TransformStatus = {statuses[n]}"]
        if times is not None:
            lines.append(f"Seq_Frame{n:04d}_Timestamp = {times[n]}")
    path.write_text("\n".join([*lines, "ElementDataFile = LOCAL"]))
    return path


@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize("color", [False, True])
@pytest.mark.parametrize("interleaved", [False, True])
def test_a_landmark_in_slicers_sequences_lies_where_it_should(tmp_path, interleaved, color, compressed):
    images = slicer_images(tmp_path / "Image.seq.nrrd", interleaved=interleaved, color=color, compressed=compressed)
    transforms = slicer_transforms(tmp_path / "ImageToReference.seq.mha")
    sequence = read_sequence(images, transform_sequences={"ImageToReference": transforms})
    np.testing.assert_allclose(landmarks_mm(sequence), EXPECTED, atol=1e-9)
    assert [record.timestamp for record in sequence.records] == [10.0, 10.1, 10.2]


def test_a_file_of_one_transform_may_have_any_name_in_it(tmp_path):
    transforms = slicer_transforms(tmp_path / "t.seq.mha", name="LinearTransform_3")
    sequence = read_sequence(slicer_images(tmp_path / "i.seq.nrrd"), transform_sequences={"ImageToReference": transforms})
    np.testing.assert_allclose(landmarks_mm(sequence), EXPECTED, atol=1e-9)


def test_the_volume_nodes_own_geometry_is_part_of_the_pose(tmp_path):
    """In Slicer, a transform acts on what IJKToRAS makes of a pixel."""
    geometry = rigid((0.0, 0.0, 30.0), (7.0, -2.0, 1.0)) @ np.diag([0.25, 0.5, 1.0, 1.0])
    matrices = [pose @ np.linalg.inv(geometry) for pose in IMAGE_TO_REFERENCE]
    images = slicer_images(tmp_path / "i.seq.nrrd", matrix=geometry)
    transforms = slicer_transforms(tmp_path / "t.seq.mha", matrices=matrices)
    sequence = read_sequence(images, transform_sequences={"ImageToReference": transforms})
    np.testing.assert_allclose(landmarks_mm(sequence), EXPECTED, atol=1e-9)
    assert "geometry of their own" in sequence.notes[-1]


def test_transforms_are_taken_at_the_time_of_the_image(tmp_path):
    """The tracker ran at its own rate: poses at 10.0 and 10.2 place the image of 10.1 halfway."""
    ends = [rigid((0, 0, 0), (0, 0, 0)), rigid((0, 0, 40.0), (10.0, 0, 0))]
    transforms = slicer_transforms(tmp_path / "t.seq.mha", name="ProbeToReference", matrices=ends, times=(10.0, 10.2))
    sequence = read_sequence(slicer_images(tmp_path / "i.seq.nrrd"), transform_sequences={"ProbeToReference": transforms})
    found = sequence.records[1].transforms[TransformName("Probe", "Reference")].matrix
    np.testing.assert_allclose(found, rigid((0, 0, 20.0), (5.0, 0, 0)), atol=1e-9)


def test_times_rounded_to_a_millisecond_give_the_very_pose(tmp_path):
    transforms = slicer_transforms(tmp_path / "t.seq.mha", times=(10.0004, 10.1005, 10.1996))
    sequence = read_sequence(slicer_images(tmp_path / "i.seq.nrrd"), transform_sequences={"ImageToReference": transforms})
    assert (sequence.records[1].transforms[TransformName("Image", "Reference")].matrix == IMAGE_TO_REFERENCE[1]).all()


def test_a_pose_that_slicer_calls_invalid_costs_its_frame(tmp_path):
    transforms = slicer_transforms(tmp_path / "t.seq.mha", statuses=("OK", "OK", "INVALID"))
    sequence = read_sequence(slicer_images(tmp_path / "i.seq.nrrd"), transform_sequences={"ImageToReference": transforms})
    assert sequence.records[2].transforms[TransformName("Image", "Reference")].status is TransformStatus.MISSING


def test_without_times_frames_are_paired_by_their_number(tmp_path):
    transforms = slicer_transforms(tmp_path / "t.seq.mha", times=None)
    sequence = read_sequence(slicer_images(tmp_path / "i.seq.nrrd"), transform_sequences={"ImageToReference": transforms})
    np.testing.assert_allclose(landmarks_mm(sequence), EXPECTED, atol=1e-9)
    assert "for lack of times" in sequence.notes[0]


def test_without_times_the_numbers_must_agree(tmp_path):
    transforms = slicer_transforms(tmp_path / "t.seq.mha", matrices=IMAGE_TO_REFERENCE[:2], times=None)
    with pytest.raises(SettingsError, match=r"as many samples of ImageToReference as images.*got 2 for 3 images"):
        read_sequence(slicer_images(tmp_path / "i.seq.nrrd"), transform_sequences={"ImageToReference": transforms})


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
        ("Seq_Frame0001_Timestamp = soon", "frame 1, Timestamp must be a number of seconds; got 'soon'"),
    ],
)
def test_a_damaged_transform_sequence_is_explained(tmp_path, line, expected):
    path = slicer_transforms(tmp_path / "t.seq.mha")
    key = line.split(" =")[0]
    path.write_text("\n".join(line if old.startswith(key + " =") else old for old in path.read_text().split("\n")))
    with pytest.raises(SequenceFormatError, match=expected):
        read_sequence(slicer_images(tmp_path / "i.seq.nrrd"), transform_sequences={"ImageToReference": path})


def test_a_frame_number_beyond_all_limits_is_refused(tmp_path):
    path = slicer_transforms(tmp_path / "t.seq.mha")
    path.write_text(path.read_text().replace("Seq_Frame0002", "Seq_Frame99999999"))
    with pytest.raises(SequenceFormatError, match=r"Seq_Frame99999999_\w+ must belong to a frame below 1000000"):
        read_sequence(slicer_images(tmp_path / "i.seq.nrrd"), transform_sequences={"ImageToReference": path})


def test_an_interleaved_sequence_is_never_in_memory_as_a_whole(tmp_path):
    path = tmp_path / "i.seq.nrrd"
    header = "NRRD0005\ntype: uchar\ndimension: 4\nsizes: 900 200 200 1\nkinds: list domain domain domain\nencoding: gzip\n"
    values = " ".join(map(str, range(900)))
    pixels = np.broadcast_to((np.arange(900) % 251).astype(np.uint8), (200 * 200, 900))
    path.write_bytes(f"{header}axis 0 index type:=numeric\naxis 0 index values:={values}\n\n".encode() + gzip.compress(pixels.tobytes(), 1))
    images = read_sequence(path).images
    tracemalloc.start()
    try:
        assert [int(images[n][150, 199]) for n in (0, 700, 250)] == [0, 700 % 251, 250]
        assert tracemalloc.get_traced_memory()[1] < 3.3 * 2**23  # pieces of 8 MB of a recording of 36 MB
    finally:
        tracemalloc.stop()


def test_a_transform_sequence_given_as_images_says_what_it_is(tmp_path):
    with pytest.raises(SequenceFormatError, match="--transform-sequence"):
        read_sequence(slicer_transforms(tmp_path / "t.seq.mha"))


def test_attributes_of_slicers_frames_are_kept(tmp_path):
    attributes = {"axis 3 item 0001 DICOM.instanceUIDs": "1.2.3", "Operator": "JD"}
    sequence = read_sequence(slicer_images(tmp_path / "i.seq.nrrd", **attributes))
    assert sequence.records[1].fields == {"DICOM.instanceUIDs": "1.2.3"}
    assert sequence.fields["Operator"] == "JD"


def test_slicers_attribute_of_the_orientation_is_honored(tmp_path):
    plain, turned = tmp_path / "plain.seq.nrrd", tmp_path / "turned.seq.nrrd"
    slicer_images(plain)
    slicer_images(turned, **{"Sequences.UltrasoundImageOrientation": "UN"})
    np.testing.assert_array_equal(read_sequence(turned).images[0], read_sequence(plain).images[0][::-1, ::-1])


def test_an_index_in_milliseconds_becomes_seconds(tmp_path):
    path = slicer_images(tmp_path / "i.seq.nrrd", times="0 40 80", unit="ms")
    assert [record.timestamp for record in read_sequence(path).records] == pytest.approx([0.0, 0.04, 0.08])


def test_an_index_that_is_no_time_is_not_taken_for_one(tmp_path):
    sequence = read_sequence(slicer_images(tmp_path / "i.seq.nrrd", times="a%20b c d", unit="mm"))
    assert [record.timestamp for record in sequence.records] == [None] * 3
    assert "not a time (mm)" in sequence.notes[0]


def test_index_values_must_be_one_per_frame(tmp_path):
    with pytest.raises(SequenceFormatError, match=r"axis 3 index values must have one value per frame .3.; got 2"):
        read_sequence(slicer_images(tmp_path / "i.seq.nrrd", times="0 1"))


@pytest.mark.parametrize("compressed", [False, True])
def test_an_interleaved_sequence_that_is_cut_short_is_refused(tmp_path, compressed):
    path = slicer_images(tmp_path / "i.seq.nrrd", interleaved=True, compressed=compressed)
    path.write_bytes(path.read_bytes()[:-9])
    with pytest.raises(SequenceFormatError, match="cut short"):
        read_sequence(path).images[0]
