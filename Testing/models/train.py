"""Train a tiny U-Net on simulated frames, export it as ONNX, and say what it is worth beside the rule for echoes.

Needs torch and onnx (`pip install torch onnx`), of this script only. Run: python Testing/models/train.py --output bone.onnx [--real FOLDER]
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import torch
from scipy import ndimage
from torch import nn
from torch.nn import functional

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from AIFReconLib.bone.network.model import OnnxModel
from AIFReconLib.bone.predicted_bone import BoneEstimator, EchoEstimator
from AIFReconLib.effective_settings import Imaging
from AIFReconLib.imaging.beams import LINEAR, ProbeGeometry
from AIFReconLib.imaging.region import ImageRegion
from AIFReconLib.sweep.poses import tracked_frames
from models.compare import Case, real, simulated
from models.truth import TrueBone, worth_of

SIDE, CROP = 256, 128
"""Pixels of what the exported model takes, and of what it is trained on: pieces of images of about that size."""

TRAINED, HELD_OUT = (100, 101, 102, 103), (110, 111)
"""Seeds of patients; none of them appears in the study."""

MEAN, STD = 0.2, 0.2
SCALES = 0.7, 2.8
"""Sizes of pieces against `SIDE` pixels for a whole image: scanners show 40 to 150 mm."""

RATE = 4e-3
"""The largest step of learning."""

FRAMES, STEPS, BATCH = 120, 3000, 16
"""Of each simulated patient, the most steps of learning, and pieces in each."""


class TinyUNet(nn.Module):
    """Bone in a gray image: three levels of half the size, skips between them; logits of the input's size."""

    def __init__(self, width: int = 12):
        super().__init__()
        a, b, c, d = width, 2 * width, 3 * width, 4 * width
        self.stem = block(1, a, stride=2)
        self.down = nn.ModuleList([block(a, b, 2), block(b, c, 2), block(c, d, 2)])
        self.up = nn.ModuleList([block(d + c, c), block(c + b, b), block(b + a, a)])
        self.last = nn.Conv2d(a, 1, 1)

    def forward(self, image: torch.Tensor) -> torch.Tensor:
        levels = [self.stem(image)]
        for down in self.down:
            levels.append(down(levels[-1]))
        deep = levels.pop()
        for up in self.up:
            deep = up(torch.cat([functional.interpolate(deep, scale_factor=2.0, mode="nearest"), levels.pop()], dim=1))
        return functional.interpolate(self.last(deep), scale_factor=2.0, mode="bilinear", align_corners=False)


def block(before: int, after: int, stride: int = 1) -> nn.Sequential:
    """Two convolutions."""
    return nn.Sequential(
        *(nn.Conv2d(before, after, 3, stride, 1), nn.BatchNorm2d(after), nn.ReLU()),
        *(nn.Conv2d(after, after, 3, 1, 1), nn.BatchNorm2d(after), nn.ReLU()),
    )


def pictures(patient: Case) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Frames and what should be said of them, as they are, and straightened out along their scan lines as a linear probe's are."""
    truth, poses = TrueBone(patient.labels, patient.imaging), patient.poses
    for frame in tracked_frames(patient.sequence, poses, poses.usable):
        lines, image = truth.reader(frame), frame.placed()[0]
        yield image.astype(np.float32) / 255, truth.estimate(frame).probability
        # Square pixels, which every second line and sample of the reading are nearly
        stretch = lines.pitch / lines.step
        straight, said = lines.read(image).T / 255, truth.on_lines(frame).T
        yield ndimage.zoom(straight, (1.0, stretch), order=1), ndimage.zoom(said, (1.0, stretch), order=1)


