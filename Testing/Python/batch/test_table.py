"""A table of cases: its columns are the options of four commands, and all that is wrong with it is said with row and column."""

from __future__ import annotations

import pytest
from files import write_patient
from made_recordings import acquisition

from AIFReconLib.batch.columns import Columns
from AIFReconLib.batch.table import read_cases
from AIFReconLib.commands.parser import parser_of
from AIFReconLib.errors import FileFormatError

HEAD = "case,sweeps,config"
ROW = "P1,sweep.igs.mha,PlusDeviceSet.xml"

NO_COLUMN = {
    **dict.fromkeys(("output", "report", "csv", "methods", "surface", "labels_output", "dicom_study"), "results, in a case's folder"),
    **dict.fromkeys(("sequences", "volumes", "sweep"), "recordings and volumes: the column sweeps, and what is made of them"),
    **dict.fromkeys(("save_settings", "against", "memory", "quiet", "verbose", "log", "help", "help_all"), "of a command as a whole"),
}
"""Options that are no columns, and why."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("table")
    write_patient(folder)
    (folder / "empty.mha").touch()
    return folder


def read(folder, text, name="cases.csv", encoding="utf-8"):
    (folder / name).write_bytes(text.encode(encoding))
    return read_cases(folder / name)


def test_every_option_of_the_four_commands_is_a_column_or_has_a_reason_not_to_be():
    options = {option for name in ("reconstruct", "register", "coverage", "evaluate") for option in parser_of(name).declared}
    assert options - set(Columns().names) == set(NO_COLUMN)


def test_a_whole_row_has_nothing_wrong_and_paths_beside_the_table(folder):
    table = read(folder, f"{HEAD},bone-labels,Method,spacing\n{ROW},labels.nrrd,average;weighted,1 1 2\n")
    (case,) = table.cases
    assert table.all_problems == []
    assert case.methods == ("average", "weighted")
    assert case.arguments.sweeps == [folder / "sweep.igs.mha"]
    assert case.arguments.spacing == (1.0, 1.0, 2.0)
    assert folder / "labels.nrrd" in case.inputs


@pytest.mark.parametrize(("delimiter", "encoding"), [(";", "utf-8-sig"), ("\t", "utf-8")])
def test_a_table_as_spreadsheets_save_it_is_read(folder, delimiter, encoding):
    text = f"{HEAD}\n{ROW}\n".replace(",", delimiter).replace("\n", "\r\n")
    assert read(folder, text, encoding=encoding).all_problems == []


@pytest.mark.parametrize(
    ("columns", "cells", "where", "words"),
    [
        ("", "P2,nowhere.mha,PlusDeviceSet.xml", "row 3, sweeps", "no such file"),
        ("", "P2,empty.mha,PlusDeviceSet.xml", "row 3, sweeps", "the file is empty"),
        ("", "P2,,PlusDeviceSet.xml", "row 3, sweeps", "no recording is named"),
        ("", "P2,sweep.igs.mha,PlusDeviceSet.xml;PlusDeviceSet.xml", "row 3, config", "config is given 2 times"),
        ("", "p1,sweep.igs.mha,", "row 3, case", "the name of row 2 too"),
        ("", ",sweep.igs.mha,", "row 3, case", "has no name"),
        ("", "nul,sweep.igs.mha,", "row 3, case", "cannot be the name of a folder"),
        ("", "P2,sweep.igs.mha,,more", "row 3", "more cells than columns"),
        (",spacng", "P2,sweep.igs.mha,,1", "row 1, spacng", "perhaps spacing is meant"),
        (",sweeps", "P2,sweep.igs.mha,,", "row 1, sweeps", "there twice"),
        (",spacing", "P2,sweep.igs.mha,,1 2", "row 3, spacing", "one number or three"),
        (",alpha", "P2,sweep.igs.mha,,0.1 mm", "row 3, alpha", "without a unit"),
        (",method", "P2,sweep.igs.mha,,averge", "row 3, method", "method must be one of average"),
        (",method", "P2,sweep.igs.mha,,weighted", "row 3, method", "needs to know where bone is"),
        (",method", "P2,sweep.igs.mha,,no_such_module:f", "row 3, method", "aifrecon batch --method no_such_module:f too"),
        (",register", "P2,sweep.igs.mha,,perhaps", "row 3, register", "yes or no"),
        (",register", "P2,sweep.igs.mha,,yes", "row 3, register", "under bone_labels"),
        (",accept", "P2,sweep.igs.mha,,yes", "row 3, accept", "under register"),
        (",bone_transform", "P2,sweep.igs.mha,,CTToReference.tfm", "row 3, bone_transform", "Give bone_labels"),
        (",bone_labels,bone_probability", "P2,sweep.igs.mha,,labels.nrrd,labels.nrrd", "row 3, bone_probability", "bone_labels is given"),
        (",beam_thickness", "P2,sweep.igs.mha,,-1", "row 3, beam_thickness", "a number above 0"),
        (",settings", "P2,sweep.igs.mha,,sweep.igs.mha", "row 3, settings", "does not say how it was made"),
        (",bone_from_sweep,speed_of_sound", "P2,sweep.igs.mha,,yes,1480", "row 3, bone_from_sweep", "Leave out speed_of_sound"),
    ],
)
def test_what_is_wrong_is_said_with_row_and_column(folder, columns, cells, where, words):
    said = [str(problem) for problem in read(folder, f"{HEAD}{columns}\n{ROW}\n{cells}\n").all_problems]
    assert [line for line in said if line.startswith(f"{where}: ") and words in line], said


@pytest.mark.parametrize(("data", "words"), [(b"case\n\xff\xfe", "not text in UTF-8"), (b'case\n"P1\n', "cannot be read as CSV")])
def test_a_file_that_is_no_table_is_refused(folder, data, words):
    (folder / "no.csv").write_bytes(data)
    with pytest.raises(FileFormatError, match=words):
        read_cases(folder / "no.csv")


def test_a_recording_may_be_a_folder_whose_files_are_inputs(folder):
    files = sorted(file.name for file in acquisition(folder / "acquired").iterdir())
    (folder / "other").mkdir()
    table = read(folder, "case,sweeps,bone_labels\nP1,acquired,\nP2,other,\nP3,acquired,acquired\n")
    assert table.cases[0].problems == ()
    assert [path.name for path in table.cases[0].inputs] == files
    assert ["this is a folder" in str(problem) for problem in table.all_problems] == [True, True]


def test_a_recording_behind_labels_is_no_folder_of_labels(folder, monkeypatch):
    acquisition(folder / "behind")
    monkeypatch.chdir(folder)
    asked = parser_of("reconstruct").parse(["first.mha", "--bone-labels", ".", "behind", "--output", "v.nrrd"])
    assert [path.name for path in asked.sequences] == ["first.mha", "behind"]
