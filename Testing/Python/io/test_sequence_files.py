"""Tracked sequences: what is read from files, and that what is written reads back the same. SimpleITK is the oracle."""

from __future__ import annotations

import numpy as np
import pytest
import SimpleITK as sitk
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from sequence_samples import FIELDS, IDENTITY, assert_same_records, metaimage, nrrd, ramp

from AIFReconLib.errors import OperationCanceled, SequenceFormatError, SettingsError
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample, TransformStatus
from AIFReconLib.io.metafile.opening import read_metafile
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.io.sequence.writer import write_sequence
from AIFReconLib.sweep.frames import FrameRecord, TrackedSequence

PROBE_TO_TRACKER = TransformName("Probe", "Tracker")
SUFFIXES = (".mha", ".mhd", ".nrrd")
REAL_SEQUENCES = ("SpinePhantomFreehand.igs.mha", "BoneUltrasound_L14.igs.mha", "NwirePhantomFreehand.igs.nrrd")


def sequence_of(images: np.ndarray, **parts) -> TrackedSequence:
    return TrackedSequence(images=images, records=parts.pop("records", [FrameRecord() for _ in images]), **parts)


def simpleitk_read(path) -> tuple[np.ndarray, dict[str, str]]:
    """Pixels (frames, rows, columns) and fields as SimpleITK sees them; it takes the list axis of an NRRD for components."""
    image = sitk.ReadImage(str(path))
    array = sitk.GetArrayFromImage(image)
    if image.GetDimension() == 2:
        array = np.moveaxis(array, -1, 0)
    return array, {key: image.GetMetaData(key) for key in image.GetMetaDataKeys() if key.startswith("Seq_")}


def fields_of(path) -> dict[str, str]:
    """Every per-frame field of a sequence as this library reads it, spelled as a header would."""
    return {key: value for key, value in read_metafile(path, SequenceFormatError).fields.items() if key.startswith("Seq_")}


# Reading


WRITE = {".mha": metaimage, ".nrrd": nrrd}
TOLD = {**FIELDS, "Seq_Frame0001_Note": "a = b: c", "Seq_Frame0001_Empty": "", "Seq_Frame0001_Path": r"C:\\new\qed\\"}


@pytest.mark.parametrize("dtype", ["<u1", "<i1", "<u2", ">u2", "<i2", ">i2", "<i4", ">f4", "<f4", ">f8"])
@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize("suffix", WRITE)
def test_pixels_and_fields_equal_what_simpleitk_reads(tmp_path, suffix, compressed, dtype):
    path = WRITE[suffix](tmp_path / f"sweep{suffix}", ramp(dtype), TOLD, compressed=compressed)
    pixels, fields = simpleitk_read(path)
    np.testing.assert_array_equal(np.asarray(read_sequence(path).images), pixels)
    assert fields_of(path) == fields


@pytest.mark.parametrize("name", REAL_SEQUENCES)
def test_a_real_recording_equals_what_simpleitk_reads(real_data, name, tmp_path):
    path = real_data(name)
    pixels, fields = simpleitk_read(path)
    assert fields_of(path) == fields
    sequence = read_sequence(path)
    np.testing.assert_array_equal(np.asarray(sequence.images), pixels)
    if "Nwire" in name:
        write_sequence(sequence, tmp_path / "copy.igs.mha")
        assert_same_records(read_sequence(tmp_path / "copy.igs.mha").records, sequence.records)
        assert sequence.status_counts(TransformName("Stylus", "Tracker")) == {TransformStatus.INVALID: 97}


@pytest.mark.parametrize("name", ["Status", "ImageStatus"])
def test_the_image_status_of_an_nrrd_has_either_name(tmp_path, name):
    path = nrrd(tmp_path / "sweep.nrrd", ramp(), {f"Seq_Frame0001_{name}": "INVALID"})
    assert [record.image_status for record in read_sequence(path).records] == [TransformStatus.OK, TransformStatus.INVALID]


@pytest.mark.parametrize("spelled", ["ultrasound_image_orientation", "UltrasoundImageOrientation"])
def test_an_orientation_that_plus_kept_of_an_older_file_does_not_count(tmp_path, spelled):
    pixels = ramp()
    path = nrrd(tmp_path / "sweep.nrrd", pixels, {"ultrasound image orientation": "UF"}, **{spelled: "MN"})
    np.testing.assert_array_equal(read_sequence(path).images[0], pixels[0, :, ::-1])


@pytest.mark.parametrize("suffix", [".mha", ".nrrd"])
@pytest.mark.parametrize("channels", [3, 4])
@pytest.mark.parametrize("dtype", ["<u1", ">u2", "<f4"])
def test_colors_become_luminance(tmp_path, suffix, channels, dtype):
    pixels = ramp(dtype, channels=channels)
    images = read_sequence(WRITE[suffix](tmp_path / f"sweep{suffix}", pixels)).images
    red, green, blue = (pixels[1, 2, 3, channel].astype(float) for channel in range(3))
    expected = 0.299 * red + 0.587 * green + 0.114 * blue
    assert images[1][2, 3] == (np.rint(expected) if dtype[1] == "u" else np.float32(expected))
    assert images[1].dtype == np.dtype(dtype).newbyteorder("=")


