"""Input is data: nothing in it is executed, unpickled or fetched, names another file, or says where to write. Ports are this machine's."""

from __future__ import annotations

import contextlib
import os
import pickle
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from sequence_samples import metaimage, nrrd, ramp

from AIFReconLib.commands.parser import main, parser_of
from AIFReconLib.errors import AIFReconError
from AIFReconLib.io.foreign.openers import open_images
from AIFReconLib.io.plus.configuration import read_plus_configuration
from AIFReconLib.io.plus.importance_mask import configured_importance
from AIFReconLib.io.sequence.files import read_sequence, recording_suffixes
from AIFReconLib.io.volume.files import read_volume
from AIFReconLib.io.volume.label_files import read_labels
from AIFReconLib.live.replay.server import ReplayServer

SECRET = "secret.raw"
EVENTS = ("open", "subprocess.Popen", "os.system", "os.exec", "os.posix_spawn", "os.startfile", "socket.connect", "pickle.find_class")
LISTENERS: list = []


def _hear(event: str, arguments: tuple) -> None:
    for listener in LISTENERS:
        if event in EVENTS:
            listener(event, arguments)


sys.addaudithook(_hear)


@contextmanager
def watched() -> Iterator[list[tuple[str, str]]]:
    """Everything that Python opens, starts, connects to or unpickles inside the block, as (event, first argument)."""
    seen: list[tuple[str, str]] = []

    def listen(event, arguments):
        seen.append((event, str(arguments[0])))

    LISTENERS.append(listen)
    try:
        yield seen
    finally:
        LISTENERS.remove(listen)


def strays(seen: list[tuple[str, str]], folder: Path) -> list[tuple[str, str]]:
    """What was not the opening of a file in `folder` or of a module."""
    inside = ("open",)
    modules = (sys.prefix, sys.base_prefix, str(Path(__file__).resolve().parents[3] / "AIFReconLib"))
    return [
        (event, name)
        for event, name in seen
        if not (event in inside and (name.startswith(str(folder / "inputs")) or name.startswith(modules) or name.isdigit()))
        and not name.startswith(("/proc/meminfo", "/proc/self", "/sys/fs/cgroup"))
    ]


@pytest.fixture
def inputs(tmp_path):
    """A folder of inputs; beside it, not in it, lies a file that nobody named."""
    (tmp_path / SECRET).write_bytes(bytes(24))
    folder = tmp_path / "inputs"
    folder.mkdir()
    if hasattr(os, "mkfifo"):
        (folder / "link.raw").symlink_to("/dev/zero")
        os.mkfifo(folder / "pipe.raw")
    return folder


# ---- a header does not name another file


ELSEWHERE = [
    f"../{SECRET}",
    f"..\\{SECRET}",
    f"./../{SECRET}",
    "/dev/zero",
    "/etc/hostname",
    "C:\\Windows\\win.ini",
    "\\\\server\\share\\x.raw",
    "file:///etc/hostname",
    "http://127.0.0.1/x.raw",
    "pipe:0",
    "LIST",
    "LIST 2",
    "x%03d.raw 1 2 1",
    "link.raw",
    "pipe.raw",
    ".",
]
READERS = [read_sequence, read_volume, read_labels]


@pytest.mark.parametrize("read", READERS)
@pytest.mark.parametrize(
    ("write", "file", "key"), [(metaimage, "s.mhd", "ElementDataFile"), (nrrd, "s.nhdr", "data file"), (nrrd, "s.nhdr", "datafile")]
)
@pytest.mark.parametrize("name", ELSEWHERE)
def test_a_header_names_no_file_elsewhere(inputs, tmp_path, read, write, file, key, name):
    kinds = "domain domain list" if read is read_sequence else "domain domain domain"
    path = write(inputs / file, ramp(), {}, data=b"", **{key: name, "Kinds" if write is metaimage else "kinds": kinds})
    with watched() as seen, pytest.raises(AIFReconError):
        read(path)
    assert strays(seen, tmp_path) == []


def test_a_data_file_beside_the_header_is_read(inputs, tmp_path):
    """The refusals above are not for another reason."""
    (inputs / "data.raw").write_bytes(ramp().tobytes())
    with watched() as seen:
        sequence = read_sequence(metaimage(inputs / "sweep.mhd", ramp(), {}, data=b"", ElementDataFile="data.raw"))
        np.testing.assert_array_equal(np.asarray(sequence.images), ramp())
    assert strays(seen, tmp_path) == []
    assert ("open", str(inputs / "data.raw")) in seen


