"""Who writes what, and the one line for it: each line of docs/import.md, run on a made-up file of that layout."""

from __future__ import annotations

import re
import shlex
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image
import pytest
from dicom_samples import write_dicom
from made_pictures import write_pictures
from made_recordings import CALIBRATION, COUNT, IMAGES, POSES, TO_BASE, TO_MM, Bag, acquisition, bundle, pose
from made_tables import bare, motive, ndi_in_rows, ndi_side_by_side, ndi_track, polhemus, qualisys, recording, robot, ros, vicon
from sequence_samples import single_frame
from test_foreign_images import FRAMES
from test_pictures_as_shown import ORIENTATION, groups, imagej_stack

from AIFReconLib import read_sequence, read_volume
from AIFReconLib.commands.parser import main
from AIFReconLib.geometry.transform_graph import TransformStatus

PAGE = (Path(__file__).resolve().parents[3] / "docs" / "import.md").read_text("utf-8")
LINES = {
    table or first: line
    for line, first, table in re.findall(r"`aifrecon (\w+ (\S+)(?: --poses ((?!poses\.csv)\S+))? [^`]*--output[^`]*)`", PAGE)
}


def bag(folder: Path) -> None:
    made = Bag(folder / "sweep", "bag")
    with made.writer:
        made.tree(0.0, "robot", "base", TO_BASE, "/tf_static")
        for number in range(COUNT):
            made.tree(0.05 * number, "us_probe", "robot", pose(number))
            made.image(number)
    matrix = " ".join(map(str, CALIBRATION.ravel()))
    (folder / "PlusDeviceSet.xml").write_text(
        "<PlusConfiguration><CoordinateDefinitions>"
        f'<Transform From="Image" To="UsProbe" Matrix="{matrix}"/></CoordinateDefinitions></PlusConfiguration>'
    )


def turned_pictures(folder: Path) -> None:
    tag = PIL.Image.Exif()
    tag[ORIENTATION] = 6
    write_pictures(folder / "pictures", FRAMES, ".jpg", exif=tag)


def metaimages(folder: Path) -> None:
    (folder / "frames").mkdir()
    for number, frame in enumerate(FRAMES):
        single_frame(folder / "frames" / f"{number}.mha", frame)


MEASURES = groups(shared=[("PixelMeasuresSequence", {"PixelSpacing": [0.2, 0.2]})])
ARRAYS: dict[str, Any] = {"images": IMAGES, "image_to_reference": POSES @ TO_MM, "timestamps": np.arange(COUNT) / 20}
WRITERS = {
    "US-Acq_1": lambda folder: acquisition(folder / "US-Acq_1"),
    "sweep.bag": bag,
    "scene.mrb": lambda folder: bundle(folder / "scene.mrb"),
    "sweep.npz": lambda folder: np.savez(folder / "sweep.npz", **ARRAYS),
    "stack.tif": lambda folder: imagej_stack(folder / "stack.tif", FRAMES, {"images": 11, "slices": 11}),
    "pictures": turned_pictures,
    "cine.dcm": lambda folder: write_dicom(folder / "cine.dcm", FRAMES, **MEASURES),
    "frames": metaimages,
}
TABLES = {
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


def test_every_line_of_the_page_has_a_file():
    assert {*LINES} == {*WRITERS, *TABLES}


@pytest.mark.parametrize("name", WRITERS)
def test_the_one_line_does_it(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    WRITERS[name](tmp_path)
    rows = "".join(f"{n / 20},{n / 2},0,0,0,0,0,1\n" for n in range(len(FRAMES)))
    (tmp_path / "poses.csv").write_text(f"time,x,y,z,qx,qy,qz,qw\n{rows}")
    assert main(shlex.split(LINES[name])) == 0, capsys.readouterr().err
    if LINES[name].startswith("reconstruct"):
        assert read_volume("volume.nrrd").array.any()
    else:
        sequence = read_sequence("sweep.mha")
        assert len(sequence) == len(FRAMES)
        assert all(sample.status.value == "OK" for record in sequence.records for sample in record.transforms.values())


@pytest.mark.parametrize("name", TABLES)
def test_the_line_of_a_table_takes_its_poses_in_right(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    tools = ["Probe", "Reference"][: 1 if name in ("kuka.csv", "ur.csv") else 2]
    made = TABLES[name](recording(np.random.default_rng(5), len(tools), names=tools))
    (tmp_path / name).write_text(made.text, encoding="utf-8")
    np.save("images.npy", np.zeros((len(made.poses), 4, 4), np.uint8))
    assert main(shlex.split(LINES[name])) == 0
    samples = [next(iter(record.transforms.values())) for record in read_sequence("sweep.mha").records]
    found = np.array([each.matrix if each.status is TransformStatus.OK else np.full((4, 4), np.nan) for each in samples])
    np.testing.assert_allclose(found, made.poses, atol=0.01)
