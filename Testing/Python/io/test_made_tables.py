"""2,000 tables of a dozen makers' layouts, conventions, units, tools, statuses and clocks: read right or asked, never wrong in silence."""

from __future__ import annotations

import re
import shlex
import sys
import tempfile
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from made_tables import (
    LAYOUTS,
    Made,
    bare,
    made_table,
    motive,
    ndi_in_rows,
    ndi_side_by_side,
    ndi_track,
    polhemus,
    qualisys,
    recording,
    robot,
    ros,
    vicon,
)

from AIFReconLib.commands.parser import main
from AIFReconLib.errors import AIFReconError
from AIFReconLib.geometry.transform_graph import TransformName, TransformStatus
from AIFReconLib.io.foreign.images import ImportedImages
from AIFReconLib.io.foreign.importing import import_sequence
from AIFReconLib.io.foreign.options import ImportOptions
from AIFReconLib.io.foreign.poses.files import read_poses
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.message import message_of

EVERY = 10
"""One in so many is tried by `make test`; this file as a program tries all 2,000."""

PROBE = TransformName("Probe", "Tracker")


def imported(made: Made, path) -> tuple[np.ndarray, np.ndarray | None, list[str]]:
    """Poses and times as a user gets them who answers each question with the truth; and the questions."""
    path.write_text(made.text, encoding="utf-8")
    form, sure, asked = ImportOptions(), False, []
    for _question in range(8):
        try:
            poses = read_poses(path, form)
            images = ImportedImages(np.zeros((len(poses.matrices), 4, 4), np.uint8), "images")
            sequence, _understood = import_sequence(images, poses, replace(form, transform=str(PROBE), sure=sure))
        except AIFReconError as error:
            asked.append((*message_of(error).settings, str(error))[0])
            if asked[-1] not in made.answers or asked.count(asked[-1]) > 1:
                raise AssertionError(f"{made.layout}: {error}") from error
            form = replace(form, **made.answers[asked[-1]])
            continue
        samples = [record.transforms[PROBE] for record in sequence.records]
        found = np.array([s.matrix if s.status is TransformStatus.OK else np.full((4, 4), np.nan) for s in samples])
        times = [record.timestamp for record in sequence.records]
        return found, None if None in times else np.array(times), asked
    raise AssertionError(f"{made.layout}: {asked}")


def check(seed: int, path) -> list[str]:
    made = made_table(seed)
    found, times, asked = imported(made, path.with_name(made.name))
    assert (np.isnan(found) == np.isnan(made.poses)).all(), (seed, made.layout)
    good = ~np.isnan(found[:, 0, 0])
    assert np.abs(found[good, :3, 3] - made.poses[good, :3, 3]).max() <= 0.01, (seed, made.layout)
    turned = np.einsum("nij,nik->njk", found[good, :3, :3], made.poses[good, :3, :3])
    assert np.degrees(np.abs(turned - np.eye(3)).max()) <= 0.01, (seed, made.layout)
    if made.times is None:
        assert times is None, (seed, made.layout)
    else:
        assert times is not None, (seed, made.layout)
        assert np.abs((times - times[0]) - made.times).max() <= 1e-4, (seed, made.layout)
    return asked


@pytest.mark.parametrize("first", range(len(LAYOUTS)))
def test_a_table_is_read_right_or_asked_about(tmp_path, first):
    for seed in range(first, 2000, EVERY * len(LAYOUTS)):
        check(seed, tmp_path / "poses")


WRITERS = {
    "ndi.csv": ndi_side_by_side,
    "ndi-track.csv": ndi_track,
    "ndi-rows.csv": ndi_in_rows,
    "motive.csv": motive,
    "vicon.csv": vicon,
    "qualisys.tsv": qualisys,
    "polhemus.txt": polhemus,
    "ur.csv": lambda seen: robot(seen, kuka=False),
    "kuka.csv": lambda seen: robot(seen, kuka=True),
    "ros.csv": ros,
    "plain.csv": lambda seen: bare(seen, kind=4),
    "matrices.txt": lambda seen: bare(seen, kind=0),
}
"""The files of docs/import.md."""

PAGE = Path(__file__).resolve().parents[3] / "docs" / "import.md"
LINES = re.findall(r"`aifrecon (import images\.npy --poses (\S+) [^`]*)`", PAGE.read_text("utf-8"))


def test_the_page_has_a_line_for_each_writer():
    assert [name for _line, name in LINES] == list(WRITERS)


@pytest.mark.parametrize(("line", "name"), LINES)
def test_the_line_of_the_page_takes_its_table_in_right(tmp_path, monkeypatch, line, name):
    monkeypatch.chdir(tmp_path)
    tools = 1 if name in ("kuka.csv", "ur.csv") else 2
    made = WRITERS[name](recording(np.random.default_rng(5), tools, names=["Probe", "Reference"][:tools]))
    (tmp_path / name).write_text(made.text, encoding="utf-8")
    np.save("images.npy", np.zeros((len(made.poses), 4, 4), np.uint8))
    assert main(shlex.split(line)) == 0
    samples = [record.transforms[PROBE] for record in read_sequence("sweep.mha").records]
    found = np.array([s.matrix if s.status is TransformStatus.OK else np.full((4, 4), np.nan) for s in samples])
    np.testing.assert_allclose(found, made.poses, atol=0.01)


if __name__ == "__main__":  # with another first seed: its number
    first = int(sys.argv[1]) if len(sys.argv) > 1 else 0
    with tempfile.TemporaryDirectory() as folder:
        asked = [check(seed, Path(folder) / "poses") for seed in range(first, first + 2000)]
    print("right, by the number of questions:", dict(sorted(Counter(map(len, asked)).items())))
    print("asked for the columns:", sum("columns" in each for each in asked))
