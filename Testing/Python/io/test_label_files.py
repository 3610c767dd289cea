"""Labels in the forms that exist: many in one file, masks of one bone each, surface models."""

from __future__ import annotations

import itertools
import struct
from pathlib import Path

import numpy as np
import pytest
from vtkmodules.vtkCommonCore import vtkPoints, vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkIOLegacy import vtkPolyDataWriter
from vtkmodules.vtkIOPLY import vtkPLYWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

from AIFReconLib.errors import GeometryError, VolumeFormatError
from AIFReconLib.geometry.labels import Labels
from AIFReconLib.geometry.transforms import LPS_FROM_RAS, transform_points
from AIFReconLib.geometry.volume import Volume, VoxelGrid
from AIFReconLib.io.volume.label_files import doubts, read_labels
from AIFReconLib.io.volume.label_names import BONE, SOFT, bone_name, kind_of, name_by_code
from AIFReconLib.io.volume.surfaces import write_surface
from AIFReconLib.message import message_of

# An octahedron beside the origin, so that RAS and LPS differ: |x - 20| + |y - 30| + |z| <= 16
CENTER, RADIUS = np.array([20.0, 30.0, 0.0]), 16.0
POINTS = CENTER + RADIUS * np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)
TRIANGLES = np.array([[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]])


def wrong_voxels(labels: Volume) -> int:
    """How many lie on the other side of the surface; those whose center is in it may lie on either."""
    kji = np.argwhere(np.ones(labels.shape, bool))
    depth = RADIUS - np.abs(transform_points(labels.ijk_to_reference, kji[:, ::-1].astype(float)) - CENTER).sum(axis=1)
    return int((((depth > 0) != (labels.array.ravel() > 0)) & (np.abs(depth) > 1e-3)).sum())


def stl(points: np.ndarray, header: bytes) -> bytes:
    facets = b"".join(struct.pack("<12fH", 0, 0, 0, *points[corners].ravel(), 0) for corners in TRIANGLES)
    return header.ljust(80)[:80] + struct.pack("<I", len(TRIANGLES)) + facets


def ascii_stl(points: np.ndarray) -> bytes:
    facets = "".join(
        "facet normal 0 0 0\nouter loop\n" + "".join("vertex {} {} {}\n".format(*points[c]) for c in corners) + "endloop\nendfacet\n"
        for corners in TRIANGLES
    )
    return f"solid SPACE=RAS\n{facets}endsolid\n".encode()


def obj(points: np.ndarray) -> bytes:
    rows = ["# SPACE=RAS", *("v {} {} {}".format(*p) for p in points), "vn 0 0 1", "vt 0 0"]
    # As programs write them: corners alone, with texture and normal, with a normal, counted from the end
    forms = ("{0}", "{0}/1/1", "{0}//1", "{1}")
    for number, corners in enumerate(TRIANGLES):
        rows.append("f " + " ".join(forms[number % 4].format(corner + 1, corner - 6) for corner in corners))
    return "\n".join(rows).encode()


MODELS = {
    "binary.stl": stl(POINTS, b"Slicer SPACE=RAS"),
    "lps.stl": stl(transform_points(LPS_FROM_RAS, POINTS), b"Slicer SPACE=LPS"),
    "text.stl": ascii_stl(POINTS),
    "faces.obj": obj(POINTS),
}


def vtk_surface(points: np.ndarray, space: str | None) -> vtkPolyData:
    """As Slicer hands it to VTK's writers: a field tells its space."""
    places, cells, surface = vtkPoints(), vtkCellArray(), vtkPolyData()
    for point in points:
        places.InsertNextPoint(point)
    for corners in TRIANGLES:
        cells.InsertNextCell(3, corners.tolist())
    surface.SetPoints(places)
    surface.SetPolys(cells)
    if space is not None:
        field = vtkStringArray()
        field.SetName("SPACE")
        field.InsertNextValue(space)
        surface.GetFieldData().AddArray(field)
    return surface


VTK_FORMS = {
    "binary.vtp": lambda writer, _: writer.SetDataModeToBinary(),
    "raw.vtp": lambda writer, _: writer.EncodeAppendedDataOff(),
    "binary.vtk": lambda writer, _: writer.SetFileTypeToBinary(),
    "header.vtk": lambda writer, space: writer.SetHeader(f"3D Slicer output. SPACE={space}"),
    "little.ply": lambda writer, space: (writer.SetDataByteOrderToLittleEndian(), writer.AddComment(f"SPACE={space}")),
}
WRITERS = {".vtp": vtkXMLPolyDataWriter, ".vtk": vtkPolyDataWriter, ".ply": vtkPLYWriter}


