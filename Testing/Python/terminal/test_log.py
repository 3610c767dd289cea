"""What the library notes of its work, and where `--verbose` and `--log` put it."""

from __future__ import annotations

import logging
import subprocess
import sys
import threading
import time

import pytest
from files import write_patient

from AIFReconLib.commands.parser import COMMANDS, build_parser, main
from AIFReconLib.compounding import engines
from AIFReconLib.live.session.insertion import Inserter
from AIFReconLib.live.wire.client import OpenIGTLinkClient
from AIFReconLib.machine import threads
from AIFReconLib.settings import ReconstructionSettings
from AIFReconLib.terminal.log import FIRST_WORDS

LIBRARY = logging.getLogger("AIFReconLib")


@pytest.fixture
def patient(tmp_path):
    return write_patient(tmp_path)


def reconstruct(patient, tmp_path, *options) -> int:
    return main([*patient.reconstruct, "--output", str(tmp_path / "v.nrrd"), *map(str, options)])


# ---- the options


def test_every_command_has_them():
    choices = build_parser()._subparsers._group_actions[0].choices
    assert list(choices) == list(COMMANDS)
    assert [name for name, parser in choices.items() if not {"--verbose", "--log"} <= set(parser._option_string_actions)] == []


def test_verbose_tells_on_standard_error_what_happens(patient, tmp_path, capsys):
    assert reconstruct(patient, tmp_path, "--verbose") == 0
    said = capsys.readouterr()
    assert "6 of 6 frames by average" in said.err
    assert "frames by average" not in said.out


def test_without_it_nothing_is_told(patient, tmp_path, capsys):
    reconstruct(patient, tmp_path)
    assert capsys.readouterr().err == ""


def test_a_log_holds_the_command_what_happened_and_the_end(patient, tmp_path, capsys):
    log = tmp_path / "log.txt"
    assert reconstruct(patient, tmp_path, "--log", log) == 0
    lines = log.read_text().splitlines()
    assert lines[0] == FIRST_WORDS
    assert "aifrecon reconstruct" in lines[1]
    assert any("AIFReconLib.reconstruction" in line and "6 of 6 frames" in line for line in lines)
    assert lines[-1].endswith("done")
    assert capsys.readouterr().err == ""


def test_a_log_has_the_traceback_of_a_refusal_and_the_terminal_one_line(patient, tmp_path, capsys):
    log = tmp_path / "log.txt"
    patient.sweep.write_bytes(b"nothing of the kind")
    assert reconstruct(patient, tmp_path, "--log", log, "--verbose") == 2
    assert "Traceback" in log.read_text()
    assert capsys.readouterr().err.count("\n") == 1


def test_a_log_is_continued(patient, tmp_path):
    log = tmp_path / "log.txt"
    for _ in range(2):
        reconstruct(patient, tmp_path, "--log", log)
    text = log.read_text()
    assert (text.count(FIRST_WORDS), text.count("aifrecon reconstruct")) == (1, 2)


def test_a_log_of_another_kind_of_file_is_refused_and_the_file_stays(patient, tmp_path, capsys):
    other = tmp_path / "notes.txt"
    other.write_text("do not lose me")
    assert reconstruct(patient, tmp_path, "--log", other) == 2
    assert "is no log" in capsys.readouterr().err
    assert other.read_text() == "do not lose me"
    assert not (tmp_path / "v.nrrd").exists()


@pytest.mark.parametrize("name", ["sweep", "config"])
def test_a_log_is_no_input(patient, tmp_path, name, capsys):
    before = getattr(patient, name).read_bytes()
    assert reconstruct(patient, tmp_path, "--log", getattr(patient, name)) == 2
    assert "reads or writes it" in capsys.readouterr().err
    assert getattr(patient, name).read_bytes() == before


@pytest.mark.parametrize("suffix", [".mhd", ".raw"])
def test_a_log_is_no_output(patient, tmp_path, suffix, capsys):
    words = ["--output", str(tmp_path / "v.mhd"), "--log", str(tmp_path / f"v{suffix}")]
    assert main([*patient.reconstruct, *words]) == 2
    assert "reads or writes it" in capsys.readouterr().err


