"""`aifrecon live`: reconstruct while scanning, from an OpenIGTLink server."""

from __future__ import annotations

import signal
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Annotated, ClassVar

from ..compounding.methods.table import method_named
from ..compounding.state import Reconstruction
from ..errors import AIFReconError, LiveConnectionError, NoUsableFramesError, SettingsError
from ..io.plus.configuration import read_plus_configuration
from ..live.pairing.synchronizer import SynchronizerSettings
from ..live.replay.server import PLUS_PORT
from ..live.session.bone_watch import predictions_beside
from ..live.session.session import LiveSession
from ..live.wire.client import OpenIGTLinkClient
from ..live.wire.sources import StreamStatistics
from ..message import one_line
from ..recipe.recipe import Recipe
from ..sweep.configuration import NO_CONFIGURATION
from ..terminal.arguments import Names, Output, Rivals, Settings, count, positive
from ..terminal.console import ProgressBar
from ..terminal.outputs import check_outputs
from ..terminal.reconstruction_options import (
    ReconstructionOptions,
    bone_inputs,
    bone_source_from,
    check_bone_options,
    grid_from,
    with_provenance,
)
from ..terminal.remedies import as_option, in_options
from ..terminal.sequence_options import OF_A_RECORDING, TrackingOptions
from ..terminal.signals import heard_in_pauses
from ..terminal.status_line import StatusLine
from ..workflows.job import ScanJob
from ..workflows.live_scan import SCOUT_MARGIN, LiveScan
from .preview import how_to_look
from .reconstruct import FIRST_OPTIONS, checked_outputs, describe, write_outputs

DEVICE_TIMEOUT = 5.0
"""s that a connected server may take to send its first image."""

OF_A_STREAM = ("image", "trust_image_pose", "time_offset", "longest_gap", "tracker_frame")
"""How a stream is read, by the names of the options. A recording of it has the poses that came of it."""

UNREAD_IMAGES = ("VIDEO", "TRACKEDFRAME", "USMESSAGE", "NDARRAY")
"""Types of messages that hold images and are not read: compressed ones, and those of single programs."""

SETTLING = 1.0
"""s after the first image in which other image devices may show up."""

POLL = 0.1


class _LiveOptions(ReconstructionOptions, TrackingOptions):
    """Receive images and poses over OpenIGTLink, from Plus for example, and reconstruct while they come. Ctrl-C ends the scan and saves
    the volume. Without --grid-like, move over the whole region at first.

    Parameters
    ----------
    host : H
        name or address of the server
    port : P
        that of the server (default: 18944, as Plus)
    image : DEVICE
        name of the image device (default: the only one there is)
    bone_image : DEVICE
        no CT: name of an image device that sends a network's predictions with the time stamps of their images
    trust_image_pose
        use the pose that comes with an image although the server never tells whether its tool is seen
    tracker_frame : FRAME
        where poses lead that are named after their tool alone: Probe is ProbeTo and this
    output : VOLUME
        where to write (.nrrd, .mha, .mhd, .nii, .nii.gz)
    record : SEQUENCE
        also record every frame, tracked or not (.mhd, .mha, .nrrd); best for long scans: .mhd
    frames : N
        end after N frames
    seconds : S
        end S seconds after the first frame
    scout_seconds : S
        without --grid-like: find the box in so many seconds from the first tracked frame on

    Examples
    --------
      aifrecon live --host 192.168.0.12 --output volume.nrrd
      aifrecon live --output volume.nrrd --bone-labels lumbar.nrrd --bone-transform CTToReference.tfm --seconds 60
    """

    host: str = "127.0.0.1"
    port: int = PLUS_PORT
    image: str | None = None
    bone_image: str | None = None
    trust_image_pose: bool = False
    tracker_frame: str = SynchronizerSettings.tracker_frame
    output: Output
    record: Output | None = None
    frames: Annotated[int, count] | None = None
    seconds: Annotated[float, positive] | None = None
    scout_seconds: Annotated[float, positive] = 10.0

    SETTINGS: ClassVar[Settings] = ("time_offset", "longest_gap", "motion")
    time_offset: ClassVar[float] = 0.0
    longest_gap: ClassVar[float] = SynchronizerSettings.longest_gap
    RIVALS: ClassVar[Rivals] = (("bone_labels", "bone_probability", "bone_from_sweep", "bone_frames", "bone_model", "bone_image"),)
    NOT_KEPT: ClassVar[Names] = OF_A_RECORDING
    FIRST: ClassVar[Names] = ("host", "port", "record", "seconds", *FIRST_OPTIONS, "quiet")