# ---- a configuration


ENTITIES = {
    "an entity": '<!DOCTYPE a [<!ENTITY b "c">]><PlusConfiguration>&b;</PlusConfiguration>',
    "a file": '<!DOCTYPE a [<!ENTITY b SYSTEM "../secret.raw">]><PlusConfiguration>&b;</PlusConfiguration>',
    "an address": '<!DOCTYPE a SYSTEM "http://127.0.0.1:9/a.dtd"><PlusConfiguration/>',
    "a parameter": '<!DOCTYPE a [<!ENTITY % b SYSTEM "../secret.raw">%b;]><PlusConfiguration/>',
    "laughs": "<!DOCTYPE a ["
    + '<!ENTITY b0 "ha">'
    + "".join(f'<!ENTITY b{n} "{f"&b{n - 1};" * 10}">' for n in range(1, 12))
    + "]><PlusConfiguration>&b11;</PlusConfiguration>",
    "an inclusion": '<PlusConfiguration><xi:include xmlns:xi="http://www.w3.org/2001/XInclude" href="../secret.raw" parse="text"/>'
    "</PlusConfiguration>",
}


@pytest.mark.parametrize("text", ENTITIES.values(), ids=ENTITIES.keys())
def test_what_a_document_names_is_not_fetched(inputs, tmp_path, text):
    path = inputs / "plus.xml"
    path.write_text(text)
    with watched() as seen, contextlib.suppress(AIFReconError):
        read_plus_configuration(path)
    assert strays(seen, tmp_path) == []


@pytest.mark.parametrize(
    "name", ["//server/share/mask.png", "\\\\server\\share\\mask.png", "http://127.0.0.1/mask.png", "file://x/mask.png"]
)
def test_an_importance_mask_is_not_fetched_from_a_network(inputs, name):
    path = inputs / "plus.xml"
    path.write_text(
        f'<PlusConfiguration><VolumeReconstruction CompoundingMode="IMPORTANCE_MASK" ImportanceMaskFilename="{name}"/></PlusConfiguration>'
    )
    with pytest.raises(AIFReconError, match="file of this computer"):
        read_plus_configuration(path)


@pytest.mark.parametrize("suffix", [".mhd", ".nhdr", ".vtk", ".hdr", ".xml", ".h5", ""])
def test_an_importance_mask_of_a_kind_that_names_other_files_is_refused(inputs, suffix):
    path = metaimage(inputs / f"mask{suffix}", ramp()[:1], {}, ElementDataFile=f"../{SECRET}", data=b"")
    (inputs / "plus.xml").write_text(
        f'<PlusConfiguration><VolumeReconstruction CompoundingMode="IMPORTANCE_MASK" ImportanceMaskFilename="{path.name}"/>'
        "</PlusConfiguration>"
    )
    with pytest.raises(AIFReconError, match=r"must be one of \.png"):
        configured_importance(read_plus_configuration(inputs / "plus.xml"))


def test_nothing_in_a_configuration_or_recording_says_where_to_write(patient, results, tmp_path):
    """Every attribute and field that could be taken for a path leads elsewhere; only what the command line names is written."""
    names = ["OutputFilename", "OutputFile", "OutputDirectory", "BaseFilename", "EncodingFilename", "ImportanceMaskFilename", "LogFile"]
    attributes = " ".join(f'{name}="../written-{name}.mha"' for name in names)
    text = patient.config.read_text().replace("<VolumeReconstruction ", f"<VolumeReconstruction {attributes} ")
    patient.config.write_text(text.replace("<PlusConfiguration ", f"<PlusConfiguration {attributes.replace('Importance', 'Other')} "))
    before = set(tmp_path.rglob("*"))
    assert main([*patient.reconstruct, "--output", str(results / "volume.nrrd")]) == 0
    assert main(["convert", str(patient.sweep), str(results / "copy.mha"), "--config", str(patient.config)]) == 0
    assert set(tmp_path.rglob("*")) - before == {results / "volume.nrrd", results / "copy.mha"}


# ---- images


class Harm:
    """Unpickling it would leave a file."""

    def __init__(self, path: Path):
        self.path = path

    def __reduce__(self):
        return (Path.touch, (self.path,))


