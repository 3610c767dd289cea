"""docs/troubleshooting.md quotes what the program says: each case here brings a message about and looks for it on the page.

Numbers on the page are those of a larger sweep, so numbers do not count.
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from doc_pages import REPOSITORY, blocks, first_column, text_of
from doc_workplace import FRAMES, make_workplace, serve
from sweeps import rigid

from AIFReconLib.commands.parser import main
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample, TransformStatus
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.inspection.offset_estimate import OffsetEstimate
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.io.sequence.writer import write_sequence

PAGE = REPOSITORY / "docs" / "troubleshooting.md"
SWEEP = ["sweep.igs.mha", "--config", "PlusDeviceSet.xml"]
OUTPUT = ["--output", "made.nrrd"]
QUOTED = [line for block in blocks(PAGE) for line in block.text.splitlines()]
"""Every line that the page quotes."""


def without_numbers(text: str) -> str:
    """A line with every number, and every list of frames, made #."""
    text = re.sub(r"\((\d[\d, .-]*)\)", "(#)", " ".join(text.split()))
    return re.sub(r"\d+(\.\d+)?", "#", text)


@pytest.fixture
def here(tmp_path, monkeypatch) -> Path:
    """The files of the page's commands, in the current folder."""
    make_workplace(tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def said(capsys):
    """Runs a command; what it says, line by line, without numbers."""

    def run(*arguments) -> list[str]:
        main([str(argument) for argument in arguments])
        captured = capsys.readouterr()
        return [without_numbers(line) for line in (captured.out + captured.err).splitlines()]

    return run


def quoted(beginning: str) -> str:
    """The one line of the page that begins so, without numbers."""
    (line,) = [line for line in QUOTED if line.strip().startswith(beginning)]
    return without_numbers(line)


def rewrite(folder: Path, statuses=None, move=None) -> None:
    """The sweep of the folder with other statuses of the probe, or its poses moved; a function of the frame's number each."""
    sequence = read_sequence(folder / "sweep.igs.mha")
    name = TransformName("Probe", "Tracker")
    records = []
    for number, record in enumerate(sequence.records):
        matrix = record.transforms[name].matrix
        sample = TransformSample(move(number) @ matrix if move else matrix, statuses(number) if statuses else TransformStatus.OK)
        records.append(replace(record, transforms={**record.transforms, name: sample}))
    write_sequence(replace(sequence, records=records, images=np.asarray(sequence.images)), folder / "sweep.igs.mha")


def blind(number: int) -> TransformStatus:
    return TransformStatus.OUT_OF_VIEW


def far_away(number: int) -> np.ndarray:
    return rigid(translation=(0.0, 0.0, 500.0 * number))


def test_a_recording_without_calibration(here, said):
    assert quoted("aifrecon: sweep.igs.mha: Nothing says where") in said("reconstruct", "sweep.igs.mha", *OUTPUT)


def test_a_recording_that_holds_image_poses_read_with_the_calibration(here, said):
    sequence = read_sequence(here / "sweep.igs.mha")
    pose = TransformSample(rigid(), TransformStatus.OK)
    records = [replace(r, transforms={**r.transforms, TransformName("Image", "Reference"): pose}) for r in sequence.records]
    write_sequence(replace(sequence, records=records, images=np.asarray(sequence.images)), here / "scan.mhd")
    command = ["reconstruct", "scan.mhd", "--config", "PlusDeviceSet.xml", "--spacing", "2", *OUTPUT]
    assert quoted("aifrecon: scan.mhd: Two paths lead") in said(*command)
    assert "wrote made.nrrd" in said(*command, "--image-to-reference", "ImageToReference")


def test_a_tool_that_was_never_seen(here, said):
    rewrite(here, blind)
    assert quoted("aifrecon: sweep.igs.mha: no frame has a position") in said("reconstruct", *SWEEP, *OUTPUT)


def test_a_box_elsewhere(here, said):
    Volume(np.zeros((5, 5, 5), np.uint8), rigid(translation=(2000.0, 0.0, 0.0))).write(here / "elsewhere.nrrd")
    assert quoted("aifrecon: sweep.igs.mha: no frame falls") in said("reconstruct", *SWEEP, "--grid-like", "elsewhere.nrrd", *OUTPUT)


def test_images_and_poses_out_of_step():
    estimate = OffsetEstimate(0.1, 0.005)
    assert quoted("Images and poses are likely") == without_numbers(estimate.to_text())


def test_a_pose_that_jumps(here, said):
    rewrite(here, move=lambda number: rigid(translation=(0.0, 0.0, 0.5 * number + (300.0 if number > 4 else 0.0))))
    assert quoted("The pose jumps faster") in said("info", *SWEEP)


def test_poses_in_meters(here, said):
    header = (here / "poses.csv").read_text("utf-8").splitlines()[0]
    rows = [[0.05 * n, 1, 0, 0, 0.001 * n, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] for n in range(FRAMES)]
    (here / "poses.csv").write_text("\n".join([header, *(",".join(map(str, row)) for row in rows)]), "utf-8")
    poses = ["--poses", "poses.csv", "--transform", "ImageToTracker", "--spacing", "0.4", "0.5"]
    assert quoted("aifrecon: The poses move") in said("import", "frames/", *poses, "--output", "imported.mha")


def test_a_pixel_of_unknown_size(here, said):
    lines = said("import", "frames/", "--poses", "poses.csv", "--transform", "ImageToReference", "--output", "i.mha")
    assert quoted("aifrecon: The poses of ImageToReference are rigid") in lines


def test_a_method_that_lacks_bone(here, said):
    assert quoted("aifrecon: Method weighted needs") in said("reconstruct", *SWEEP, "--method", "weighted", *OUTPUT)


def test_a_ct_in_the_place_of_labels(here, said):
    Volume(np.full((4, 5, 6), -1024, np.int16), np.eye(4)).write(here / "ct.nrrd")
    assert quoted("aifrecon: ct.nrrd: labels must") in said("reconstruct", *SWEEP, "--bone-labels", "ct.nrrd", *OUTPUT)


def test_frames_that_are_skipped(here, said):
    rewrite(here, lambda number: TransformStatus.OUT_OF_VIEW if number in (1, 2, 5) else TransformStatus.OK)
    assert quoted("skipped: 81 frames") in said("reconstruct", *SWEEP, *OUTPUT)


def test_no_server(here, said):
    server = serve(here)
    port = server.port
    server.stop()
    assert quoted("aifrecon: 127.0.0.1 has no server") in said("live", "--port", port, *OUTPUT)


def test_a_port_in_use(here, said):
    server = serve(here)
    try:
        assert quoted("aifrecon: Port 18974 is in use") in said("replay", *SWEEP, "--port", server.port)
    finally:
        server.stop()


def test_a_live_scan_of_a_probe_that_is_not_seen(here, said):
    rewrite(here, blind)
    server = serve(here)
    try:
        assert quoted("aifrecon: Not one of") in said("live", "--port", server.port, "--frames", "9", *OUTPUT)
    finally:
        server.stop()


def test_an_image_device_that_is_not_there(here, said, monkeypatch):
    monkeypatch.setattr("AIFReconLib.commands.live.DEVICE_TIMEOUT", 0.5)
    server = serve(here)
    try:
        assert quoted("aifrecon: The server at") in said("live", "--port", server.port, "--image", "Video", *OUTPUT)
    finally:
        server.stop()


def test_a_volume_too_large_for_memory(here, said):
    rewrite(here, move=far_away)
    assert quoted("aifrecon: A volume of") in said("reconstruct", *SWEEP, "--spacing", "0.01", *OUTPUT)


def test_what_the_panel_says_is_on_the_page():
    rows = re.search(r"^\| The panel says.*\n\|[-| ]+\|\n((?:\|.*\n)+)", text_of(PAGE), flags=re.MULTILINE).group(1).splitlines()
    source = (REPOSITORY / "AIFRecon" / "AIFReconScene" / "inputs" / "readiness.py").read_text("utf-8")
    sayings = set(re.findall(r'_\("([^"]+)"\)', re.sub(r"\{\w+\}", "…", source)))
    assert {row.split("|")[1].strip() for row in rows} - sayings == set()


def said_live() -> str:
    """Everything that live sessions and what they call can say, as written in the sources."""
    rooms = [REPOSITORY / "AIFReconLib" / room for room in ("live", "compounding")]
    return " ".join(path.read_text("utf-8") for room in rooms for path in room.rglob("*.py"))


def test_what_the_live_setup_quotes_is_said():
    quotes = re.findall(r'^\| "([^"]+)"', text_of(REPOSITORY / "docs" / "live-setup.md"), flags=re.MULTILINE)
    pieces = [piece.strip() for quote in quotes for piece in re.split(r"\d+|\.\.\.", quote) if piece.strip()]
    assert len(quotes) >= 8
    assert [piece for piece in pieces if piece not in said_live()] == []


def test_the_words_on_the_screen_are_said():
    """Names of tools and frames are those of the scan."""
    words = first_column(REPOSITORY / "docs" / "live.md", "On the screen")
    pieces = [piece.strip() for word in words for piece in re.split(r"\b[A-Z]\w+\b", word) if len(piece.strip()) > 3]
    assert len(words) >= 9
    assert [piece for piece in pieces if piece not in said_live()] == []


def test_every_message_of_the_page_is_brought_about_here():
    tests = Path(__file__).read_text("utf-8")
    beginnings = re.findall(r'quoted\("([^"]+)"\)', tests)
    assert [line for line in QUOTED if line.strip() and not line.strip().startswith(tuple(beginnings))] == []
