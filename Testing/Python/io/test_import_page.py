"""Who writes what, and the one line for it: each line of docs/import.md, run on a made-up file of that layout."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from made_recordings import CALIBRATION, COUNT, IMAGES, POSES, TO_BASE, TO_MM, Bag, acquisition, bundle, pose
from test_foreign_images import FRAMES, write_dicom
from test_pictures_as_shown import ORIENTATION, groups, imagej_stack

from AIFReconLib import read_sequence, read_volume
from AIFReconLib.commands.parser import main

PAGE = (Path(__file__).resolve().parents[3] / "docs" / "import.md").read_text("utf-8")
LINES = {
    name: line for line, name in re.findall(r"`aifrecon ((?:reconstruct|import) (\S+) [^`]*)`", PAGE) if not name.startswith("images.npy")
}
DICOM = pytest.importorskip("pydicom", reason="pydicom is not installed")
PIL = pytest.importorskip("PIL.Image", reason="Pillow is not installed")


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


def pictures(folder: Path) -> None:
    (folder / "pictures").mkdir()
    for number, frame in enumerate(FRAMES):
        tag = PIL.Exif()
        tag[ORIENTATION] = 6
        PIL.fromarray(frame).save(folder / "pictures" / f"{number}.jpg", exif=tag)


def metaimages(folder: Path) -> None:
    header = "ObjectType = Image\nNDims = 2\nElementSpacing = 0.2 0.2\nDimSize = 17 12\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n"
    (folder / "frames").mkdir()
    for number, frame in enumerate(FRAMES):
        (folder / "frames" / f"{number}.mha").write_bytes(header.encode() + frame.tobytes())


WRITERS = {
    "US-Acq_1": lambda folder: acquisition(folder / "US-Acq_1"),
    "sweep.bag": bag,
    "scene.mrb": lambda folder: bundle(folder / "scene.mrb"),
    "sweep.npz": lambda folder: np.savez(
        folder / "sweep.npz", images=IMAGES, image_to_reference=POSES @ TO_MM, timestamps=np.arange(COUNT) / 20
    ),
    "stack.tif": lambda folder: imagej_stack(folder / "stack.tif", FRAMES, {"images": 11, "slices": 11}),
    "pictures": pictures,
    "cine.dcm": lambda folder: write_dicom(
        DICOM, folder / "cine.dcm", FRAMES, **groups(DICOM, shared=[("PixelMeasuresSequence", {"PixelSpacing": [0.2, 0.2]})])
    ),
    "frames": metaimages,
}


def test_every_line_of_the_page_has_a_file():
    assert set(LINES) == set(WRITERS) | {"sweep.mp4", "frames/"} & set(LINES)


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