def piece(image: np.ndarray, said: np.ndarray, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """A random part of a picture: of another size, gain, contrast, blur and speckle, with bright layers and clutter that are no bone."""
    scale = float(np.exp(rng.uniform(*np.log(SCALES)))) * SIDE / max(image.shape) * rng.uniform(0.85, 1.15, 2)
    taken = np.clip(np.rint(CROP / scale).astype(int), 8, image.shape)
    for _ in range(3):
        row, column = (int(rng.integers(0, n - take + 1)) for n, take in zip(image.shape, taken, strict=True))
        where = slice(row, row + taken[0]), slice(column, column + taken[1])
        if said[where].any():
            break
    image, said = (_resized(each[where], (CROP, CROP)) for each in (image, said))
    if rng.random() < 0.5:
        image, said = image[:, ::-1], said[:, ::-1]
    image = np.clip(image, 0, 1) ** rng.uniform(0.5, 1.8) * rng.uniform(0.5, 1.4)
    if rng.random() < 0.5:
        # Reverberation: what is bright appears again below, fainter
        shift = int(rng.integers(10, 60))
        image = image.copy()
        image[shift:] += rng.uniform(0.05, 0.35) * image[:-shift]
    if rng.random() < 0.6:
        image = image + _layers(rng)
    if rng.random() < 0.5:
        # Gain by depth, and by how well the probe touches the skin
        image = image * _course(rng, rng.uniform(0.0, 0.6))[:, None] * _course(rng, rng.uniform(0.0, 0.6))
    if rng.random() < 0.5:
        image = ndimage.gaussian_filter(image, rng.uniform(0.2, 1.2))
    if rng.random() < 0.5:
        clutter = ndimage.gaussian_filter(rng.random(image.shape), rng.uniform(0.5, 2.0))
        image = image + rng.uniform(0.0, 0.3) * clutter / clutter.max()
    image = image * (1 + rng.uniform(0.0, 0.3) * rng.standard_normal(image.shape))
    return ((np.clip(image, 0, 1) - MEAN) / STD).astype(np.float32), (said > 0.5).astype(np.float32)


def _layers(rng: np.random.Generator) -> np.ndarray:
    """Bright lines that throw no shadow, as skin and the sheaths of muscles are."""
    column, row = np.arange(CROP), np.arange(CROP)[:, None]
    light = np.zeros((CROP, CROP))
    for _ in range(int(rng.integers(1, 5))):
        bend = rng.uniform(0, 12) * np.sin(rng.uniform(1, 7) * column / CROP + rng.uniform(0, 6))
        line = rng.uniform(0, CROP) + rng.uniform(-0.4, 0.4) * (column - CROP / 2) + bend
        light += rng.uniform(0.1, 0.7) * _course(rng, 1.0) * np.exp(-0.5 * ((row - line) / rng.uniform(0.7, 3.0)) ** 2)
    return light


def _course(rng: np.random.Generator, depth: float) -> np.ndarray:
    """A smooth factor along a side of a piece, from 1 - depth to 1."""
    course = ndimage.gaussian_filter1d(rng.random(CROP), rng.uniform(6, 30), mode="wrap")
    return 1 - depth * (course - course.min()) / max(np.ptp(course), 1e-6)


def _resized(image: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    tensor = torch.from_numpy(np.ascontiguousarray(image, dtype=np.float32))[None, None]
    return functional.interpolate(tensor, size=size, mode="bilinear", align_corners=False, antialias=True)[0, 0].numpy()


def trained(patients: list[Case], minutes: float) -> TinyUNet:
    """The network after `STEPS`, or so many minutes."""
    torch.manual_seed(0)
    rng, network = np.random.default_rng(0), TinyUNet()
    print(f"{sum(parameter.numel() for parameter in network.parameters()):,} weights", flush=True)
    every = [pair for patient in patients for pair in pictures(patient)]
    print(f"{len(every)} pictures", flush=True)
    optimizer = torch.optim.AdamW(network.parameters(), RATE, weight_decay=1e-4)
    started, done, step = time.monotonic(), 0.0, 0
    while done < 1:
        # Up over the first twentieth, down to nothing by the end, whether steps or minutes are what there is
        for group in optimizer.param_groups:
            group["lr"] = RATE * min(20 * done + 0.05, 0.5 * (1 + np.cos(np.pi * done)))
        images, said = zip(*(piece(*every[int(rng.integers(len(every)))], rng) for _ in range(BATCH)))
        wanted = torch.from_numpy(np.stack(said))[:, None]
        answer = network(torch.from_numpy(np.stack(images))[:, None])
        probability = torch.sigmoid(answer)
        overlap = 1 - (2 * (probability * wanted).sum() + 1) / (probability.sum() + wanted.sum() + 1)
        loss = functional.binary_cross_entropy_with_logits(answer, wanted, pos_weight=torch.tensor(3.0)) + overlap
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        step += 1
        done = max(step / STEPS, (time.monotonic() - started) / (60 * minutes))
        if step % 50 == 0:
            print(f"step {step}: loss {float(loss):.3f}, {done:.0%}", flush=True)
    return network.eval()


def export(network: TinyUNet, path: Path) -> None:
    """Write the ONNX file and the description beside it."""
    torch.onnx.export(
        network, (torch.zeros(1, 1, SIDE, SIDE),), str(path), input_names=["image"], output_names=["bone"], opset_version=17, dynamo=False
    )
    description = {"input_size": [SIDE, SIDE], "mean": MEAN, "std": STD, "output": "logits"}
    path.with_suffix(".json").write_text(json.dumps(description) + "\n")


def report(case: Case, imaging: Imaging, model: Path, every: int) -> None:
    """A line for each estimator."""
    estimators: dict[str, tuple[BoneEstimator, float]] = {"network": (OnnxModel(model), 0.5), "classical": (EchoEstimator(imaging), 0.01)}
    for name, (estimator, sure) in estimators.items():
        precision, recall, off = worth_of(estimator, TrueBone(case.labels, imaging), case.sequence, case.poses, every, sure)
        f1 = 2 * precision * recall / max(precision + recall, 1e-9)
        print(f"{case.name}, {name}: precision {precision:.3f}, recall {recall:.3f}, F1 {f1:.3f}, {off:.2f} mm", flush=True)


def main() -> None:
    """Train, export, report."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, required=True, metavar="FILE.onnx")
    parser.add_argument("--real", type=Path, metavar="FOLDER", help="holds fibula-distal.igs.mha and fibula-labels.nrrd")
    parser.add_argument("--minutes", type=float, default=600.0, help="stop training after so many")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        patients = {seed: simulated(Path(folder, str(seed)), seed, FRAMES) for seed in (*TRAINED, *HELD_OUT)}
        export(trained([patients[seed] for seed in TRAINED], arguments.minutes), arguments.output)
        for seed in HELD_OUT:
            report(patients[seed], patients[seed].imaging, arguments.output, 4)
    if arguments.real:
        report(real(arguments.real, 1), Imaging(ImageRegion(), ProbeGeometry(LINEAR)), arguments.output, 8)


if __name__ == "__main__":
    main()
