"""Commands whose surroundings are not as they should be: signals, streams, locales, limits on threads and memory, odd names."""

from __future__ import annotations

import errno
import io
import os
import signal
import subprocess
import sys
import threading
from contextlib import suppress
from unittest import mock

import numpy as np
import pytest
from files import refused, tracked_sequence

from AIFReconLib import __main__ as entry
from AIFReconLib.commands import evaluate as evaluate_command
from AIFReconLib.commands import parser as cli
from AIFReconLib.commands.info import _InfoOptions
from AIFReconLib.commands.parser import main
from AIFReconLib.errors import OutputError
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.io.sequence.writer import write_sequence
from AIFReconLib.io.volume.files import check_volume_path, read_volume
from AIFReconLib.live.session.recording import Recorder
from AIFReconLib.terminal.console import ProgressBar
from AIFReconLib.terminal.signals import heard_in_pauses, orderly_end

posix = pytest.mark.skipif(os.name == "nt", reason="POSIX")


def run(arguments, shell="", **environment):
    """A command in a process of its own, called by a shell where it is to lack a stream."""
    command = [sys.executable, "-m", "AIFReconLib", *map(str, arguments)]
    if shell:
        command = ["sh", "-c", '"$@" ' + shell, "sh", *command]
    return subprocess.run(command, capture_output=True, check=False, env={**os.environ, **environment})


# ---- streams


@posix
def test_a_closed_stream_does_not_matter(patient, results):
    assert run([*patient.reconstruct, "--output", results / "v.nrrd"], "<&- >&- 2>&-").returncode == 0
    assert [path.name for path in results.iterdir()] == ["v.nrrd"]


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="there is no /dev/full")
def test_a_result_that_cannot_be_printed_is_said_in_one_line(patient):
    done = run(["info", patient.sweep], ">/dev/full")
    assert done.returncode == 2
    assert done.stderr.decode().count("\n") == 1
    assert b"The result cannot be printed" in done.stderr


def test_a_name_that_the_terminal_cannot_spell_is_shown_with_escapes(patient, results):
    done = run([*patient.reconstruct, "--output", results / "vé.nrrd"], PYTHONIOENCODING="ascii")
    assert (done.returncode, done.stderr) == (0, b"")
    assert rb"v\xe9.nrrd" in done.stdout


def test_a_progress_bar_on_a_terminal_that_is_gone_does_not_stop_the_work():
    gone = mock.Mock(spec=io.StringIO, write=mock.Mock(side_effect=OSError(errno.EIO, "Input/output error")))
    with ProgressBar(gone) as progress:
        assert progress(1.0, "Writing")
    gone.write.assert_called()


def test_files_are_written_before_anything_is_printed(patient, results, monkeypatch, tmp_path):
    assert main([*patient.reconstruct, *patient.bone, "--method", "average", "--output", str(tmp_path / "v.nrrd")]) == 0
    monkeypatch.setattr(evaluate_command, "print", mock.Mock(side_effect=BrokenPipeError), raising=False)
    arguments = ["evaluate", tmp_path / "v.nrrd", "--bone", patient.labels, "--bone-transform", patient.transform]
    assert main([*map(str, arguments), "--csv", str(results / "m.csv")]) == 0
    assert (results / "m.csv").stat().st_size > 0


# ---- signals


@posix
@pytest.mark.parametrize("number", ["SIGTERM", "SIGHUP"])
def test_a_signal_to_end_works_like_ctrl_c(number):
    before = signal.getsignal(getattr(signal, number))
    with orderly_end() as end:
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(getattr(signal, number))
        assert end.exit_code == 128 + getattr(signal, number)
    assert signal.getsignal(getattr(signal, number)) == before


@posix
def test_a_signal_that_the_caller_ignores_stays_ignored():
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)  # as nohup does
    try:
        with orderly_end():
            os.kill(os.getpid(), signal.SIGHUP)
    finally:
        signal.signal(signal.SIGHUP, before)


@posix
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("waits", [True, False])
def test_a_scan_hears_an_interrupt_where_it_holds_nothing(number, waits):
    passed = []
    with orderly_end() as end, suppress(KeyboardInterrupt):
        with heard_in_pauses() as pause:
            pause(0.0)
            signal.raise_signal(number)
            passed.append((end.told, "where it came"))
            if waits:
                pause(0.0)
                passed.append((end.told, "the wait"))
        passed.append((end.told, "the block"))
    assert passed == [(False, "where it came")]
    assert end.exit_code == 128 + number


def test_an_interrupt_that_a_lock_turns_into_another_error_is_one(patient, results, monkeypatch, capsys):
    def waits(*_, **_options):
        lock = threading.Lock()
        with lock:
            lock.release()  # as a wait does; the interrupt comes before it takes it again
            raise KeyboardInterrupt

    monkeypatch.setattr("AIFReconLib.commands.reconstruct.reconstruct_job", waits)
    assert main([*patient.reconstruct, "--output", str(results / "v.nrrd")]) == 130
    assert capsys.readouterr().err == "aifrecon: Interrupted. No file is left half-written.\n"