def written_by_vtk(path: Path, space: str) -> None:
    points = POINTS if space == "RAS" else transform_points(LPS_FROM_RAS, POINTS)
    writer = WRITERS[path.suffix]()
    VTK_FORMS[path.name](writer, space)
    writer.SetInputData(vtk_surface(points, None if path.name == "header.vtk" else space))
    writer.SetFileName(str(path))
    writer.Write()


@pytest.mark.parametrize(("name", "space"), [*((name, "") for name in MODELS), *itertools.product(VTK_FORMS, ("RAS", "LPS"))])
def test_a_model_becomes_the_voxels_within_it_in_the_space_that_it_states_however_it_is_stored(name, space, tmp_path):
    if space:
        written_by_vtk(tmp_path / name, space)
    else:
        (tmp_path / name).write_bytes(MODELS[name])
    labels = read_labels(tmp_path / name)
    assert wrong_voxels(labels) == 0
    assert labels.names == {1: name.split(".")[0]}
    assert not labels.space_is_guessed
    assert not labels.notes


LONG_NAME = MODELS["text.stl"].replace(b"SPACE=RAS", b"SPACE=RAS " + b"x" * 250).replace(b"endsolid", b"endsolid " + b"x" * 250)
STRANGE_STL = {
    "many bytes behind": MODELS["binary.stl"] + b"\0" * 600,
    "capitals": MODELS["text.stl"].upper(),
    "a long name": LONG_NAME,
    "binary that begins with solid": b"solid of a program" + MODELS["binary.stl"][18:],
}


@pytest.mark.parametrize("data", STRANGE_STL.values(), ids=STRANGE_STL)
def test_what_does_not_belong_to_the_triangles_of_an_stl_is_no_damage(data, tmp_path):
    (tmp_path / "L3.stl").write_bytes(data)
    assert wrong_voxels(read_labels(tmp_path / "L3.stl", space="ras")) == 0


MOVED, INNER = np.array([6.0, 2.0, 0.0]), CENTER + (POINTS - CENTER) / 3
BACKWARD = TRIANGLES[:, ::-1]


MIXED = np.concatenate([TRIANGLES[:4], BACKWARD[4:]])
BODIES = {
    "overlapping": ([(POINTS, TRIANGLES), (POINTS + MOVED, TRIANGLES)], True, False),
    "both inside out": ([(POINTS, BACKWARD), (POINTS + MOVED, BACKWARD)], True, False),
    "one mirrored": ([(POINTS, TRIANGLES), (POINTS + MOVED, BACKWARD)], True, False),
    "one in the other": ([(POINTS, TRIANGLES), (INNER, TRIANGLES)], False, False),
    "a cavity": ([(POINTS, TRIANGLES), (INNER, BACKWARD)], False, True),
    "triangles not alike": ([(POINTS, MIXED)], False, False),
}


@pytest.mark.parametrize(("bodies", "moved_too", "hollow"), BODIES.values(), ids=BODIES)
def test_bodies_of_a_model_are_united_and_cavities_stay(bodies, moved_too, hollow, tmp_path):
    triangles = np.concatenate([triangles + len(POINTS) * number for number, (_, triangles) in enumerate(bodies)])
    write_surface(tmp_path / "L3.vtp", np.concatenate([points for points, _ in bodies]), triangles)
    labels = read_labels(tmp_path / "L3.vtp")
    kji = np.argwhere(np.ones(labels.shape, bool))
    places = transform_points(labels.ijk_to_reference, kji[:, ::-1].astype(float))
    depth, moved = (RADIUS - np.abs(places - center).sum(axis=1) for center in (CENTER, CENTER + MOVED))
    depth = np.maximum(depth, moved) if moved_too else np.minimum(depth, RADIUS * 2 / 3 - depth) if hollow else depth
    sure = np.abs(depth) > 1e-3
    np.testing.assert_array_equal((labels.array.ravel() > 0)[sure], (depth > 0)[sure])


@pytest.mark.parametrize(("unit", "said", "mm"), [("cm", "cm", 10.0), ("m", "meters", 1000.0), ("in", "inches", 25.4)])
def test_a_model_that_is_hardly_in_mm_is_asked_for_its_unit(unit, said, mm, tmp_path):
    (tmp_path / "L3.stl").write_bytes(stl(POINTS / mm, b"RAS"))
    with pytest.raises(VolumeFormatError, match=f"hardly bone in mm.*; in {said} it would be 32 mm.*unit="):
        read_labels(tmp_path / "L3.stl")
    assert wrong_voxels(read_labels(tmp_path / "L3.stl", unit=unit)) == 0