def test_a_log_that_cannot_be_written_is_one_clear_line(patient, tmp_path, capsys):
    assert reconstruct(patient, tmp_path, "--log", tmp_path / "nowhere" / "log.txt") == 2
    err = capsys.readouterr().err
    assert err.count("\n") == 1
    assert "nowhere" in err
    assert "does not exist" in err


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="limits the size of files")
def test_a_log_that_the_disk_no_longer_takes_is_told_once_and_the_work_is_done(patient, tmp_path):
    limited = (
        "import resource, signal, sys; signal.signal(signal.SIGXFSZ, signal.SIG_IGN);"
        "from AIFReconLib.commands.parser import main; import AIFReconLib.commands.info;"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (40, 40)); sys.exit(main())"
    )
    words = ["info", str(patient.sweep), "--config", str(patient.config), "--log", str(tmp_path / "log.txt")]
    done = subprocess.run([sys.executable, "-c", limited, *words], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr.count("\n")) == (0, 1), done.stderr
    assert "cannot be written any more" in done.stderr


def test_a_log_ends_with_its_command(patient, tmp_path):
    before = LIBRARY.level, LIBRARY.propagate, list(LIBRARY.handlers)
    reconstruct(patient, tmp_path, "--log", tmp_path / "log.txt", "--verbose")
    assert (LIBRARY.level, LIBRARY.propagate, LIBRARY.handlers) == before


def test_a_program_that_asks_for_nothing_is_shown_nothing():
    done = subprocess.run(
        [sys.executable, "-c", "import AIFReconLib, logging; logging.getLogger('AIFReconLib.live').error('not to be seen')"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert (done.stdout, done.stderr) == ("", "")


# ---- what is noted


def test_a_server_that_is_not_there_is_noted_for_every_attempt(caplog):
    client = OpenIGTLinkClient("127.0.0.1", 9, retry_delays=(0.01,))
    with caplog.at_level(logging.INFO, "AIFReconLib"), client:
        deadline = time.monotonic() + 10.0
        while len(caplog.records) < 2 and time.monotonic() < deadline:
            time.sleep(0.01)
    assert {record.name for record in caplog.records} == {"AIFReconLib.live.wire.client"}
    assert all(record.levelno == logging.WARNING and "Connecting again" in record.getMessage() for record in caplog.records[:2])


def test_the_error_of_a_live_thread_is_noted_with_its_traceback(caplog):
    inserter = Inserter(ReconstructionSettings(method="average"), None, 1.0, lambda result, imaging: result)

    def fail():
        raise ZeroDivisionError("as an engine might")

    inserter.start()
    inserter._tasks.append(fail)
    with caplog.at_level(logging.ERROR, "AIFReconLib"):
        inserter.close()
    [record] = caplog.records
    assert record.exc_info[0] is ZeroDivisionError
    assert record.threadName != threading.main_thread().name


def test_an_engine_that_stands_in_is_noted_with_its_reason(caplog, monkeypatch):
    pytest.importorskip("numba")
    monkeypatch.setitem(sys.modules, "AIFReconLib.compounding.compiled.numba_engine", None)
    with caplog.at_level(logging.WARNING, "AIFReconLib"):
        engines.choose_engine("auto")
    [record] = caplog.records
    assert "does not work" in record.getMessage()
    assert record.exc_info


def test_a_compiled_part_that_does_not_work_is_noted(caplog, monkeypatch):
    pytest.importorskip("numba")
    monkeypatch.setitem(sys.modules, "AIFReconLib.bone.numba_map", None)
    with caplog.at_level(logging.WARNING, "AIFReconLib"):
        assert threads.optional_module("AIFReconLib.bone.numba_map") is None
    assert "AIFReconLib.bone.numba_map" in caplog.text


def test_threads_that_the_system_does_not_allow_are_noted(caplog, monkeypatch):
    def refuse(thread):
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(threading.Thread, "start", refuse)
    with caplog.at_level(logging.WARNING, "AIFReconLib"):
        assert not threads.start(threading.Thread(name="helper"))
    assert "no more threads" in caplog.text
