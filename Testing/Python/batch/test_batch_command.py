"""`aifrecon batch` from its table to its page, in processes of its own; what it refuses; what a page draws."""

from __future__ import annotations

import argparse
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from unittest.mock import Mock

import pytest

from AIFReconLib.batch import engine
from AIFReconLib.batch.memory import OURS, shared_out
from AIFReconLib.batch.page import page
from AIFReconLib.batch.records import DONE, Record
from AIFReconLib.batch.results import results_table
from AIFReconLib.batch.table import Case, read_cases
from AIFReconLib.commands.parser import main


@pytest.fixture
def table(lab):
    return lab / "cases.csv"


def test_what_failed_is_computed_again_where_that_is_asked(table, tmp_path, capsys):
    sweep = tmp_path / "P1" / "sweep.igs.mha"
    sweep.write_bytes(sweep.read_bytes()[:-2000])
    before = []
    for options in ((), (), ("--retry-failed",)):
        assert main(["batch", str(table), "--output", str(tmp_path / "results"), "--workers", "1", *options]) == 1
        before += re.findall(r"\((\d) were before\)", capsys.readouterr().out)
    assert before == ["0", "1", "0"]


def test_a_run_ends_with_tables_and_a_page_and_ctrl_c_with_whole_cases(table, tmp_path):
    results = tmp_path / "results"
    with table.open("a") as file:
        file.writelines(f"Q{n},P1/sweep.igs.mha,P1/PlusDeviceSet.xml,1,no\n" for n in range(400))
    command = [sys.executable, "-m", "AIFReconLib", "batch", table, "--output", results, "--workers", "1"]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(command, start_new_session=True, **pipes) as process:
        while process.poll() is None and len(list(results.glob("[PQ]*/average.nrrd"))) < 2:
            time.sleep(0.05)
        # To all of its processes, as a terminal does
        os.killpg(process.pid, signal.SIGINT) if os.name == "posix" else process.terminate()
        out, err = process.communicate()
    if os.name == "posix":
        assert process.returncode == 130, err
        assert "process(es) with" in err
        assert "Traceback" not in out + err
        # The last one may lie there whole without being known as done; then it is done again
        assert 0 < (results / "results.csv").read_text().count(",done,") <= len(list(results.glob("[PQ]*")))
        assert (results / "index.html").stat().st_size > 0
    assert all((folder / "average.nrrd").is_file() for folder in results.glob("[PQ]*"))


def test_a_dry_run_lists_what_is_wrong_and_writes_nothing(table, tmp_path, capsys):
    table.write_text(table.read_text() + "P2,no.mha,,x,no\n")
    assert main(["batch", str(table), "--output", str(tmp_path / "out"), "--dry-run"]) == 2
    said = capsys.readouterr().out.splitlines()
    assert [line.split(":")[0] for line in said] == ["row 3, spacing", "row 3, sweeps", "2 cases, 1 row(s) with problems"]
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("options", [[], ["--scheduler", "tcp://127.0.0.1:9"]])
def test_without_its_packages_a_sentence_says_how_to_get_them(table, tmp_path, capsys, monkeypatch, options):
    monkeypatch.setattr(engine, "import_module", Mock(side_effect=ImportError))
    assert main(["batch", str(table), "--output", str(tmp_path / "out"), *options]) == 2
    assert 'pip install "dask[distributed]"' in capsys.readouterr().err


# ---- how the computer is shared out


@pytest.mark.parametrize(("cores", "memory", "expected"), [(8, 1e12, (8, 1)), (8, None, (8, 1)), (2, 0.0, (1, 2))])
def test_processes_follow_cores_and_memory(table, monkeypatch, cores, memory, expected):
    cases = list(read_cases(table).cases) * 20
    monkeypatch.setattr("AIFReconLib.batch.memory.usable_cores", lambda: cores)
    monkeypatch.setattr("AIFReconLib.batch.memory.available_memory", lambda: memory)
    shares = shared_out(cases)
    assert (shares.workers, shares.threads) == expected


def test_all_processes_together_get_no_more_than_the_memory_that_is_given(table):
    for workers in (1, 2, 3, 50):
        shares = shared_out(read_cases(table).cases, workers, int(4e9))
        assert shares.workers * shares.memory + OURS <= 4e9


# ---- the page


def table_of(count, **result):
    cases = [Case(f"P{n}", Path(), argparse.Namespace(), ("average",), {}, (), ()) for n in range(count)]
    records = {
        case.name: Record(case.name, DONE, {}, results=[{"method": "average", **result, "frames": n}]) for n, case in enumerate(cases)
    }
    return results_table(cases, records)


def test_a_distribution_shows_every_case_and_the_median():
    table = table_of(7)
    table["bone_cnr"] = [0.0, 1.0, 2.0, 3.0, 8.0, 9.0, 10.0]
    text = page("cases", table)
    [marks] = re.findall(r'class="cases" d="([^"]*)"', text)
    assert marks.count("M") == 7
    assert 'class="number">3.0' in text


@pytest.mark.parametrize("count", [1, 2, 3])
def test_a_distribution_is_drawn_of_cases_enough_to_see_one(count):
    assert ("<svg" in page("cases", table_of(count, bone_cnr=5.0, oblique_cnr=4.0, sweep_met=0.4))) == (count > 2)
