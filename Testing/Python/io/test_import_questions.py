"""What files of images and poses leave open is asked as data: the option that answers, and the answers that are known."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy
from scipy.spatial.transform import Rotation

from AIFReconLib.errors import AIFReconError, SettingsError
from AIFReconLib.inspection.imported import check_import, import_files
from AIFReconLib.io.foreign.options import ImportOptions, answer, questions_of


@pytest.fixture
def images(tmp_path):
    rows, columns = np.indices((60, 80))
    lit = (rows > 10) & (rows < 50) & (columns > 15) & (columns < 65)
    np.save(tmp_path / "images.npy", np.stack([np.where(lit, 60 + 5 * n + (rows + columns) % 30, 0) for n in range(12)]).astype(np.uint8))
    return tmp_path / "images.npy"


def table(images, heading, line):
    path = images.with_name("poses.csv")
    path.write_text("\n".join([heading, *(line.format(n=n, t=20 * n) for n in range(12))]))
    return path


def asked(images, poses, options):
    """The questions that a try ends with, and its words."""
    with pytest.raises(AIFReconError) as error:
        import_files([images], poses, options)
    return questions_of(error.value), str(error.value)


PROBE = "Probe_x,Probe_y,Probe_z,Probe_qx,Probe_qy,Probe_qz,Probe_qw"
IMAGE = ImportOptions(transform="ImageToTracker", spacing=(0.2, 0.2))


TWO_TOOLS = f"{PROBE},{PROBE.replace('Probe', 'Patient')}"
COLUMN_MAJOR = "x,y,z,n0,n1,n2,n3,n4,n5,n6,n7,n8".replace("n", "rot")


@pytest.mark.parametrize(
    ("heading", "line", "name", "choices", "answers"),
    [
        ("x,y,z,rx,ry,rz", "0,0,{n},0,0,0.{n}", "euler_order", ("xyz", "zyx", "XYZ", "ZYX", "vector"), {"euler_order": "vector"}),
        ("time,x,y,z,qx,qy,qz,qw", "{t},0,0,{n},0,0,0,1", "time_unit", ("s", "ms", "us", "100ns", "ns"), {"time_unit": "ms"}),
        (TWO_TOOLS, "0,0,{n},0,0,0,1,0,0,0,0,0,0,1", "tool", ("Probe", "Patient"), {"tool": "Probe"}),
        ("x,y,z,qx,qy,qz,qw,state", "0,0,{n},0,0,0,1,Prima", "status_ok", ("Prima",), {"status_ok": "Prima"}),
        (COLUMN_MAJOR, "0,0,{n},1,0,0,0,1,0,0,0,1", "column_major", ("yes", "no"), {"column_major": "yes"}),
        ("x,y,z,qx,qy,qz,qw", "0,0,0.0{n},0,0,0,1", "units", ("mm", "cm", "m", "in"), {"units": "m"}),
        ("x,y,z,A,B,C", "0,0,{n},0,0,90{n}", "angle_unit", ("deg", "rad"), None),
        ("x,y,z,rotvec_x,rotvec_y,rotvec_z", "0,0,{n},90,0,0", "angle_unit", ("deg", "rad"), None),
    ],
)
def test_each_question_names_its_option_and_the_answers_there_are_and_the_answer_goes_on(images, heading, line, name, choices, answers):
    poses = table(images, heading, line)
    questions, _words = asked(images, poses, IMAGE)
    assert (questions[0].name, questions[0].choices) == (name, choices)
    if answers is None:
        return
    answered = replace(IMAGE, **{each: answer(each, said) for each, said in answers.items()})
    if name == "euler_order":
        assert asked(images, poses, answered)[0][0].name == "angle_unit"
        answered = replace(answered, angle_unit="deg")
    imported = import_files([images], poses, answered)
    assert len(imported.sequence) == 12
    assert check_import(imported, "sweep").drawing is not None


RIGID, TINY = "1 0 0 -32 0 0 -1 12 0 1 0 80 0 0 0 1", "0.0002 0 0 0 0 0.0002 0 0 0 0 0.0002 0 0 0 0 1"


CALIBRATIONS = {
    "without the size of a pixel": (RIGID, {}, "spacing"),
    "in meters": (TINY, {}, "calibration_unit"),
    "with its pixels": (RIGID, {"spacing": (0.2, 0.2)}, None),
    "with its unit": (TINY, {"calibration_unit": "m"}, None),
}


@pytest.mark.parametrize(("matrix", "given", "name"), CALIBRATIONS.values(), ids=CALIBRATIONS)
def test_a_calibration_that_makes_no_image_of_a_probe_is_asked_about(images, matrix, given, name):
    np.save(images, np.tile(np.load(images), (1, 10, 10)))
    (images.with_name("calibration.txt")).write_text(matrix)
    poses = table(images, "time,x,y,z,qx,qy,qz,qw", "0.{n:02d},0,0,{n},0,0,0,1")
    options = ImportOptions(transform="ProbeToTracker", calibration=str(images.with_name("calibration.txt")), **given)
    if name is None:
        (calibration,) = import_files([images], poses, options).sequence.transforms.values()
        np.testing.assert_allclose(np.linalg.norm(calibration.matrix[:3, :2], axis=0), 0.2)
        return
    questions, words = asked(images, poses, options)
    assert questions[0].name == name
    assert "than any probe sees" in words
    questions, words = asked(images, poses, ImportOptions(transform="ImageToTracker"))
    assert [question.name for question in questions] == ["spacing"]
    assert "the size of a pixel is not known" in words


def test_answers_are_read_and_what_is_none_is_a_sentence():
    np.testing.assert_allclose(answer("spacing", "0.2, 0.3"), (0.2, 0.3))
    for name, text in (("spacing", "0.2"), ("spacing", "wide"), ("time_unit", "minutes"), ("rate", "fast")):
        with pytest.raises(SettingsError, match="must be"):
            answer(name, text)


def test_poses_the_wrong_way_round_contradict_the_images(images):
    """A probe that turns to and fro far from the tracker, over speckle that lies still."""
    speckle = scipy.ndimage.gaussian_filter(np.random.default_rng(0).normal(size=(60, 60, 60)), 5.0)
    pixels = np.stack([*np.meshgrid(np.arange(64) * 0.5 - 16, np.arange(64) * 0.5), np.zeros((64, 64))])
    away, frames, lines = Rotation.from_euler("xyz", (40, 20, -70), degrees=True), [], []
    for n in range(48):
        turn = Rotation.from_euler("xyz", (8 * np.sin(n / 4), 6 * np.cos(n / 7), 5 * np.sin(n / 3)), degrees=True)
        at = np.array([30, 20, 30 + 25 * np.sin(n / 9)])
        inside = np.einsum("ij,jrc->irc", turn.as_matrix(), pixels) + at[:, None, None]
        frames.append(128 + 4000 * scipy.ndimage.map_coordinates(speckle, inside, order=1, mode="reflect"))
        lines.append(",".join(map(str, [0.05 * n, *np.add(away.apply(at), (200, -150, 800)), *(away * turn).as_quat()])))
    np.save(images, np.clip(frames, 0, 255).astype(np.uint8))
    poses = images.with_name("poses.csv")
    poses.write_text("\n".join(["time,x,y,z,qx,qy,qz,qw", *lines]))
    right = ImportOptions(transform="ImageToTracker", spacing=(0.5, 0.5), image_origin_px=(32.0, 0.0))
    wrong = replace(right, transform="TrackerToImage")
    import_files([images], poses, right)
    questions, words = asked(images, poses, wrong)
    assert "near each other by its inverse, ImageToTracker" in words
    assert "sure" in [question.name for question in questions]
    import_files([images], poses, replace(wrong, sure=True))
