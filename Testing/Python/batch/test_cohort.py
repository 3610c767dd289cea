"""Cases computed by real workers: what is done, what is not and why, and what a second run does."""

from __future__ import annotations

import csv
import errno
import os
import shutil
from concurrent.futures import BrokenExecutor
from dataclasses import dataclass
from pathlib import Path
from unittest.mock import Mock

import distributed
import pyarrow.parquet as parquet
import pytest
from files import tracked_sequence, write_patient
from worker_tasks import filled

from AIFReconLib import __version__
from AIFReconLib.batch import engine
from AIFReconLib.batch.case import carry_out
from AIFReconLib.batch.cohort import Cohort
from AIFReconLib.batch.engine import LocalExecutor, cluster_at, local_workers
from AIFReconLib.batch.memory import Shares
from AIFReconLib.batch.records import DONE, FAILED, LOST, RECORDS
from AIFReconLib.batch.results import results_table, write_tables
from AIFReconLib.batch.table import read_cases
from AIFReconLib.commands.parser import main
from AIFReconLib.compounding.own.method import load_method
from AIFReconLib.errors import SettingsError

SHARES = Shares(2, 1, 3_000_000_000, 0)
"""What the workers of these tests get."""

HEAD = "case,sweeps,config,bone_labels,bone_transform,bone_sigma_mm,method,spacing,mask,preview"
DEADLY = """
import os
import signal
from pathlib import Path

from AIFReconLib import register_method


@register_method
def deadly(intensity):
    if not Path("{pardon}").exists():
        os.kill(os.getpid(), getattr(signal, "SIGKILL", signal.SIGTERM))
    return 1.0, intensity
"""
"""A method of one's own that ends its process."""


@dataclass
class Lab:
    """A folder of patients, the table of their cases and the folder of their results."""

    folder: Path
    output: Path

    def write(self, *rows: str) -> None:
        (self.folder / "cases.csv").write_text("\n".join([HEAD, *rows]))

    def prepared(self, retry_failed: bool = False) -> Cohort:
        cohort = Cohort(list(read_cases(self.folder / "cases.csv").cases), self.output)
        cohort.prepare(retry_failed)
        return cohort

    def run(self, progress=None, retry_failed: bool = False) -> Cohort:
        cohort = self.prepared(retry_failed)
        cohort.compute(local_workers(SHARES), lambda _: None, progress)
        return cohort

    def states(self, cohort: Cohort) -> dict[str, str]:
        return {name: record.state for name, record in cohort.records.items()}

    def done(self) -> list[str]:
        """Folders of results; whatever else lies about is no whole case."""
        return sorted(path.name for path in self.output.iterdir() if path.name != RECORDS)


def row(name: str, method: str = "average", spacing: str = "1", preview: str = "no") -> str:
    patient = ",".join(f"{name}/{file}" for file in ("sweep.igs.mha", "PlusDeviceSet.xml", "labels.nrrd", "CTToReference.tfm"))
    return f"{name},{patient},1.6,{method},{spacing},yes,{preview}"


@pytest.fixture(scope="module")
def originals(tmp_path_factory):
    folder = tmp_path_factory.mktemp("lab")
    for seed, name in enumerate(("P1", "P2", "P3")):
        (folder / name).mkdir()
        write_patient(folder / name, tracked_sequence(seed=seed), compress=False)
    return folder


@pytest.fixture
def lab(originals, tmp_path):
    lab = Lab(tmp_path / "lab", tmp_path / "results")
    shutil.copytree(originals, lab.folder)
    lab.write(row("P1"), row("P2"), row("P3"))
    return lab


@pytest.fixture(scope="module")
def finished(originals, tmp_path_factory):
    """A lab whose cases were computed by two workers, of which one sweep is cut short."""
    lab = Lab(tmp_path_factory.mktemp("finished") / "lab", tmp_path_factory.mktemp("results"))
    shutil.copytree(originals, lab.folder)
    sweep = lab.folder / "P2" / "sweep.igs.mha"
    sweep.write_bytes(sweep.read_bytes()[:-2000])
    lab.write(row("P1", "average;weighted", preview="yes"), row("P2"), row("P3"), row("P4"))
    said = []
    return lab, lab.run(lambda fraction, message: said.append((fraction, message)) or True), said


# ---- what comes out


def test_a_volume_has_the_bytes_that_the_command_by_hand_writes(finished, tmp_path):
    lab, _, _ = finished
    patient = lab.folder / "P1"
    words = [patient / "sweep.igs.mha", "--config", patient / "PlusDeviceSet.xml", "--bone-labels", patient / "labels.nrrd"]
    words += ["--bone-transform", patient / "CTToReference.tfm", "--bone-sigma-mm", "1.6", "--spacing", "1", "--method", "weighted"]
    words += ["--output", tmp_path / "weighted.nrrd", "--mask", tmp_path / "weighted-mask.nrrd"]
    assert main(["reconstruct", *map(str, words)]) == 0
    for name in ("weighted.nrrd", "weighted-mask.nrrd"):
        assert (lab.output / "P1" / name).read_bytes() == (tmp_path / name).read_bytes()


def test_a_sweep_that_is_cut_short_and_a_missing_file_cost_no_other_case(finished):
    lab, cohort, _ = finished
    assert lab.states(cohort) == {"P1": DONE, "P2": FAILED, "P3": DONE, "P4": FAILED}
    assert "sweep.igs.mha" in cohort.records["P2"].message
    assert "no such file" in cohort.records["P4"].message
    assert lab.done() == ["P1", "P3"]


