"""What the library notes of its work, and where `--verbose` and `--log` put it."""

from __future__ import annotations

import subprocess
import sys

import pytest

from AIFReconLib.commands.parser import main
from AIFReconLib.terminal.log import FIRST_WORDS


def reconstruct(patient, tmp_path, *options) -> int:
    return main([*patient.reconstruct, "--output", str(tmp_path / "v.nrrd"), *map(str, options)])


# ---- the options


def test_verbose_tells_on_standard_error_what_happens(patient, tmp_path, capsys):
    assert reconstruct(patient, tmp_path, "--verbose") == 0
    said = capsys.readouterr()
    assert "6 of 6 frames by average" in said.err
    assert "frames by average" not in said.out


def test_a_log_holds_the_command_what_happened_and_the_end(patient, tmp_path, capsys):
    log = tmp_path / "log.txt"
    assert reconstruct(patient, tmp_path, "--log", log) == 0
    lines = log.read_text().splitlines()
    assert lines[0] == FIRST_WORDS
    assert "aifrecon reconstruct" in lines[1]
    assert any("AIFReconLib.workflows.reconstruct" in line and "6 of 6 frames" in line for line in lines)
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


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="limits the size of files")
def test_the_work_is_done_although_the_disk_no_longer_takes_the_log(patient, tmp_path):
    limited = (
        "import resource, signal, sys; signal.signal(signal.SIGXFSZ, signal.SIG_IGN);"
        "from AIFReconLib.commands.parser import main; import AIFReconLib.commands.info;"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (40, 40)); sys.exit(main())"
    )
    words = ["info", str(patient.sweep), "--config", str(patient.config), "--log", str(tmp_path / "log.txt")]
    done = subprocess.run([sys.executable, "-c", limited, *words], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def test_a_program_that_asks_for_nothing_is_shown_nothing():
    done = subprocess.run(
        [sys.executable, "-c", "import AIFReconLib, logging; logging.getLogger('AIFReconLib.live').error('not to be seen')"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert (done.stdout, done.stderr) == ("", "")