@pytest.mark.parametrize("spelling", [None, "nan", "-nan", "NaN", "-nan(ind)", "1.#QNAN", "-1.#IND00"])
def test_nan_in_a_matrix_is_kept_and_a_status_without_transform_is_one_of_nan(tmp_path, spelling):
    matrix = {"Seq_Frame0000_ProbeToTrackerTransform": IDENTITY.replace("0 0 0 1", f"0 0 {spelling} 1", 1)} if spelling else {}
    fields = {**matrix, "Seq_Frame0000_ProbeToTrackerTransformStatus": "MISSING"}
    found = read_sequence(metaimage(tmp_path / "sweep.mha", ramp(), fields)).records[0].transforms[PROBE_TO_TRACKER]
    assert found.status is TransformStatus.MISSING
    assert np.isnan(found.matrix).sum() == (1 if spelling else 16)


def test_header_transforms_fields_and_a_configuration_hold_for_the_sequence(tmp_path):
    (tmp_path / "plus.xml").write_text("<PlusConfiguration/>", encoding="utf-8")
    fields = {"ImageToProbeTransform": IDENTITY, "Operator": "JD", "UltrasoundImageType": "BRIGHTNESS"}
    sequence = read_sequence(metaimage(tmp_path / "sweep.mha", ramp(), fields), config=tmp_path / "plus.xml")
    assert list(sequence.transforms) == [TransformName("Image", "Probe")]
    assert sequence.fields == {"Operator": "JD"}
    assert sequence.configuration.path == tmp_path / "plus.xml"


# Writing


@pytest.mark.parametrize("code", ["MF", "MN", "UF", "UN"])
@pytest.mark.parametrize("dtype", ["u1", "i1", "u2", "i2", "i4", "f4", "f8"])
@pytest.mark.parametrize("compress", [False, True])
@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_round_trip_keeps_pixels_and_records_and_simpleitk_reads_the_same(tmp_path, suffix, compress, dtype, code):
    original = read_sequence(metaimage(tmp_path / "original.mha", ramp("<" + dtype), UltrasoundImageOrientation=code))
    write_sequence(original, tmp_path / f"copy{suffix}", compress=compress)
    copy = read_sequence(tmp_path / f"copy{suffix}")
    np.testing.assert_array_equal(np.asarray(copy.images), np.asarray(original.images))
    assert copy.images.dtype == original.images.dtype
    assert_same_records(copy.records, original.records)
    pixels, fields = simpleitk_read(tmp_path / f"copy{suffix}")
    np.testing.assert_array_equal(pixels, np.asarray(original.images))
    assert fields == fields_of(tmp_path / f"copy{suffix}")


NUMBERS = st.floats(allow_infinity=False, width=64)
TEXT = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\r\n\0"), max_size=20).map(str.strip)
NAMES = st.from_regex(r"[A-Za-z][A-Za-z0-9 _]{0,12}[a-z0-9]", fullmatch=True)
SAMPLES = st.builds(
    TransformSample,
    st.lists(NUMBERS, min_size=16, max_size=16).map(lambda values: np.array(values).reshape(4, 4)),
    st.sampled_from(list(TransformStatus)),
)
TIMES = st.none() | st.floats(allow_nan=False, allow_infinity=False)
TRANSFORMS = st.dictionaries(st.sampled_from([PROBE_TO_TRACKER, TransformName("Image", "Probe")]), SAMPLES)
RECORDS = st.builds(FrameRecord, TIMES, TIMES, st.sampled_from(list(TransformStatus)), TRANSFORMS, st.dictionaries(NAMES, TEXT, max_size=3))


@settings(max_examples=60, suppress_health_check=list(HealthCheck))
@given(
    records=st.lists(RECORDS, min_size=1, max_size=3),
    fields=st.dictionaries(NAMES, TEXT, max_size=3),
    transforms=TRANSFORMS,
    suffix=st.sampled_from(SUFFIXES),
)
def test_a_round_trip_keeps_every_field_and_every_digit(tmp_path, records, fields, transforms, suffix):
    sequence = sequence_of(ramp(frames=len(records)), records=records, fields=fields, transforms=transforms)
    write_sequence(sequence, tmp_path / f"copy{suffix}", compress=False)
    copy = read_sequence(tmp_path / f"copy{suffix}")
    assert_same_records(copy.records, records)
    assert_same_records([FrameRecord(transforms=copy.transforms)], [FrameRecord(transforms=transforms)])
    assert copy.fields == fields


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_canceling_leaves_nothing_behind(tmp_path, suffix):
    with pytest.raises(OperationCanceled):
        write_sequence(sequence_of(ramp()), tmp_path / f"sweep{suffix}", progress=lambda fraction, _: fraction < 0.5)
    assert list(tmp_path.iterdir()) == []


UNNAMED = FrameRecord(transforms={TransformName("image", "probe"): TransformSample(np.eye(4))})
OF_THREE = FrameRecord(transforms={PROBE_TO_TRACKER: TransformSample(np.eye(3))})
TAKEN = ("", "a\nb", "a=b", "a:b", "a ", "Timestamp", "ImageStatus", "ProbeToTrackerTransform", "ProbeToTrackerTransformStatus")


@pytest.mark.parametrize(
    ("record", "expected"),
    [
        *((FrameRecord(fields={"Note": text}), "one short line") for text in ("a\nDimSize = 1 1 1", "a\rb", "a\0b", "\ud800")),
        *((FrameRecord(fields={name: "1"}), "name") for name in TAKEN),
        (FrameRecord(timestamp=float("nan")), "Timestamp of frame 0 must be a finite number"),
        (UNNAMED, "must be named FromToTo"),
        (OF_THREE, r"must have shape \(4, 4\)"),
    ],
)
@pytest.mark.parametrize("suffix", SUFFIXES)
def test_what_could_not_be_read_back_is_refused(tmp_path, suffix, record, expected):
    with pytest.raises(SettingsError, match=expected):
        write_sequence(sequence_of(ramp(frames=1), records=[record]), tmp_path / f"sweep{suffix}")
