"""Screens of scanners, drawn with a known probe among text, buttons, rulers and bars: the probe is told rightly, or refused."""

from __future__ import annotations

import io
import math
from dataclasses import dataclass

import numpy as np
import pytest
from PIL import Image
from scipy import ndimage

from AIFReconLib.errors import BeamGeometryError
from AIFReconLib.imaging.beams import LINEAR, SECTOR
from AIFReconLib.imaging.detection import detect_imaging

SIZES = ((480, 640), (576, 720), (600, 800))
"""(rows, columns)."""

KINDS = {"curved": 0.5, "linear": 0.2, "phased": 0.12, "virtual convex": 0.18}
"""Kinds of images and how often they come."""

DECOYS = ("upside down", "", "moving picture", "sides covered")
"""What shows no probe that could be told, by numbers."""

RIGHT, REFUSED, WRONG = "right", "refused", "wrong"

LINES, SAMPLES = 160, 320
"""Of the image before scan conversion."""


@dataclass
class Screen:
    """A recording of a scanner's screen and what is true of it."""

    images: np.ndarray  #: (frames, rows, columns) uint8
    spacing: tuple[float, float]  #: (x, y), mm
    inside: np.ndarray  #: (rows, columns) bool. Where the probe's image is, also where it is dark
    lit: np.ndarray  #: (rows, columns) bool. Where any frame shows ultrasound
    apex: tuple[float, float] | None = None  #: (column, row)
    angles: tuple[float, float] = (0.0, 0.0)  #: degrees

    @property
    def probe(self) -> str:
        """The kind of its beams."""
        return SECTOR if self.apex else LINEAR


def screen(seed: int) -> Screen:
    """The screen of this number, always the same."""
    rng = np.random.default_rng(seed)
    kind = str(rng.choice(list(KINDS), p=list(KINDS.values())))
    made = _probe_image(rng, kind)
    _overlay(rng, made)
    _compress(rng, made)
    return made


def decoy(seed: int) -> Screen:
    """A screen whose probe cannot be told."""
    rng = np.random.default_rng([seed, 1])
    kind = DECOYS[seed % len(DECOYS)]
    made = _probe_image(rng, "curved")
    if kind == "upside down":
        made.images = made.images[:, ::-1].copy()
    elif kind == "moving picture":
        made.images = _noise(rng, made.images.shape)
    else:
        lit = np.flatnonzero(made.inside.any(axis=0))
        width = int(0.36 * np.ptp(lit))
        made.images[:, :, : lit[0] + width] = made.images[:, :, lit[-1] - width :] = 40
    _overlay(rng, made)
    _compress(rng, made)
    return made