@pytest.mark.parametrize("bare", [False, True])
def test_an_array_of_objects_and_a_pickle_under_the_name_of_an_array_are_not_unpickled(inputs, tmp_path, bare):
    if bare:
        (inputs / "images.npy").write_bytes(pickle.dumps(Harm(tmp_path / "harm")))
    else:
        np.save(inputs / "images.npy", np.array([Harm(tmp_path / "harm")] * 8, object).reshape(2, 2, 2), allow_pickle=True)
    with watched() as seen, pytest.raises(AIFReconError, match="numpy cannot read it"):
        open_images([inputs / "images.npy"])
    assert [event for event, _ in seen if event.startswith("pickle")] == []
    assert not (tmp_path / "harm").exists()


@pytest.mark.parametrize("suffix", recording_suffixes())
def test_a_pickle_under_the_name_of_a_recording_is_not_unpickled(inputs, tmp_path, suffix):
    path = inputs / f"sweep{suffix}"
    path.write_bytes(pickle.dumps(Harm(tmp_path / "harm")))
    with watched() as seen, pytest.raises(AIFReconError):
        read_sequence(path)
    assert strays(seen, tmp_path) == []
    assert not (tmp_path / "harm").exists()


def test_the_harm_would_be_done_if_it_were_unpickled(tmp_path):
    with watched() as seen:
        pickle.loads(pickle.dumps(Harm(tmp_path / "harm")))
    assert (tmp_path / "harm").exists()
    assert [event for event, _ in seen if event.startswith("pickle")] != []


POSTSCRIPT = b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 8 6\n%%EndComments\nshowpage\n"


def test_postscript_under_the_name_of_a_picture_starts_no_interpreter(inputs, tmp_path):
    pytest.importorskip("PIL", reason="Pillow is not installed")
    (inputs / "frame.png").write_bytes(POSTSCRIPT)
    with watched() as seen, pytest.raises(AIFReconError, match="cannot be read as a picture"):
        open_images([inputs / "frame.png"])
    assert [event for event, _ in seen if event != "open"] == []


@pytest.mark.parametrize(
    "text",
    [
        f"ffconcat version 1.0\nfile ../{SECRET}\n",
        f"#EXTM3U\n#EXT-X-TARGETDURATION:1\n#EXTINF:1,\n../{SECRET}\n#EXT-X-ENDLIST\n",
        "#EXTM3U\n#EXT-X-TARGETDURATION:1\n#EXTINF:1,\nhttp://127.0.0.1:9/a.ts\n#EXT-X-ENDLIST\n",
        "v=0\no=- 0 0 IN IP4 127.0.0.1\ns=x\nc=IN IP4 127.0.0.1\nt=0 0\nm=video 5004 RTP/AVP 96\n",
    ],
)
def test_a_list_under_the_name_of_a_video_is_not_followed(inputs, text):
    pytest.importorskip("imageio_ffmpeg", reason="imageio-ffmpeg is not installed")
    (inputs / "sweep.mp4").write_text(text)
    with pytest.raises(AIFReconError, match="cannot be decoded as a video"):
        open_images([inputs / "sweep.mp4"])


def test_a_decoder_of_videos_may_read_that_file_and_formats_of_videos_alone(inputs, monkeypatch):
    """What ffmpeg is told, where there is none to try it on."""
    told = []
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", SimpleNamespace(get_ffmpeg_exe=lambda: "ffmpeg"))
    monkeypatch.setattr(subprocess, "run", lambda command, **_: told.append(command) or SimpleNamespace(stdout=b"", stderr=b""))
    (inputs / "sweep.mp4").write_bytes(b"")
    with pytest.raises(AIFReconError, match="cannot be decoded as a video"):
        open_images([inputs / "sweep.mp4"])
    (command,) = told
    options = command[: command.index("-i")]
    assert options[options.index("-protocol_whitelist") + 1] == "file"
    assert "concat" not in options[options.index("-format_whitelist") + 1]
    assert command[command.index("-i") + 1].startswith("file:")


# ---- ports


def test_a_server_cannot_be_reached_by_another_address_of_this_machine_unless_told_otherwise(patient):
    assert parser_of("replay").parse(["sweep.mha"]).host == "127.0.0.1"
    server = ReplayServer(read_sequence(patient.sweep, patient.config), port=0, loop=True)
    with server, pytest.raises(OSError), socket.create_connection(("127.0.0.2", server.port), timeout=1):
        pass