def test_a_model_that_does_not_say_its_space_is_a_guess_until_it_is_said(tmp_path):
    (tmp_path / "L3.stl").write_bytes(stl(transform_points(LPS_FROM_RAS, POINTS), b"no word"))
    guessed, said = read_labels(tmp_path / "L3.stl"), read_labels(tmp_path / "L3.stl", space="lps")
    assert (guessed.space_is_guessed, said.space_is_guessed) == (True, False)
    assert "RAS or LPS" in guessed.notes[0]
    assert wrong_voxels(guessed) == wrong_voxels(said) == 0
    told = guessed.told_by(VoxelGrid.from_spacing(POINTS.min(axis=0) - 5, (15, 15, 15), 3.0))
    assert not told.space_is_guessed
    assert told.notes[-1].endswith("it is taken to be in LPS, where it lies in the volume.")


def test_a_ct_among_masks_is_left_out(tmp_path):
    with pytest.raises(VolumeFormatError, match="holds no labels"):
        read_labels(tmp_path)
    Volume(np.pad(np.ones((2, 2, 2), np.uint8), 2), np.eye(4)).write(tmp_path / "vertebrae_L3.nrrd")
    Volume(np.full((6, 6, 6), -1000, np.int16), np.eye(4)).write(tmp_path / "ct.nrrd")
    labels = read_labels(tmp_path)
    assert labels.names == {1: "L3"}
    assert "ct.nrrd is no mask and left out" in labels.notes[0]


@pytest.mark.parametrize(
    ("name", "data", "words"),
    [
        ("cut.stl", MODELS["binary.stl"][:-20], "cut short"),
        ("cut text.stl", MODELS["text.stl"][:-150], "cut short: no endsolid"),
        ("beyond.obj", b"v 0 0 0\nv 1 0 0\nf 1 2 9\n", "not all there"),
        ("open.stl", stl(POINTS, b"RAS")[:80] + struct.pack("<I", 6) + stl(POINTS, b"RAS")[84 : 84 + 300], "not leave it again"),
        ("empty.obj", b"v 0 0 0\n", "no triangles"),
        ("not.vtp", b"<VTKFile", "cannot be read as a surface model"),
    ],
)
def test_a_model_that_cannot_be_used_is_refused_in_a_sentence(name, data, words, tmp_path):
    (tmp_path / name).write_bytes(data)
    with pytest.raises(VolumeFormatError, match=words):
        read_labels(tmp_path / name)


# ---- numbers and names


def column(first: int, step: int, count: int = 4, extra: dict[int, tuple[int, int, int]] | None = None) -> Labels:
    """Cubes above each other, 30 mm apart, whose numbers rise toward the head; others where they are said to be."""
    array = np.zeros((150, 40, 60), np.uint8)
    for n in range(count):
        array[10 + 30 * n : 30 + 30 * n, 10:30, 20:40] = first + step * n
    for number, (k, j, i) in (extra or {}).items():
        array[k : k + 12, j : j + 8, i : i + 15] = number
    return Labels(array, np.eye(4))


DOWN, UP = ["L5", "L4", "L3", "L2"], ["L4", "L3", "L2", "L1"]
PROGRAMS = {
    "TotalSegmentator": (column(27, 1, extra={52: (0, 0, 0), 5: (100, 0, 0)}), dict(zip(range(27, 31), DOWN)), "5, 52"),
    "TotalSegmentator 1": (column(18, 1, extra={7: (0, 0, 0)}), dict(zip(range(18, 22), DOWN)), "7"),
    "VerSe": (column(23, -1), dict(zip(range(23, 19, -1), UP)), None),
    "TotalSpineSeg, with discs and the canal": (
        column(44, -1, extra={91: (30, 10, 20), 92: (60, 10, 20), 2: (0, 0, 0)}),
        dict(zip(range(44, 40, -1), UP)),
        "2, 91, 92",
    ),
    "vertebrae_mr": (column(13, 1), {13: "T6", 14: "T5", 15: "T4", 16: "T3"}, None),
    "SPIDER": (column(1, 1, extra={100: (0, 0, 0), 202: (30, 10, 20)}), dict(zip(range(1, 5), DOWN)), "100, 202"),
    "SPINEPS": (column(23, -1, extra={122: (30, 10, 20)}), dict(zip(range(23, 19, -1), UP)), "122"),
    "own, downward": (column(4, -1), {}, None),
    "own, upward": (column(1, 1), {}, None),
    "one alone": (column(29, 1, count=1), {}, None),
}