def _noise(rng: np.random.Generator, shape: tuple[int, ...]) -> np.ndarray:
    coarse = rng.standard_normal((shape[0], shape[1] // 4 + 1, shape[2] // 4 + 1))
    return np.clip(90 + 60 * ndimage.zoom(coarse, (1, 4, 4), order=1), 0, 255)[:, : shape[1], : shape[2]].astype(np.uint8)


def _probe_image(rng: np.random.Generator, kind: str) -> Screen:
    """Ultrasound on a background, nothing else."""
    rows, columns = SIZES[rng.integers(len(SIZES))]
    depth = {"curved": rng.uniform(70, 180), "linear": rng.uniform(30, 70), "phased": rng.uniform(80, 170)}.get(kind, rng.uniform(40, 90))
    half = {"curved": rng.uniform(24, 38), "phased": rng.uniform(32, 45), "linear": 0.0}.get(kind, rng.uniform(10, 20))
    aperture = rng.uniform(36, 52)
    first = {"curved": rng.uniform(40, 68), "phased": rng.choice([0.0, rng.uniform(2, 6)])}.get(kind, 0.0)
    if kind == "virtual convex":
        first = aperture / 2 / math.tan(math.radians(half))
    fills = rng.uniform(0.6, 0.9)
    sy = depth / (fills * rows)
    across = aperture if kind == "linear" else 2 * (first + depth) * math.sin(math.radians(half))
    sy = max(sy, across / (0.95 * columns))
    sx = sy * (rng.uniform(0.8, 1.25) if rng.random() < 0.15 else 1.0)
    sx = max(sx, across / (0.97 * columns))
    # Where the middle of the transducer's face is
    column = columns / 2 + rng.uniform(-0.08, 0.08) * columns
    row = rng.uniform(0.02, 0.12) * rows
    if rng.random() < 0.3:
        how = rng.integers(4)
        if how == 0:
            row += rows - (row + depth / sy) + rng.uniform(0.02, 0.15) * rows  # the bottom is cut off
        elif kind != "linear":
            side = -1 if how == 1 else 1
            edge = column + side * across / 2 / sx
            beyond = rng.uniform(0.05, 0.22) * across / sx
            column += (columns - edge + beyond) if side > 0 else (-edge - beyond)
    y, x = np.mgrid[:rows, :columns].astype(np.float64)
    x, y = (x - column) * sx, (y - row) * sy
    apex = None
    if kind == "linear":
        line, sample = x / aperture + 0.5, y / depth
        inside = (abs(x) <= aperture / 2) & (y >= 0) & (y <= depth)
    else:
        back = first * (math.cos(math.radians(half)) if kind == "curved" and rng.random() < 0.5 else 1.0)
        # The face's middle or its corners at `row`
        apex = (column, row - back / sy)
        y = y + back
        radius, angle = np.hypot(x, y), np.degrees(np.arctan2(x, y))
        if kind == "virtual convex":
            inside = (abs(angle) <= half) & (y >= first) & (radius <= first + depth)
            sample = (radius - first / np.cos(np.radians(np.clip(angle, -80, 80)))) / depth
        else:
            inside = (abs(angle) <= half) & (radius >= first) & (radius <= first + depth)
            sample = (radius - first) / depth
        line = angle / (2 * half) + 0.5
    frames = int(rng.integers(14, 30))
    polar = _beams(rng, frames)
    background = int(rng.integers(8, 50)) if rng.random() < 0.3 else 0
    images = np.full((frames, rows, columns), background, np.uint8)
    where = np.nonzero(inside)
    i, j = np.clip(line[where] * (LINES - 1), 0, LINES - 1.001), np.clip(sample[where] * (SAMPLES - 1), 0, SAMPLES - 1.001)
    corner, di, dj = i.astype(int) * SAMPLES + j.astype(int), (i % 1).astype(np.float32), (j % 1).astype(np.float32)
    for image, beams in zip(images, polar.reshape(frames, -1), strict=True):
        near = beams[corner] * (1 - dj) + beams[corner + 1] * dj
        next_line = beams[corner + SAMPLES] * (1 - dj) + beams[corner + SAMPLES + 1] * dj
        image[where] = near * (1 - di) + next_line * di
    lit = inside & (images.max(axis=0).astype(int) - images.min(axis=0) > 12)
    return Screen(images, (sx, sy), inside, lit, apex, (-half, half) if apex else (0.0, 0.0))


def _beams(rng: np.random.Generator, frames: int) -> np.ndarray:
    """(frames, lines, samples) gray levels of speckle with layers, bone with its shadow, and darkness."""
    line, sample = np.linspace(0, 1, LINES)[:, None], np.linspace(0, 1, SAMPLES)[None, :]
    gain = -rng.uniform(0, 30) * sample**2 + np.zeros((LINES, 1))
    ringing = rng.random() < 0.7
    if rng.random() < 0.5:
        gain -= 70 / (1 + np.exp((sample - rng.uniform(0.05, 0.25)) / 0.02))
    dark = None
    if rng.random() < 0.35:
        share, side = rng.uniform(0.1, 0.4), line if rng.random() < 0.5 else 1 - line
        dark = 70 / (1 + np.exp((side - share) / rng.uniform(0.01, 0.05)))
    lifted = rng.random() < 0.4
    waves = [(rng.uniform(1, 9), rng.uniform(3, 25), rng.uniform(0, 6), rng.uniform(0, 6.28), rng.uniform(1, 4)) for _ in range(7)]
    contrast, level = rng.uniform(45, 65), rng.uniform(-6, 6)
    stack = np.empty((frames, LINES, SAMPLES), np.float32)
    for number in range(frames):
        time = number / frames
        scene = sum(size * np.cos(a * line + b * sample + c * time + p) for a, b, c, p, size in waves)
        real, imaginary = (ndimage.gaussian_filter(rng.standard_normal((LINES, SAMPLES)), (1.0, 1.3)) for _ in range(2))
        decibels = 20 * np.log10(np.hypot(real, imaginary) / 0.35 + 1e-6) + scene + gain + level
        top = 0.3 + 0.25 * np.sin(3 * time + waves[0][3]) + 0.2 * (line - 0.5) ** 2 * waves[1][0] / 4
        on_bone = abs(line - 0.5 - 0.3 * np.sin(4 * time + waves[2][3])) < 0.16
        decibels += np.where(on_bone, 22 * np.exp(-(((sample - top) / 0.012) ** 2)) - 30 * (sample > top), 0)
        if dark is not None and (not lifted or number < 0.7 * frames):
            decibels -= dark
        if ringing:
            decibels = np.maximum(decibels, 12 - 3000 * sample**1.6 + 3 * rng.standard_normal((LINES, SAMPLES)))
        stack[number] = np.clip((decibels / contrast + 0.55) * 230, 0, 255)
    return stack


def _overlay(rng: np.random.Generator, made: Screen) -> None:
    """Draw what a scanner draws around, and over, its image."""
    images = made.images
    frames, rows, columns = images.shape
    white = int(rng.integers(140, 256))
    lit = [np.flatnonzero(made.inside.any(axis=axis)) for axis in (0, 1)]
    (left, right), (top, bottom) = (lit[0][0], lit[0][-1]), (lit[1][0], lit[1][-1])
    for _ in range(int(rng.integers(2, 9))):
        line = int(rng.choice([rng.integers(2, 40), rng.integers(rows - 60, rows - 20)]))
        _text(rng, images, int(rng.integers(0, columns - 60)), line, white)
    if rng.random() < 0.7:
        # A ruler of depth at the right of the image, or in it
        at = int(min(right + rng.integers(-8, 12), columns - 8))
        step = max(int(10 / made.spacing[1]), 4)
        images[:, top:bottom, at] = white
        for number, tick in enumerate(range(int(top), int(bottom), step)):
            images[:, tick, at : at + (8 if number % 5 == 0 else 4)] = white
    if rng.random() < 0.6:
        x, height = int(rng.integers(4, 24)), int(0.4 * rows)
        images[:, 20 : 20 + height, x : x + 14] = np.linspace(255, 0, height)[None, :, None]
    if rng.random() < 0.4:
        _panel(rng, made, int(left), int(right), white)
    if rng.random() < 0.3:
        for row in range(int(top), int(bottom), 9):  # a dotted line down the image
            images[:, row : row + 2, int((left + right) / 2)] = white
    if rng.random() < 0.4:
        x, y = int(rng.integers(columns - 90)), int(rng.integers(2, 20))
        for number in range(frames):  # a clock
            images[number, y : y + 10, x : x + 60] = 0
            _text(rng, images[number : number + 1], x, y, white, 6, 1)
    if rng.random() < 0.15 and bottom < rows - 30:
        for number in range(frames):  # an ECG that runs along the bottom
            trace = rows - 16 + 8 * np.sin(np.arange(columns) / 7 + number)
            images[number, trace.astype(int), np.arange(columns)] = images[number, trace.astype(int) + 1, np.arange(columns)] = white
    if rng.random() < 0.1:
        for number in range(frames):
            x, y = int(rng.integers(columns - 12)), int(rng.integers(rows - 14))
            images[number, y : y + 12, x : x + 7] = 255
    if rng.random() < 0.2:
        # Text over the image
        _text(rng, images, int(left + 0.1 * (right - left)), int(top + 0.2 * (bottom - top)), white)


def _panel(rng: np.random.Generator, made: Screen, left: int, right: int, white: int) -> None:
    """A column of buttons beside the image, at times over its corner."""
    images, columns = made.images, made.images.shape[2]
    over = rng.random() < 0.4
    if left > columns - right:
        near, far = 0, max(left - 6 + (int(0.06 * (right - left)) if over else 0), 4)
    else:
        near, far = min(right + 6 - (int(0.06 * (right - left)) if over else 0), columns - 4), columns
    images[:, :, near:far] = rng.integers(25, 90)
    for y in range(20, images.shape[1] - 40, 60):
        images[:, y : y + 36, near + 3 : far - 3] = rng.integers(90, 160)
        _text(rng, images, near + 6, y + 8, white, 5, 1)
    made.lit[:, near:far] = False


def _text(rng: np.random.Generator, images: np.ndarray, x: int, y: int, white: int, letters: int = 0, size: int = 0) -> None:
    size = size or int(rng.integers(1, 3))
    for letter in range(letters or int(rng.integers(4, 16))):
        glyph = np.kron(rng.random((7, 5)) < 0.5, np.ones((size, size))).astype(bool)
        box = images[:, y : y + glyph.shape[0], x + 6 * size * letter : x + 6 * size * letter + glyph.shape[1]]
        box[:, glyph[: box.shape[1], : box.shape[2]]] = white


def _compress(rng: np.random.Generator, made: Screen) -> None:
    """What a frame grabber or a video does to the picture."""
    how = rng.random()
    if how < 0.25:
        noise = rng.uniform(0.5, 2.0) * rng.standard_normal(made.images.shape)
        made.images = np.clip(np.rint(made.images + noise), 0, 255).astype(np.uint8)
    elif how < 0.5:  # JPEG
        quality = int(rng.integers(60, 95))
        for number, image in enumerate(made.images):
            file = io.BytesIO()
            Image.fromarray(image).save(file, "JPEG", quality=quality)
            made.images[number] = np.asarray(Image.open(file))


def answer(made: Screen) -> str:
    """Whether a screen is told rightly, refused or told wrongly: the apex within 0.5 mm, the sides within 1 degree, most of it kept."""
    try:
        found = detect_imaging(made.images, made.spacing)
    except BeamGeometryError:
        return REFUSED
    kept = found.region.mask(*made.inside.shape[::-1])
    whole = (made.lit & kept).sum() >= 0.85 * made.lit.sum() and (kept & ~made.inside).sum() <= 0.04 * kept.sum()
    right = found.probe.kind == made.probe and bool(whole)
    if found.probe.kind == made.probe and made.apex is not None:
        assert found.region.fan is not None
        apex = float(np.hypot(*(np.subtract(found.probe.apex, made.apex) * made.spacing)))
        right &= apex <= 0.5 and float(np.abs(np.subtract(found.region.fan.angles_deg, made.angles)).max()) <= 1.0
    return RIGHT if right else WRONG


# ---- some of them

SEEDS = (0, 2, 4, 5, 7, 8, 10, 12, 58, 62, 99, 104, 148, 191, 1084, 30073, 30140, 30187, 40028, 40115, 70177, 80079, 80131, 80473, 80516)
REFUSALS = {
    **{kind: (decoy, seed) for seed, kind in enumerate(DECOYS) if kind},
    "the middle of a sector that the border cuts off below": (decoy, 30027),
    "a sector whose sides are covered where only a higher level shows its arc": (decoy, 40015),
    "a narrow middle of a sector whose noise hides its arc at lower levels": (decoy, 50027),
    "a clock beside the middle of a sector": (decoy, 30031),
    "a moving picture that two borders and a trace bound": (decoy, 80342),
    "a box most of which stands still": (decoy, 80260),
    "a sector of which a surer level tells another apex": (screen, 110121),
}


@pytest.mark.parametrize("seed", SEEDS)
def test_a_probe_is_told_from_a_screen(seed):
    assert answer(screen(seed)) == RIGHT


@pytest.mark.parametrize(("make", "seed"), REFUSALS.values(), ids=REFUSALS)
def test_what_shows_no_probe_for_sure_is_refused(make, seed):
    assert answer(make(seed)) == REFUSED