# ---- limits


def test_a_command_that_needs_threads_says_that_there_are_none(patient, monkeypatch, capsys, results):
    monkeypatch.setattr(threading.Thread, "start", mock.Mock(side_effect=RuntimeError("can't start new thread")))
    assert "no more threads" in refused(["replay", patient.sweep, "--config", patient.config, "--port", "0"], capsys, results)


def test_a_library_that_cannot_be_loaded_is_one_line(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "AIFReconLib.commands.parser", None)
    assert entry.main() == 2
    assert capsys.readouterr().err.startswith("aifrecon: A library cannot be loaded")


def test_ctrl_c_that_an_import_turns_into_another_error_ends_a_command_in_one_line(monkeypatch, capsys):
    def run(asked: _InfoOptions):
        swallowed_and_forgotten()
        raise ImportError("cannot import name")

    monkeypatch.setattr("AIFReconLib.commands.info.run", run)
    assert main(["info", "sweep.mha"]) == 130
    assert capsys.readouterr().err == "aifrecon: Interrupted. No file is left half-written.\n"


def loaded_by(program):
    """The modules that a fresh process has loaded at the end of a program."""
    done = subprocess.run([sys.executable, "-c", f"{program}; import sys; print(*sys.modules)"], capture_output=True, text=True, check=True)
    return set(done.stdout.split())


def test_a_command_starts_with_its_own_file_and_without_libraries_that_it_may_not_need():
    loaded = loaded_by("from AIFReconLib.commands.parser import *; parser_of('info')")
    assert "AIFReconLib.commands.info" in loaded
    assert not loaded & {f"AIFReconLib.commands.{file}" for file, _purpose in cli.COMMANDS.values() if file != "info"}


def swallowed_and_forgotten():
    with suppress(KeyboardInterrupt):
        signal.raise_signal(signal.SIGINT)


def swallowed_and_another_error():
    swallowed_and_forgotten()
    raise SyntaxError("can't load unicodedata module")


@pytest.mark.parametrize("meets", [lambda: signal.raise_signal(signal.SIGINT), swallowed_and_forgotten, swallowed_and_another_error])
def test_ctrl_c_while_the_libraries_load_is_one_line(meets, monkeypatch, capsys):
    class Interrupting:
        def find_spec(self, name, *_):
            if name == "AIFReconLib.commands.parser":
                meets()

    monkeypatch.delitem(sys.modules, "AIFReconLib.commands.parser")
    monkeypatch.delattr("AIFReconLib.commands.parser")
    monkeypatch.setattr(sys, "meta_path", [Interrupting(), *sys.meta_path])
    assert entry.main() == 130
    assert capsys.readouterr().err == "aifrecon: Interrupted. No file is left half-written.\n"
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_running_out_of_memory_is_one_line_with_a_remedy(patient, results, monkeypatch, capsys):
    monkeypatch.setattr("AIFReconLib.commands.reconstruct.reconstruct_job", mock.Mock(side_effect=MemoryError))
    assert "larger --spacing" in refused([*patient.reconstruct, "--output", results / "v.nrrd"], capsys, results)


# ---- names


@posix
@pytest.mark.parametrize("option", ["--output", "--grid-like"])
def test_a_link_that_leads_to_itself_is_no_traceback(patient, results, tmp_path, capsys, option):
    (tmp_path / "loop.nrrd").symlink_to(tmp_path / "loop.nrrd")
    arguments = [*patient.reconstruct, "--output", str(results / "v.nrrd"), option, str(tmp_path / "loop.nrrd")]
    code = main(arguments)
    assert code == (0 if option == "--output" else 2)
    assert capsys.readouterr().err.count("\n") == (code == 2)


@pytest.mark.parametrize("suffix", [".nrrd", ".mhd"])
@pytest.mark.parametrize("name", ["ünïcode 脊椎", "quote' {0}"])
def test_a_volume_goes_into_a_folder_of_any_name(tmp_path, name, suffix):
    folder = tmp_path / f"{name} %s"
    folder.mkdir()
    path = folder / f"{name}{suffix}"
    array = np.arange(24, dtype=np.uint8).reshape(2, 3, 4)
    Volume(array, np.eye(4)).write(path)
    np.testing.assert_array_equal(read_volume(path).array, array)


@pytest.mark.parametrize(
    "write", [check_volume_path, Recorder, lambda path: write_sequence(tracked_sequence(), path)], ids=["volume", "recording", "sequence"]
)
def test_a_data_file_whose_name_others_take_for_a_pattern_is_refused(tmp_path, write):
    with pytest.raises(OutputError, match="percent sign"):
        write(tmp_path / "50%.mhd")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(sys.platform != "linux", reason="other systems have no such names")
def test_a_name_that_is_no_text_is_refused_where_simpleitk_would_end_the_program(patient, results, capsys):
    path = os.fsdecode(os.fsencode(results) + b"/\xff.nrrd")
    assert "not text in UTF-8" in refused([*patient.reconstruct, "--output", path], capsys, results)