def run(asked: _LiveOptions) -> int:
    """Connect, reconstruct until the end or Ctrl-C, write what there is; the answer is the exit code."""
    inputs = [*asked.config, *bone_inputs(asked), asked.importance_mask]
    if asked.record and (asked.bone_image or asked.bone_model):
        check_outputs(asked, [predictions_beside(asked.record)])
    outputs = checked_outputs(asked, asked.output)
    started = time.perf_counter()
    scan, client = _scan_of(asked, asked.recipe)
    with scan:
        result, told_by = _scan(scan, client, asked)
    labeled, statistics, error = scan.labeled, scan.session.statistics, scan.session.error
    if result is None or not result.frames_inserted:
        why = " ".join(filter(None, [scan.why_nothing(client.statistics, as_option), scan.recording_line]))
        if told_by is None:
            raise NoUsableFramesError(why)
        print(f"aifrecon: Scan ended, nothing to save. {one_line(why)}", file=sys.stderr)
        return 128 + told_by
    result = with_provenance(result, asked, inputs, {name: getattr(asked, name) for name in OF_A_STREAM})
    files = write_outputs(result, asked, outputs, labeled.in_reference() if labeled else None)
    width = [*labeled.labels.notes, *labeled.lines(result.method)] if labeled and method_named(result.method).needs_bone else []
    print(describe(result, statistics.frames_received, time.perf_counter() - started, files, agreement=width))
    lines = [*scan.what_else(client.statistics, result), *_bone_lines(scan), scan.recording_line, *how_to_look(asked, asked.output)]
    print(*(f"  {in_options(line)}\n" for line in lines if line), sep="", end="")
    if error is not None:
        cause = in_options(error).rstrip(".")
        raise AIFReconError(f"The reconstruction stopped early: {cause}. What was there before is written to {asked.output}.")
    if told_by not in (None, signal.SIGINT):
        raise KeyboardInterrupt
    if told_by is not None:
        print("Scan ended, volume saved.")
    return 0


def _scan_of(asked: _LiveOptions, recipe: Recipe) -> tuple[LiveScan, OpenIGTLinkClient]:
    """The scan that the options ask for, and its client, which is connected."""
    synchronizer = SynchronizerSettings(
        image_device=asked.image,
        image_to_reference=recipe.image_to_reference,
        reference=recipe.reference,
        time_offset=recipe.time_offset,
        longest_gap=recipe.longest_gap,
        trust_image_pose=asked.trust_image_pose,
        tracker_frame=asked.tracker_frame,
    )
    check_bone_options(asked)
    if asked.bone_frames:
        raise SettingsError("--bone-frames belongs to a recorded sweep. Give --bone-image or --bone-model for a live scan.")
    if asked.bone_image and asked.bone_image == asked.image:
        raise SettingsError(f"--bone-image and --image must be two devices; got {asked.image!r} for both.")
    client = OpenIGTLinkClient(asked.host, asked.port)
    with ProgressBar() as progress:
        job = ScanJob(
            recipe,
            configuration=read_plus_configuration(asked.config[-1]) if asked.config else NO_CONFIGURATION,
            grid=grid_from(asked),
            bone=replace(bone_source_from(asked, progress), device=asked.bone_image),
            synchronizer=synchronizer,
            record=asked.record,
            frame_limit=asked.frames,
        )
        scan = LiveScan(job, client, progress)
    recorder = scan.session.recorder
    if recorder is not None:
        # Its name may be another than was asked for
        recorded = {recorder.path, recorder.header_path} - {asked.record}
        check_outputs(asked, sorted(recorded))
    client.start(wait=True)
    return scan, client


def _bone_lines(scan: LiveScan) -> list[str]:
    """How the search for bone in the frames went."""
    watch, recorded = scan.bone_watch, scan.session.recorded
    if watch is None:
        return []
    lines = [*watch.lines(scan.session.statistics.frames_received)]
    if watch.recorded is not None:
        lines.append(f"recorded what was said of bone to {watch.recorded}")
    if recorded is not None:
        told = "--bone-from-sweep" if watch.recorded is None else f"--bone-frames {watch.recorded}"
        lines.append(f"to weight all frames by all that was found: aifrecon reconstruct {recorded} {told}")
    return lines


