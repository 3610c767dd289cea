"""Acquisitions of CustusX: a folder of frames, with their times and poses, the tracked tool's, and the calibration of the probe.

All files of one begin alike: ``_0.mhd`` and so on are the frames, ``.fts`` their times and ``.tts`` those of the tool (ms, one a line),
``.fp`` the poses of the frames and ``.tp`` those of the tool (three rows of four numbers each), ``.probedata.xml`` the probe. Frames and
poses have their origin at the upper left pixel: its page says lower left, its programs write and read upper left
(`transformFramePositionsTo_rMu`).
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ....arrays import Floats, Mask, Matrix, Numbers
from ....errors import ConfigurationError, SequenceFormatError
from ....geometry.transform_graph import TransformName, TransformSample, TransformStatus
from ....recipe.recipe import LONGEST_GAP
from ....sweep.frames import FrameRecord
from ....sweep.pose_tracks import PoseTrack
from ...disk.regular_files import files_in
from ...disk.small_files import read_bytes
from ...disk.xml_tree import parse_xml
from ...metafile.text_values import NotANumberError, finite_numbers
from ..decoded_images import DecodedImages
from ..kinds import Recorded, RecordingKind
from ..metafiles import METAFILES

IMAGE, TOOL = TransformName("Image", "Reference"), TransformName("Tool", "Reference")
CALIBRATION = TransformName("Image", "Tool")
OK, LOST = TransformStatus.OK, TransformStatus.MISSING
NEAR = 0.1
"""s. How far from a pose of the tool CustusX may have gone on with it, where the next is farther than `LONGEST_GAP`."""


def _read(path: Path, orientation: str | None) -> Recorded:
    times_path = _times_of_frames(path)
    base = str(times_path)[: -len(".fts")]
    times = _numbers(times_path) / 1000.0
    frames = _frames(times_path, base)

    def decode(number: int) -> Numbers:
        images, spacing = _frame(frames[number], orientation)
        if spacing != first_spacing:
            raise SequenceFormatError(f"{frames[number]}: its pixels must have the size of those of the first frame. Record it again.")
        return images

    _, first_spacing = _frame(frames[0], orientation)
    _same(times_path, "a time for each frame", len(times), len(frames), "frames")
    images = DecodedImages(len(frames), decode, lambda n: str(frames[n]))
    of_probe, image_to_tool = _probe(Path(f"{base}.probedata.xml")) or (None, None)
    spacing = first_spacing or of_probe
    if spacing is None:
        raise SequenceFormatError(f"{frames[0]}: the size of a pixel is neither there nor in {base}.probedata.xml. Copy that file too.")
    name, samples, header, notes = _poses(base, times, spacing, image_to_tool)
    records = [FrameRecord(float(time), transforms={name: sample}, stated_spacing=spacing) for time, sample in zip(times, samples)]
    return Recorded(images, records, transforms=header, notes=notes)


_Poses = tuple[TransformName, Sequence[TransformSample], dict[TransformName, TransformSample], tuple[str, ...]]


def _poses(base: str, times: Floats, spacing: tuple[float, float], image_to_tool: Matrix | None) -> _Poses:
    """What the poses of the frames are, one each, transforms of all frames, and what a user should know."""
    of_frames, of_tool, tool_times = (Path(f"{base}{suffix}") for suffix in (".fp", ".tp", ".tts"))
    to_mm = np.diag([*spacing, sum(spacing) / 2, 1.0])
    clock = _numbers(tool_times) / 1000.0 if tool_times.exists() else None
    if of_frames.exists():
        matrices = _matrices(of_frames) @ to_mm
        _same(of_frames, "a pose for each frame", len(matrices), len(times), "frames")
        seen = np.ones(len(times), bool) if clock is None else _tracked(times, clock)
        samples = [TransformSample(matrix, OK if ok else LOST) for matrix, ok in zip(matrices, seen)]
        lost = np.count_nonzero(~seen)
        note = f"CustusX went on with the last pose in {lost} frames that the tracker did not see; they are left out."
        return IMAGE, samples, {}, (note,) * bool(lost)
    if not of_tool.exists() or clock is None:
        raise SequenceFormatError(f"{base}.fp: neither this file nor .tp and .tts of the same name are there. Copy the whole folder.")
    matrices = _matrices(of_tool)
    _same(of_tool, "a time for each pose", len(clock), len(matrices), "poses")
    track = PoseTrack(zip(clock.tolist(), map(TransformSample, matrices)))
    samples = track.samples(times)
    if image_to_tool is None:
        return TOOL, samples, {}, ("The acquisition does not say where the image lies in the probe (.probedata.xml).",)
    return TOOL, samples, {CALIBRATION: TransformSample(image_to_tool @ to_mm)}, ()


def _same(path: Path, what: str, got: int, count: int, of: str) -> None:
    if got != count:
        raise SequenceFormatError(f"{path}: there must be {what}; got {got} for {count} {of}.")


def _tracked(times: Floats, clock: Floats) -> Mask:
    """Which frames were taken while the tracker saw the tool: CustusX also gives poses to the others."""
    clock = np.concatenate([[-np.inf], np.sort(clock), [np.inf]])
    after = np.searchsorted(clock, times).clip(1, len(clock) - 1)
    before, behind = clock[after - 1], clock[after]
    seen: Mask = (behind - before <= LONGEST_GAP) | (np.minimum(times - before, behind - times) <= NEAR)
    return seen


def _probe(path: Path) -> tuple[tuple[float, float], Matrix] | None:
    """What a probe definition says of the image: the size of a pixel, and where it lies in the tool; None where it says nothing of it.

    The tool has its z axis along the beams and its -y axis along the rows of the image; its origin is pixel `origin_p`
    (`ProbeSector::get_tMu` and `get_uMv`).
    """
    if not path.exists():
        return None
    try:
        image = parse_xml(path).find("configuration/image")
        if image is None:
            return None
        x, y = finite_numbers(image.get("spacing", ""))[:2].tolist()
        origin = finite_numbers(image.get("origin_p", ""), 3)
    except (ConfigurationError, ValueError) as error:
        raise SequenceFormatError(f"{path}: the definition of the probe cannot be read. {error}") from error
    if min(x, y) <= 0:
        raise SequenceFormatError(f"{path}: spacing must be numbers above 0. Copy the file again.")
    image_to_tool = np.array([[0.0, 0, -1, 0], [-1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1]])
    image_to_tool[:3, 3] = -image_to_tool[:3, :3] @ np.multiply(origin, [x, y, (x + y) / 2])
    return (x, y), image_to_tool


def _frame(path: Path, orientation: str | None) -> tuple[Numbers, tuple[float, float] | None]:
    recorded = METAFILES.read(path, orientation)
    if len(recorded.images) != 1:
        raise SequenceFormatError(f"{path}: it must hold one frame; got {len(recorded.images)}. Record it again.")
    return recorded.images[0], recorded.records[0].stated_spacing


def _frames(path: Path, base: str) -> list[Path]:
    """The files of the frames, in order."""
    of_frame = re.compile(re.escape(Path(base).name) + r"_([0-9]{1,9})\.mhd", re.IGNORECASE)
    found = sorted((int(match[1]), file) for file in files_in(path.parent) if (match := of_frame.fullmatch(file.name)))
    if not found:
        raise SequenceFormatError(f"{path}: the frames {Path(base).name}_0.mhd and so on must lie beside it. Copy the whole folder.")
    return [file for _, file in found]


def refuse_one_frame(path: Path) -> None:
    """Return unless a file is one frame of an acquisition, which alone has neither place nor time.

    Raises SequenceFormatError for one.
    """
    base = re.sub(r"_[0-9]{1,9}\.mhd$", "", path.name)
    if base != path.name and path.with_name(f"{base}.fts").is_file():
        raise SequenceFormatError(f"{path}: this is one frame of an acquisition of CustusX. Give the folder, or {base}.fts.")


def _times_of_frames(path: Path) -> Path:
    """The file of an acquisition by which it is known, in its folder or as it is."""
    if not path.is_dir():
        return path
    found = files_in(path, "*.fts")
    if len(found) != 1:
        names = ", ".join(file.name for file in found)
        raise SequenceFormatError(f"{path}: there are {len(found)} acquisitions of CustusX here ({names}). Give one of these files.")
    return found[0]


def _numbers(path: Path) -> Floats:
    """All numbers of a small file."""
    data = read_bytes(path, None, SequenceFormatError)
    try:
        return finite_numbers(data.decode("ascii", "replace"))
    except NotANumberError as error:
        raise SequenceFormatError(f"{path}: it must hold finite numbers alone; {error}. Copy the file again.") from error


def _matrices(path: Path) -> Matrix:
    """Poses (n, 4, 4) of three rows each."""
    numbers = _numbers(path)
    if len(numbers) % 12:
        raise SequenceFormatError(f"{path}: poses must have three rows of four numbers; got {len(numbers)} numbers. Copy the file again.")
    rows = numbers.reshape(-1, 3, 4)
    return np.concatenate([rows, np.tile([[0.0, 0.0, 0.0, 1.0]], (len(rows), 1, 1))], axis=1)


def _files(path: Path) -> list[Path]:
    """All files of the acquisition; the data of its frames are called as these."""
    of_it = re.compile(re.escape(path.stem) + r"(_[0-9]{1,9})?[.].+", re.IGNORECASE)
    return [file for file in files_in(path.parent) if of_it.fullmatch(file.name)]


CUSTUSX = RecordingKind("an acquisition of CustusX", (".fts",), _read, is_folder=lambda path: bool(files_in(path, "*.fts")), files=_files)
