"""Recordings of an N-wire phantom, rendered from a calibration that is known."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from AIFReconLib import TrackedSequence
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample
from AIFReconLib.simulation.scan import random_rigid
from AIFReconLib.sweep.configuration import PlusConfiguration
from AIFReconLib.sweep.frames import FrameRecord

SIZE = 320, 240
"""Columns and rows."""

PHANTOM = Path(__file__).with_name("phantoms") / "wires.xml"
"""Three N's of wires; its place in Reference is to be filled in."""

IMAGE_TO_PROBE = random_rigid(60.0, 100.0, np.random.default_rng(5), np.zeros(3)) @ np.diag([0.15, 0.12, 1.0, 1.0])
"""Pixels are a quarter wider than high."""

PLACE = random_rigid(40.0, 70.0, np.random.default_rng(6), np.zeros(3))
"""phantom_to_reference."""


def write_phantom(path: Path, place: np.ndarray | None = PLACE) -> Path:
    """The phantom's configuration; without its place where that is None."""
    text = PHANTOM.read_text("utf-8").format(place=" ".join(f"{value:.12g}" for value in (np.eye(4) if place is None else place).ravel()))
    path.write_text(text if place is not None else text.replace('From="Phantom"', 'From="Stylus"'), encoding="utf-8")
    return path


def poses(rng: np.random.Generator, count: int, tilt: float = 18.0, lift: float = 5.0, along: float = 2.0) -> np.ndarray:
    """image_to_phantom of planes (mm) that cut all wires: from above, turned and tilted by up to `tilt` degrees, over `lift` mm up
    and down and `along` mm along the wires."""
    matrices = np.tile(np.eye(4), (count, 1, 1))
    for matrix in matrices:
        # Columns along the phantom's x, rows down its z
        upright = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
        matrix[:3, :3] = Rotation.from_euler("xyz", rng.uniform(-tilt, tilt, 3) * [0.6, 0.5, 1.0], degrees=True).as_matrix() @ upright
        matrix[:3, 1] *= -1
        matrix[:3, 2] = np.cross(matrix[:3, 0], matrix[:3, 1])
        middle = np.array([SIZE[0] / 2 * 0.15, SIZE[1] / 2 * 0.12, 0.0])
        matrix[:3, 3] = [14, 15, 8] + rng.uniform(-1, 1, 3) * [along / 2, along, lift] - matrix[:3, :3] @ middle
    return matrices


def rendered(image_to_phantom: np.ndarray, wires: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """An image (rows, columns) uint8 with an echo wherever a wire (n, 2, 3) meets it, speckle, and a bright bottom that is none."""
    columns, rows = np.arange(SIZE[0]), np.arange(SIZE[1])
    image = rng.rayleigh(6.0, (SIZE[1], SIZE[0])) + np.outer(60 * np.exp(-(((rows - 225) / 3) ** 2)), np.abs(columns - 90) < 30)
    back = np.linalg.inv(image_to_phantom)
    for wire in wires:
        front, end = wire @ back[:3, :3].T + back[:3, 3]
        x, y, _ = front + front[2] / (front[2] - end[2]) * (end - front)
        image += 150 * rng.uniform(0.6, 1.0) * np.outer(np.exp(-(((rows - y) / 2) ** 2)), np.exp(-(((columns - x) / 4) ** 2)))
    return np.clip(image, 0, 255).astype(np.uint8)


def recording(
    wires: dict[str, np.ndarray],
    count: int = 60,
    *,
    image_to_probe: np.ndarray = IMAGE_TO_PROBE,
    given: np.ndarray | None = None,
    place: np.ndarray | None = PLACE,
    seed: int = 0,
    **how: float,
) -> TrackedSequence:
    """A scan of the phantom, ProbeToReference recorded, the phantom's place and a given calibration in the configuration."""
    rng = np.random.default_rng(seed)
    planes = poses(rng, count, **how) @ np.diag([0.15, 0.12, 1.0, 1.0])
    images = np.stack([rendered(plane, np.array(list(wires.values())), rng) for plane in planes])
    name = TransformName("Probe", "Reference")
    probes = PLACE @ planes @ np.linalg.inv(image_to_probe)
    records = [FrameRecord(number / 10, transforms={name: TransformSample(probe)}) for number, probe in enumerate(probes)]
    known = {TransformName("Phantom", "Reference"): place, TransformName("Image", "Probe"): given}
    transforms = {each: TransformSample(matrix) for each, matrix in known.items() if matrix is not None}
    return TrackedSequence(images, records, configuration=PlusConfiguration(transforms=transforms))