def _scan(scan: LiveScan, client: OpenIGTLinkClient, asked: _LiveOptions) -> tuple[Reconstruction | None, int | None]:
    """The volume, and the signal by which the scan was ended, if it was."""
    told_by, first_tracked, session = None, 0.0, scan.session
    status = StatusLine(sys.stderr)
    if session.recorder is not None and session.recorder.note:
        status.say(session.recorder.note)
    try:
        with session:
            try:
                with heard_in_pauses() as pause:
                    _wait_for_images(session, client, asked, pause)
                    first_frame = time.monotonic()
                    if session.grid is None:
                        seconds = f"{asked.scout_seconds:g} s"
                        status.say(f"Connected. Move the probe over the whole region: the first {seconds} find the box.")
                    while not _is_over(session, asked, first_frame):
                        pause(POLL)
                        status.show(session)
                        if session.grid is None and session.scouted:
                            first_tracked = first_tracked or time.monotonic()
                            if time.monotonic() - first_tracked >= asked.scout_seconds:
                                _use_scouted_box(scan, status)
            except KeyboardInterrupt as end:
                told_by = int(end.args[0]) if end.args else int(signal.SIGINT)
            status.clear()
            if session.grid is None and session.scouted:
                _use_scouted_box(scan, status)
            with ProgressBar() as progress:
                return session.finish(progress), told_by
    finally:
        status.clear()


def _wait_for_images(session: LiveSession, client: OpenIGTLinkClient, asked: _LiveOptions, pause: Callable[[float], None]) -> None:
    """Return when there are images of the one device that is meant; else say what the server sends."""
    deadline = time.monotonic() + DEVICE_TIMEOUT
    while session.latest is None and not session.finished.is_set():
        pause(POLL)
        if time.monotonic() > deadline:
            raise _no_images(session, client.statistics, asked)
    settled = time.monotonic() + SETTLING
    while asked.image is None and time.monotonic() < settled and not session.finished.is_set():
        pause(POLL)
        images = [device for device, types in session.devices().items() if "IMAGE" in types]
        if len(images) > 1:
            raise LiveConnectionError(f"The server sends images of several devices: {', '.join(images)}. Choose one with --image.")


def _no_images(session: LiveSession, stream: StreamStatistics, asked: _LiveOptions) -> LiveConnectionError:
    """What came instead of images, and why it is not used."""
    wanted = f"images of {asked.image}" if asked.image else "images"
    devices = {device: types for device, types in session.devices().items() if device}
    sends = ", ".join(f"{device} ({', '.join(types)})" for device, types in devices.items()) or "nothing"
    came = [device for device, types in devices.items() if "IMAGE" in types and asked.image in (None, device)]
    unread = [f"{device} comes as {kind}" for device, types in devices.items() for kind in types if kind in UNREAD_IMAGES]
    advice = "Start the imaging there."
    if came and "IMAGE" in stream.refusals:
        wanted = f"{wanted} that can be used"
        advice = f"Every image of {', '.join(came)} was refused: {stream.refusals['IMAGE']}"
    elif unread:
        advice = (
            f"{', '.join(unread)}, which is not read: let the server send IMAGE"
            " (of Plus: without EncodingType in its configuration, and with IMAGE among its MessageTypes)."
        )
    elif any("IMAGE" in types for types in devices.values()):
        advice = "Choose its image device with --image."
    elif stream.refusals:
        advice = f"Messages arrive, but were refused: {' '.join(stream.refusals.values())}"
    return LiveConnectionError(f"The server at {asked.host}:{asked.port} sends no {wanted}. It sends {sends}. {advice}")


def _use_scouted_box(scan: LiveScan, status: StatusLine) -> None:
    grid = scan.use_scouted_box()
    extent = " x ".join(f"{n * s:.0f}" for n, s in zip(grid.size, grid.spacing, strict=True))
    status.say(f"The box is {extent} mm, {' x '.join(str(n) for n in grid.size)} voxels; {SCOUT_MARGIN:g} mm around what was seen.")


def _is_over(session: LiveSession, asked: _LiveOptions, first_frame: float) -> bool:
    """Whether the time is up, or there is nothing left to do: a recording goes on after the reconstruction has failed."""
    has_failed = session.error is not None and (session.recorder is None or session.recording_failure is not None)
    is_late = asked.seconds is not None and time.monotonic() - first_frame >= asked.seconds
    return session.finished.is_set() or has_failed or is_late
