"""Results replace results only: whatever else lies in their place is refused before any work, and stays."""

from __future__ import annotations

import os

import pytest

from AIFReconLib.batch import case as module
from AIFReconLib.batch.case import carry_out
from AIFReconLib.batch.page import page
from AIFReconLib.batch.records import DONE, LOST, RECORDS, Record, is_current, read_record
from AIFReconLib.batch.results import results_table
from AIFReconLib.batch.table import read_cases
from AIFReconLib.commands.parser import main

needs_links = pytest.mark.skipif(os.name == "nt", reason="links need rights on Windows")


def first_case(lab):
    return read_cases(lab / "cases.csv").cases[0]


def done(lab, output):
    """Results of the case, as a run leaves them."""
    (output / RECORDS).mkdir(parents=True, exist_ok=True)
    record = carry_out(first_case(lab), output)
    assert record.state == DONE, record.message
    return record


def tree(folder):
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def put(path, is_link=False):
    """Something of the user's own in the place of results."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.symlink_to(path.parents[1]) if is_link else path.write_text("mine")
    return path


def input_of_another_case(lab):
    done(lab, lab / "out")
    with (lab / "cases.csv").open("a") as file:
        file.write("P2,out/P1/average.nrrd,P1/PlusDeviceSet.xml,1,no\n")


def beside_results(lab):
    done(lab, lab / "out")
    put(lab / "out/P1/mine.mrk.json")


FILES = ("P1/notes.txt", "P1/deep/notes.txt", "P1", "index.html", "results.csv", ".batch/P1.json", ".batch")
LINKS = (RECORDS, "P1", "results.csv", ".batch/P1.json", ".batch/P1.json.registration")
IN_THE_WAY = [
    *(pytest.param(output, lambda lab: None, "it holds", id=f"inputs in {output}") for output in (".", "P1", "P1/..")),
    pytest.param("out", input_of_another_case, "an input of P2", id="a result that is an input"),
    pytest.param("out", beside_results, "mine.mrk.json", id="beside results"),
    *(pytest.param("out", lambda lab, n=n: put(lab / "out" / n), n.removesuffix("/notes.txt"), id=f"file {n}") for n in FILES),
    *(
        pytest.param("out", lambda lab, n=n: put(lab / "out" / n, True), n.rpartition("/")[2], id=f"link {n}", marks=needs_links)
        for n in LINKS
    ),
]


@pytest.mark.parametrize("options", [[], ["--dry-run"]], ids=["run", "dry run"])
@pytest.mark.parametrize(("output", "prepare", "words"), IN_THE_WAY)
def test_what_no_run_has_written_is_refused_and_stays(lab, capsys, options, output, prepare, words):
    prepare(lab)
    before = tree(lab)
    assert main(["batch", str(lab / "cases.csv"), "--output", str(lab / output), *options]) == 2
    assert tree(lab) == before
    assert words in capsys.readouterr().err


def test_a_folder_of_results_is_replaced_by_results(lab):
    done(lab, lab / "out")
    (lab / "out" / "P1" / ".DS_Store").touch()
    first = (lab / "out" / "P1" / "average.nrrd").stat().st_ino
    done(lab, lab / "out")
    assert (lab / "out" / "P1" / "average.nrrd").stat().st_ino != first
    assert main(["batch", str(lab / "cases.csv"), "--output", str(lab / "out"), "--dry-run"]) == 0


def test_a_file_that_comes_while_a_case_is_computed_stays(lab, monkeypatch):
    done(lab, lab / "out")
    work = module._Work.results

    def results(self):
        (lab / "out" / "P1" / "mine.txt").write_text("mine")
        return work(self)

    monkeypatch.setattr(module._Work, "results", results)
    record = carry_out(first_case(lab), lab / "out")
    assert (record.state, "mine.txt" in record.message) == (LOST, True)
    assert {path.name for path in (lab / "out" / "P1").iterdir()} == {"average.nrrd", "report.json", "mine.txt"}


def test_results_of_another_run_are_not_taken_for_those_of_a_record(lab):
    record = done(lab, lab / "out")
    assert is_current(record, first_case(lab), lab / "out")
    # As a second batch in the same folder leaves them: the same sizes
    os.utime(lab / "out" / "P1" / "average.nrrd", ns=(1, 1))
    assert not is_current(record, first_case(lab), lab / "out")


# ---- records


@pytest.mark.parametrize("text", ["", "{", "[]", '{"case": "P1", "state": "done", "made_of": {}, "more": 1}'])
def test_a_record_that_is_damaged_is_none(tmp_path, text):
    (tmp_path / RECORDS).mkdir()
    (tmp_path / RECORDS / "P1.json").write_text(text)
    assert read_record(tmp_path, "P1") is None


def test_a_made_up_record_cannot_write_into_the_page(lab):
    evil = "<script>alert(1)</script>"
    result = {
        **dict.fromkeys(("case", "state", "message", "method", "volume", "bone_cnr", "notes"), evil),
        "preview": f"//evil.example/{evil}",
    }
    case = first_case(lab)
    text = page("cases", results_table([case], {"P1": Record("P1", DONE, {}, evil, results=[result])}))
    assert "<script>alert" not in text
    assert 'src="//' not in text
    assert ">P1<" in text