@pytest.mark.parametrize(("labels", "names", "left_out"), PROGRAMS.values(), ids=PROGRAMS)
def test_vertebrae_are_known_by_the_numbers_of_their_program(labels, names, left_out, tmp_path):
    labels.write(tmp_path / "labels.nii.gz")
    found = read_labels(tmp_path / "labels.nii.gz")
    assert found.names == names
    assert [note.rpartition(": ")[2] for note in found.notes] == ([f"{left_out}."] if left_out else [])
    kept = np.isin(labels.array, [*names]) if left_out else True
    np.testing.assert_array_equal(found.array, np.where(kept, labels.array, 0))


ASKED = {
    "numbers of nobody": (column(229, 7), {}, "What its labels 229, 236, 243, 250 are is not said"),
    "a name beside a bone": (column(1, 1, count=2), {1: "L3", 2: "ganz unten"}, "Labels ganz unten may be bone or not"),
    "no bone": (column(1, 1, count=2), {1: "aorta", 2: "psoas_major_left"}, "None of its labels is bone by their names"),
}


@pytest.mark.parametrize(("labels", "names", "message"), ASKED.values(), ids=ASKED)
def test_what_cannot_be_told_is_asked_once_and_labels_answer(labels, names, message, tmp_path):
    fields = "".join(f"Segment{n}_Name:={name}\nSegment{n}_LabelValue:={n}\nSegment{n}_Layer:=0\n" for n, name in names.items())
    file = tmp_path / "labels.seg.nrrd"
    labels.write(file)
    head, data = file.read_bytes().split(b"\n\n", 1)
    file.write_bytes(head + b"\n" + fields.encode() + b"\n" + data)
    with pytest.raises(GeometryError, match=f"labels.seg.nrrd: {message}.*labels=") as error:
        read_labels(file)
    assert message_of(error.value).settings == ("labels",)
    number = int(labels.numbers()[0])
    assert read_labels(file, labels=str(number)).numbers().tolist() == [number]


TERMS = [
    ("Segment_1", "~SCT^123037004^Anatomical Structure~SCT^36470004^Wirbel~^^~", "vertebrae_L3"),
    ("Segment_1", "~SRT^T-D0005^Anatomical Structure~SRT^T-11640^L4 vertebra~^^~", "L4 vertebra"),
    ("Segment_1", "~SCT^123037004^Anatomical Structure~SCT^244849004^Deep muscle of back~^^~", "deep muscle of back"),
    ("Segment_1", "~SCT^85756007^Tissue~SCT^85756007^Tissue~^^~", "Segment_1"),
    ("L2", "~SCT^85756007^Tissue~SCT^36470004^L3 vertebra~^^~", "L2"),
]


def test_a_segment_of_slicer_is_called_by_its_name_or_its_terminology():
    start = "Segmentation.Status:inprogress|TerminologyEntry:General Anatomy list"
    assert [name_by_code(name, f"{start}{tags}|") for name, tags, _ in TERMS] == [shown for _, _, shown in TERMS]


def test_labels_are_chosen_by_number_by_name_and_by_the_name_that_their_program_gives(tmp_path):
    labels = column(27, 1)
    named = Labels(labels.array, labels.ijk_to_reference, {}, {27: "L5", 28: "L4"})
    assert named.chosen("28-99, l5").numbers().tolist() == [27, 28, 29, 30]
    assert named.chosen("L4").numbers().tolist() == [28]
    with pytest.raises(GeometryError, match=r"No label is called 'L1'. There are 27 \(L5\), 28 \(L4\), 29, 30."):
        named.chosen("L1")
    for count in (4, 1):
        column(27 if count > 1 else 29, 1, count=count).write(tmp_path / "labels.nii.gz")
        for choice in ("L3", "vertebrae_L3", "l3"):
            assert read_labels(tmp_path / "labels.nii.gz", labels=choice).names == {29: "L3"}


KINDS = {
    BONE: "vertebrae_body L3 hip_left bone rib_left_1 skull sternum LeftFemur Arcus_Vertebrae Th12",
    SOFT: "aorta autochthon_left spinal_cord kidney_cyst_left costal_cartilages heart hip_implant intervertebral_discs "
    "paravertebral_muscles vertebral_artery disc_L4_L5 levator_scapulae_left erector_spinae_left quadratus_lumborum_left",
    None: "Segment_1 mask discovery ribbon",
}
SHORT = {"vertebrae_L3": "L3", "L3": "L3", "L3 vertebra": "L3", "vertebra_T12": "T12", "sacrum": "sacrum", "rib_left_3": "rib_left_3"}


