"""docs/troubleshooting.md quotes what the program says: each case here brings a message about and looks for it on the page.

Numbers on the page are those of a larger sweep, so numbers do not count.
"""

from __future__ import annotations

import re
from dataclasses import replace
from functools import partial
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
SWEEP = "sweep.igs.mha --config PlusDeviceSet.xml"
OUTPUT = "--output made.nrrd"
QUOTED = [line for block in blocks(PAGE) for line in block.text.splitlines()]
"""Every line that the page quotes."""


def without_numbers(text: str) -> str:
    """A line with every number, and every list of frames, made #."""
    text = re.sub(r"\((\d[\d, .-]*)\)", "(#)", " ".join(text.split()))
    return re.sub(r"\d+(\.\d+)?", "#", text)


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


def moved(millimeters):
    """Poses so far along z, by the number of their frame."""
    return partial(rewrite, move=lambda number: rigid(translation=(0.0, 0.0, millimeters(number))))


def as_it_is(folder: Path) -> None:
    """The files of the page's commands."""


BLIND = partial(rewrite, statuses=lambda number: TransformStatus.OUT_OF_VIEW)
AT_TIMES_BLIND = partial(rewrite, statuses=lambda number: TransformStatus.OUT_OF_VIEW if number in (1, 2, 5) else TransformStatus.OK)
JUMPING, FAR_APART = moved(lambda number: 0.5 * number + 300.0 * (number > 4)), moved(lambda number: 500.0 * number)


def with_image_poses(folder: Path) -> None:
    sequence = read_sequence(folder / "sweep.igs.mha")
    pose = TransformSample(rigid(), TransformStatus.OK)
    records = [replace(r, transforms={**r.transforms, TransformName("Image", "Reference"): pose}) for r in sequence.records]
    write_sequence(replace(sequence, records=records, images=np.asarray(sequence.images)), folder / "scan.mhd")


def box_elsewhere(folder: Path) -> None:
    Volume(np.zeros((5, 5, 5), np.uint8), rigid(translation=(2000.0, 0.0, 0.0))).write(folder / "elsewhere.nrrd")


def ct(folder: Path) -> None:
    Volume(np.full((4, 5, 6), -1024, np.int16), np.eye(4)).write(folder / "ct.nrrd")


def poses_in_meters(folder: Path) -> None:
    header = (folder / "poses.csv").read_text("utf-8").splitlines()[0]
    rows = [[0.05 * n, 1, 0, 0, 0.001 * n, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] for n in range(FRAMES)]
    (folder / "poses.csv").write_text("\n".join([header, *(",".join(map(str, row)) for row in rows)]), "utf-8")


RECONSTRUCT = f"reconstruct {SWEEP} {OUTPUT}"
IMPORT = "import frames/ --poses poses.csv --output i.mha"
CASES = {
    "aifrecon: sweep.igs.mha: Nothing says where": (as_it_is, f"reconstruct sweep.igs.mha {OUTPUT}"),
    "aifrecon: scan.mhd: Two paths lead": (with_image_poses, f"reconstruct scan.mhd --config PlusDeviceSet.xml {OUTPUT}"),
    "aifrecon: sweep.igs.mha: no frame has a position": (BLIND, RECONSTRUCT),
    "aifrecon: sweep.igs.mha: no frame falls": (box_elsewhere, f"{RECONSTRUCT} --grid-like elsewhere.nrrd"),
    "The pose jumps faster": (JUMPING, f"info {SWEEP}"),
    "aifrecon: The poses move": (poses_in_meters, f"{IMPORT} --transform ImageToTracker --spacing 0.4 0.5"),
    "aifrecon: The poses of ImageToReference are rigid": (as_it_is, f"{IMPORT} --transform ImageToReference"),
    "aifrecon: Method weighted needs": (as_it_is, f"{RECONSTRUCT} --method weighted"),
    "aifrecon: ct.nrrd: labels must": (ct, f"{RECONSTRUCT} --bone-labels ct.nrrd"),
    "skipped: 81 frames": (AT_TIMES_BLIND, RECONSTRUCT),
    "aifrecon: Port 18974 is in use": (as_it_is, f"replay {SWEEP} --port SERVED"),
    "aifrecon: 127.0.0.1 has no server": (as_it_is, f"live --port FREE {OUTPUT}"),
    "aifrecon: Not one of": (BLIND, f"live --port SERVED --frames 9 {OUTPUT}"),
    "aifrecon: The server at": (as_it_is, f"live --port SERVED --image Video {OUTPUT}"),
    "aifrecon: A volume of": (FAR_APART, f"{RECONSTRUCT} --spacing 0.01"),
}
"""How a line of the page begins: what is done to the files of its commands, and the command that says it."""


@pytest.mark.parametrize("beginning", CASES)
def test_a_message_of_the_page_is_what_is_said(beginning, tmp_path, monkeypatch, capsys):
    make_workplace(tmp_path)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("AIFReconLib.commands.live.DEVICE_TIMEOUT", 0.5)
    arrange, command = CASES[beginning]
    arrange(tmp_path)
    server = serve(tmp_path)
    if "FREE" in command:
        server.stop()
    try:
        main(re.sub("SERVED|FREE", str(server.port), command).split())
    finally:
        server.stop()
    captured = capsys.readouterr()
    assert quoted(beginning) in map(without_numbers, (captured.out + captured.err).splitlines())


def test_a_recording_to_which_two_paths_lead_is_read_as_the_page_says(tmp_path, monkeypatch):
    make_workplace(tmp_path)
    monkeypatch.chdir(tmp_path)
    with_image_poses(tmp_path)
    assert (
        main([*CASES["aifrecon: scan.mhd: Two paths lead"][1].split(), "--image-to-reference", "ImageToReference", "--spacing", "2"]) == 0
    )


def test_images_and_poses_out_of_step():
    assert quoted("Images and poses are likely") == without_numbers(OffsetEstimate(0.1, 0.005).to_text())


def test_every_message_of_the_page_is_brought_about_here():
    beginnings = (*CASES, "Images and poses are likely")
    assert [line for line in QUOTED if line.strip() and not line.strip().startswith(beginnings)] == []


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