def test_both_tables_hold_a_row_for_each_case_and_method(finished, tmp_path):
    _, cohort, _ = finished
    write_tables(tmp_path, results_table(cohort.cases, cohort.records))
    with open(tmp_path / "results.csv", newline="", encoding="utf-8") as file:
        text = list(csv.DictReader(file))
    methods = [("P1", "average"), ("P1", "weighted"), ("P2", "average"), ("P3", "average"), ("P4", "average")]
    assert [(each["case"], each["method"]) for each in text] == methods
    table = parquet.read_table(tmp_path / "results.parquet").to_pydict()
    assert table["case"] == [each["case"] for each in text]
    assert [f"{value:.6g}" for value in table["bone_cnr"] if value is not None] == [each["bone_cnr"] for each in text if each["bone_cnr"]]


# ---- a second run


@pytest.mark.parametrize("change", ["input", "settings", "result", "version"])
def test_what_has_changed_is_done_again(finished, lab, monkeypatch, change):
    shutil.copytree(finished[0].output, lab.output)
    for path in lab.folder.rglob("*.*"):
        original = finished[0].folder / path.relative_to(lab.folder)
        shutil.copystat(original, path)
    lab.write(row("P3"))
    assert lab.prepared().to_do == []
    if change == "input":
        os.utime(lab.folder / "P3" / "sweep.igs.mha", ns=(1, 1))
    elif change == "settings":
        lab.write(row("P3", spacing="2"))
    elif change == "result":
        (lab.output / "P3" / "average.nrrd").unlink()
    else:
        monkeypatch.setattr("AIFReconLib.batch.records.__version__", "0.0.1")
    assert [case.name for case in lab.prepared().to_do] == ["P3"]


# ---- what goes wrong outside


def test_a_case_whose_process_is_killed_is_given_up_after_two_tries_and_done_by_the_next_run(lab, monkeypatch, tmp_path):
    monkeypatch.syspath_prepend(lab.folder)
    pardon = tmp_path / "pardon"
    (lab.folder / "deadly_method.py").write_text(DEADLY.format(pardon=pardon.as_posix()))
    load_method("deadly_method:deadly")
    lab.write(row("P1", "deadly_method:deadly"), row("P2"))
    cohort = lab.run()
    assert lab.states(cohort) == {"P1": LOST, "P2": DONE}
    assert "its process was ended twice" in cohort.records["P1"].message
    assert lab.done() == ["P2"]
    pardon.touch()
    cohort = lab.run()
    assert [case.name for case in cohort.to_do] == ["P1"]
    assert cohort.count(DONE) == 2


def test_a_full_disk_is_a_sentence_and_leaves_what_was_there(lab, monkeypatch):
    (case, *_) = read_cases(lab.folder / "cases.csv").cases
    (lab.output / RECORDS).mkdir(parents=True)
    (lab.output / "P1").mkdir()
    (lab.output / "P1" / "before.nrrd").touch()

    with monkeypatch.context() as patched:
        patched.setattr(os, "rename", Mock(side_effect=OSError(errno.ENOSPC, "No space left on device")))
        record = carry_out(case, lab.output)
    assert (record.state, "the disk is full" in record.message) == (LOST, True)
    assert [path.name for path in (lab.output / "P1").iterdir()] == ["before.nrrd"]
    assert lab.done() == ["P1"]
    assert [each.name for each in lab.prepared().to_do] == ["P1", "P2", "P3"]


def test_a_mistake_of_ours_in_one_case_is_said_and_costs_no_other(lab, monkeypatch):
    (case, *_) = read_cases(lab.folder / "cases.csv").cases
    (lab.output / RECORDS).mkdir(parents=True)
    monkeypatch.setattr("AIFReconLib.batch.case.execute", lambda *_, **__: 1 / 0)
    record = carry_out(case, lab.output)
    assert (record.state, "please report it: ZeroDivisionError" in record.message) == (FAILED, True)
    assert lab.done() == []


# ---- the engine


def test_a_process_that_takes_more_than_its_share_is_ended():
    with LocalExecutor(1, memory=600_000_000) as executor:
        assert executor.submit(filled, 10).result().size == 10
        assert isinstance(executor.submit(filled, 200_000_000).exception(), BrokenExecutor)


@pytest.fixture(scope="module")
def address():
    """Of a scheduler of Dask with two workers."""
    with distributed.LocalCluster(2, threads_per_worker=1, host="127.0.0.1", dashboard_address=":0", memory_limit="3GB") as cluster:
        yield cluster.scheduler_address


def test_a_cluster_that_is_there_computes_the_same_bytes(finished, lab, address):
    lab.write(row("P3"), row("P4"))
    cohort = lab.prepared()
    said = []
    cohort.compute(cluster_at(address, lab.folder), said.append)
    assert lab.states(cohort) == {"P3": DONE, "P4": FAILED}
    assert said[0].startswith("2 worker(s)")
    assert (lab.output / "P3" / "average.nrrd").read_bytes() == (finished[0].output / "P3" / "average.nrrd").read_bytes()


@pytest.mark.parametrize(
    ("scheduler", "folder", "version", "says"),
    [
        (None, "", "9.9", r"has AIFRecon .*, and this is 9\.9"),
        (None, "nowhere", __version__, "does not see the folder"),
        ("tcp://127.0.0.1:9", "", __version__, "Dask scheduler"),
        ("nonsense://x", "", __version__, "Dask scheduler"),
    ],
)
def test_a_cluster_that_cannot_be_used_is_refused_in_a_sentence(lab, address, monkeypatch, scheduler, folder, version, says):
    monkeypatch.setattr(engine, "__version__", version)
    monkeypatch.setattr(engine, "SCHEDULER_WAIT", 0.3 if scheduler else engine.SCHEDULER_WAIT)
    with pytest.raises(SettingsError, match=says), cluster_at(scheduler or address, lab.folder / folder):
        pass