def test_names_tell_by_whole_words_and_that_of_a_vertebra_is_short():
    for kind, names in KINDS.items():
        assert {name: kind_of(name) for name in names.split()} == dict.fromkeys(names.split(), kind)
    assert {name: bone_name(name) for name in SHORT} == SHORT


def folder_of_masks(folder: Path, labels: Labels, names: dict[int, str]) -> Path:
    folder.mkdir()
    for number, name in names.items():
        Volume((labels.array == number).astype(np.uint8), labels.ijk_to_reference).write(folder / f"{name}.nii.gz")
    return folder


def test_a_folder_of_masks_is_a_bone_each_and_a_name_that_says_nothing_is_asked_about(tmp_path):
    labels = column(27, 1, extra={52: (0, 0, 0)})
    names = {27: "vertebrae_L5", 28: "vertebrae_L4", 29: "vertebrae_L3", 99: "vertebrae_L2", 52: "aorta"}
    found = read_labels(folder_of_masks(tmp_path / "segmentations", labels, names))
    # In the order of the files; the mask of what is not in the CT is empty
    assert found.names == {1: "L3", 2: "L4", 3: "L5"}
    assert found.notes == ("1 files are no bone by their names and left out: aorta.",)
    np.testing.assert_array_equal(found.array == 2, labels.array == 28)
    folder = folder_of_masks(tmp_path / "masks", labels, {27: "vertebrae_L5", 28: "thing"})
    with pytest.raises(GeometryError, match="its files thing may be bone or not"):
        read_labels(folder)
    assert read_labels(folder, labels="L5").names == {2: "L5"}


def test_a_file_of_many_labels_in_a_folder_keeps_its_bones(tmp_path):
    labels = column(24, -1)
    labels.write(folder_of_masks(tmp_path / "verse", labels, {}) / "sub-x004_seg-vert_msk.nii.gz")
    assert list(read_labels(tmp_path / "verse").names.values()) == ["L2", "L3", "L4", "L5"]
    assert read_labels(tmp_path / "verse", labels="L3").numbers().tolist() == [22]
    masks = folder_of_masks(tmp_path / "both", labels, {24: "vertebrae_L5", 23: "vertebrae_L4"})
    labels.write(masks / "all.nii.gz")
    found = read_labels(masks)
    assert found.names == {1: "L4", 2: "L5", 3: "L2", 4: "L3"}
    assert found.notes == ("2 bones of all.nii.gz lie where other files have theirs, and are left out.",)


def test_masks_on_other_voxels_meet_where_they_lie(tmp_path):
    shift = np.eye(4)
    shift[:3, 3] = 3.0, -2.0, 40.0
    one = np.zeros((20, 20, 20), np.uint8)
    one[5:15, 5:15, 5:15] = 1
    Volume(one, np.eye(4)).write(tmp_path / "L4.nrrd")
    Volume(one[::-1], shift @ np.diag([0.5, 1.0, 1.0, 1.0])).write(tmp_path / "L3.nrrd")
    found = read_labels([tmp_path / "L4.nrrd", tmp_path / "L3.nrrd"])
    assert found.names == {1: "L4", 2: "L3"}
    for number, low, high in ((1, (5, 5, 5), (14, 14, 14)), (2, (5.5, 3, 45), (10, 12, 54))):
        places = transform_points(found.ijk_to_reference, np.argwhere(found.array == number)[:, ::-1].astype(float))
        np.testing.assert_allclose(places.min(axis=0), low, atol=0.51)
        np.testing.assert_allclose(places.max(axis=0), high, atol=0.51)


def test_what_is_too_thick_or_too_soft_or_upside_down_is_doubted(tmp_path):
    labels = column(1, 1, count=2)
    assert doubts(labels) == []
    ct = Volume(np.where(labels.array == 1, 400, 50).astype(np.int16), np.eye(4))
    assert doubts(labels, ct) == ["label 2 is soft in the CT: nine tenths of it are below 50 HU. Is it bone?"]
    assert "thick" in doubts(Labels(np.pad(np.ones((70,) * 3, np.uint8), 5), np.eye(4)))[0]
    column(30, -1, extra={52: (0, 0, 0)}).write(tmp_path / "labels.nii.gz")
    assert any("lies above" in note for note in read_labels(tmp_path / "labels.nii.gz").notes)
