"""`aifrecon live`: reconstruct while scanning, from an OpenIGTLink server."""

from __future__ import annotations

import argparse
import signal
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from ..compounding.methods.table import method_named
from ..compounding.state import Reconstruction
from ..errors import AIFReconError, LiveConnectionError, NoUsableFramesError, SettingsError
from ..geometry.transform_graph import TransformName
from ..io.foreign.mechanisms import read_mechanism
from ..io.plus.configuration import read_plus_configuration
from ..io.volume.files import check_volume_path
from ..live.pairing.placement import UNCONFIRMED
from ..live.pairing.synchronizer import SynchronizerSettings
from ..live.replay.server import PLUS_PORT
from ..live.session.bone_watch import predictions_beside
from ..live.session.session import LiveSession
from ..live.session.statistics import LiveStatistics
from ..live.wire.client import OpenIGTLinkClient
from ..live.wire.joint_source import JointSource
from ..live.wire.sources import MessageSource, StreamStatistics
from ..message import one_line, shorten
from ..recipe.recipe import Recipe
from ..sweep.configuration import NO_CONFIGURATION
from ..terminal.console import ProgressBar
from ..terminal.options import Commands, refuse_to_overwrite
from ..terminal.recipe_options import add_setting, recipe_from
from ..terminal.reconstruction_options import (
    SIDE_OUTPUTS,
    add_reconstruction_options,
    bone_inputs,
    bone_source_from,
    check_bone_options,
    grid_from,
)
from ..terminal.remedies import in_options
from ..terminal.sequence_options import OF_A_RECORDING, add_tracking_options
from ..terminal.settings_options import add_settings_options, check_save_settings, save_settings, with_provenance
from ..terminal.signals import heard_in_pauses
from ..terminal.status_line import StatusLine
from ..workflows.job import ScanJob
from ..workflows.live_scan import SCOUT_MARGIN, LiveScan
from .preview import add_preview_option, check_preview, how_to_look, write_preview
from .reconstruct import FIRST_OPTIONS, describe

EXAMPLE = """examples:
  aifrecon live --host 192.168.0.12 --output volume.nrrd
  aifrecon live --output volume.nrrd --bone-labels lumbar.nrrd --bone-transform CTToReference.tfm --seconds 60"""

DEVICE_TIMEOUT = 5.0
"""s that a connected server may take to send its first image."""

OF_A_STREAM = ("image", "trust_image_pose", "time_offset", "longest_gap", "tracker_frame")
"""How a stream is read, by the names of the options. A recording of it has the poses that came of it."""

UNREAD_IMAGES = ("VIDEO", "TRACKEDFRAME", "USMESSAGE", "NDARRAY")
"""Types of messages that hold images and are not read: compressed ones, and those of single programs."""

SETTLING = 1.0
"""s after the first image in which other image devices may show up."""

POLL = 0.1

WRITTEN = ("output", *SIDE_OUTPUTS, "preview", "record", "save_settings")
"""Options that name files that are written."""


def add_to(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "live",
        description="Receive images and poses over OpenIGTLink, from Plus for example, and reconstruct while they come. "
        "Ctrl-C ends the scan and saves the volume. Without --grid-like, move over the whole region at first.",
        examples=EXAMPLE,
    )
    server = parser.add_argument_group("server")
    server.add_argument("--host", default="127.0.0.1", metavar="H", help="name or address of the server (default: %(default)s)")
    server.add_argument("--port", type=int, default=PLUS_PORT, metavar="P", help="default: %(default)s, as Plus")
    server.add_argument("--image", metavar="DEVICE", help="name of the image device (default: the only one there is)")
    server.add_argument(
        "--bone-image",
        metavar="DEVICE",
        help="no CT: name of an image device that sends a network's predictions with the time stamps of their images",
    )
    server.add_argument(
        "--trust-image-pose",
        action="store_true",
        help="use the pose that comes with an image although the server never tells whether its tool is seen",
    )
    add_setting(server, "time_offset", 0.0)
    add_setting(server, "longest_gap", SynchronizerSettings.longest_gap)
    server.add_argument(
        "--tracker-frame",
        default=SynchronizerSettings.tracker_frame,
        metavar="FRAME",
        help="where poses lead that are named after their tool alone: Probe is ProbeTo and this (default: %(default)s)",
    )
    server.add_argument(
        "--mechanism",
        metavar="NAME=FILE",
        help="what moves the probe (see import), whose axes messages (STRING, SENSOR) or the images' fields tell in mm and degrees: "
        "as in ProbeToBase=array.toml",
    )
    scan = parser.add_argument_group("scan")
    scan.add_argument(
        "-o", "--output", type=Path, required=True, metavar="VOLUME", help="where to write (.nrrd, .mha, .mhd, .nii, .nii.gz)"
    )
    scan.add_argument(
        "--record",
        type=Path,
        metavar="SEQUENCE",
        help="also record every frame, tracked or not (.mhd, .mha, .nrrd); best for long scans: .mhd",
    )
    scan.add_argument("--frames", type=int, metavar="N", help="end after N frames")
    scan.add_argument("--seconds", type=float, metavar="S", help="end S seconds after the first frame")
    scan.add_argument(
        "--scout-seconds",
        type=float,
        default=10.0,
        metavar="S",
        help="without --grid-like: find the box in so many seconds from the first tracked frame on (default: %(default)g)",
    )
    add_setting(parser, "method")
    add_tracking_options(parser)
    add_preview_option(add_reconstruction_options(parser, without=(*OF_A_RECORDING, "motion")))
    add_settings_options(parser, without=(*OF_A_RECORDING, "motion"))
    parser.show_first("host", "port", "record", "seconds", *FIRST_OPTIONS, "quiet")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Connect, reconstruct until the end or Ctrl-C, write what there is; the answer is the exit code."""
    for name in ("frames", "seconds", "scout_seconds"):
        value = getattr(arguments, name)
        if value is not None and not value > 0:
            raise SettingsError(f"Input --{name.replace('_', '-')} must be above 0; got {value!r}.")
    outputs = {"intensity": arguments.output, **{name: getattr(arguments, name) for name in SIDE_OUTPUTS}}
    inputs = [arguments.config, *bone_inputs(arguments), arguments.importance_mask]
    says_bone = arguments.record and (arguments.bone_image or arguments.bone_model)
    refuse_to_overwrite(arguments, *WRITTEN, more=[predictions_beside(arguments.record)] if says_bone else [])
    check_preview(arguments.preview)
    check_save_settings(arguments)
    for path in filter(None, outputs.values()):
        check_volume_path(path)
    started = time.perf_counter()
    recipe = recipe_from(arguments)
    scan, client = _scan_of(arguments, recipe)
    session = scan.session
    with scan:
        result, told_by = _scan(scan, client, arguments)
    labeled = scan.labeled
    statistics, error = session.statistics, session.error
    recording = _recording_line(session)
    if result is None or not result.frames_inserted:
        why = " ".join(filter(None, [_why_nothing(statistics, client.statistics, error), recording]))
        if told_by is None:
            raise NoUsableFramesError(why)
        print(f"aifrecon: Scan ended, nothing to save. {one_line(why)}", file=sys.stderr)
        return 128 + told_by
    with ProgressBar() as progress:
        stream = {name: getattr(arguments, name) for name in OF_A_STREAM}
        result = with_provenance(result, arguments, inputs, stream)
        for number, (name, path) in enumerate((name, path) for name, path in outputs.items() if path):
            progress(0.1 * number, f"Writing {path.name}")
            getattr(result, name).write(path)
        drawn = [*write_preview(result, arguments, labeled.in_reference() if labeled else None), *save_settings(result, arguments)]
    files = [path for path in (*outputs.values(), *drawn) if path]
    width = [*labeled.labels.notes, *labeled.lines(result.method)] if labeled and method_named(result.method).needs_bone else []
    print(describe(result, statistics.frames_received, time.perf_counter() - started, files, agreement=width))
    for line in filter(None, [*_what_else(statistics, client.statistics, result), *_bone_lines(scan), recording, *how_to_look(arguments)]):
        print(f"  {in_options(line)}")
    if error is not None:
        cause = in_options(error).rstrip(".")
        raise AIFReconError(f"The reconstruction stopped early: {cause}. What was there before is written to {arguments.output}.")
    if told_by not in (None, signal.SIGINT):
        raise KeyboardInterrupt
    if told_by is not None:
        print("Scan ended, volume saved.")
    return 0


def _scan_of(arguments: argparse.Namespace, recipe: Recipe) -> tuple[LiveScan, OpenIGTLinkClient]:
    """The scan that the options ask for, and its client, which is connected."""
    synchronizer = SynchronizerSettings(
        image_device=arguments.image,
        image_to_reference=recipe.image_to_reference,
        reference=recipe.reference,
        time_offset=recipe.time_offset,
        longest_gap=recipe.longest_gap,
        trust_image_pose=arguments.trust_image_pose,
        tracker_frame=arguments.tracker_frame,
    )
    _check_bone_options(arguments)
    client = OpenIGTLinkClient(arguments.host, arguments.port, takes_readings=arguments.mechanism is not None)
    with ProgressBar() as progress:
        job = ScanJob(
            recipe,
            configuration=read_plus_configuration(arguments.config) if arguments.config else NO_CONFIGURATION,
            grid=grid_from(arguments),
            bone=replace(bone_source_from(arguments, progress), device=arguments.bone_image),
            synchronizer=synchronizer,
            record=arguments.record,
            frame_limit=arguments.frames,
        )
        scan = LiveScan(job, _with_poses(client, arguments.mechanism), progress)
    recorder = scan.session.recorder
    if recorder is not None:
        # Its name may be another than was asked for
        recorded = {recorder.path, recorder.header_path} - {arguments.record}
        refuse_to_overwrite(arguments, *WRITTEN, more=sorted(recorded))
    client.start(wait=True)
    return scan, client


def _check_bone_options(arguments: argparse.Namespace) -> None:
    """Return if the options that let the frames say where bone is are for a scan, and go together.

    Raises SettingsError otherwise.
    """
    check_bone_options(arguments)
    if arguments.bone_frames:
        raise SettingsError("--bone-frames belongs to a recorded sweep. Give --bone-image or --bone-model for a live scan.")
    others = ("bone_labels", "ct", "bone_probability", "bone_transform", "bone_model", "bone_from_sweep")
    both = next((name for name in others if arguments.bone_image and getattr(arguments, name)), None)
    if both is not None:
        raise SettingsError(f"--bone-image is a source of bone, and so is --{both.replace('_', '-')}. Leave out one.")
    if arguments.bone_image and arguments.bone_image == arguments.image:
        raise SettingsError(f"--bone-image and --image must be two devices; got {arguments.image!r} for both.")


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


def _with_poses(client: OpenIGTLinkClient, mechanism: str | None) -> MessageSource:
    """The client, with the poses of a mechanism whose axes its messages or its images tell."""
    if mechanism is None:
        return client
    name, equals, file = mechanism.partition("=")
    if not equals:
        raise SettingsError(f"--mechanism must be NAME=FILE, as in ProbeToBase=array.toml; got {shorten(mechanism)!r}.")
    return JointSource(client, read_mechanism(file), TransformName.parse(name))


def _scan(scan: LiveScan, client: OpenIGTLinkClient, arguments: argparse.Namespace) -> tuple[Reconstruction | None, int | None]:
    """The volume, and the signal by which the scan was ended, if it was."""
    told_by, session = None, scan.session
    status = StatusLine(sys.stderr)
    if session.recorder is not None and session.recorder.note:
        status.say(session.recorder.note)
    try:
        with session:
            try:
                with heard_in_pauses() as pause:
                    _wait_for_images(session, client, arguments, pause)
                    first_frame = time.monotonic()
                    if session.grid is None:
                        seconds = f"{arguments.scout_seconds:g} s"
                        status.say(f"Connected. Move the probe over the whole region: the first {seconds} find the box.")
                        _scout(session, arguments, first_frame, status, pause)
                        _use_scouted_box(scan, status)
                    while not _is_over(session, arguments, first_frame):
                        pause(POLL)
                        status.show(session)
            except KeyboardInterrupt as end:
                told_by = int(end.args[0]) if end.args else int(signal.SIGINT)
                status.clear()
                if session.grid is None and session.scouted:
                    _use_scouted_box(scan, status)
            status.clear()
            with ProgressBar() as progress:
                return session.finish(progress), told_by
    finally:
        status.clear()


def _wait_for_images(
    session: LiveSession, client: OpenIGTLinkClient, arguments: argparse.Namespace, pause: Callable[[float], None]
) -> None:
    """Return when there are images of the one device that is meant; else say what the server sends."""
    deadline = time.monotonic() + DEVICE_TIMEOUT
    while session.latest is None and not session.finished.is_set():
        pause(POLL)
        if time.monotonic() > deadline:
            raise _no_images(session, client.statistics, arguments)
    settled = time.monotonic() + SETTLING
    while arguments.image is None and time.monotonic() < settled and not session.finished.is_set():
        pause(POLL)
        images = [device for device, types in session.devices().items() if "IMAGE" in types]
        if len(images) > 1:
            raise LiveConnectionError(f"The server sends images of several devices: {', '.join(images)}. Choose one with --image.")


def _no_images(session: LiveSession, stream: StreamStatistics, arguments: argparse.Namespace) -> LiveConnectionError:
    """What came instead of images, and why it is not used."""
    wanted = f"images of {arguments.image}" if arguments.image else "images"
    devices = {device: types for device, types in session.devices().items() if device}
    sends = ", ".join(f"{device} ({', '.join(types)})" for device, types in devices.items()) or "nothing"
    came = [device for device, types in devices.items() if "IMAGE" in types and arguments.image in (None, device)]
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
    return LiveConnectionError(f"The server at {arguments.host}:{arguments.port} sends no {wanted}. It sends {sends}. {advice}")


def _scout(
    session: LiveSession, arguments: argparse.Namespace, first_frame: float, status: StatusLine, pause: Callable[[float], None]
) -> None:
    """Wait until the box can be found."""
    began = None
    while not _is_over(session, arguments, first_frame):
        pause(POLL)
        status.show(session)
        if began is None and session.scouted:
            began = time.monotonic()
        if began is not None and time.monotonic() - began >= arguments.scout_seconds:
            return


def _use_scouted_box(scan: LiveScan, status: StatusLine) -> None:
    if not scan.session.scouted:
        return
    grid = scan.use_scouted_box()
    extent = " x ".join(f"{n * s:.0f}" for n, s in zip(grid.size, grid.spacing, strict=True))
    status.say(f"The box is {extent} mm, {' x '.join(str(n) for n in grid.size)} voxels; {SCOUT_MARGIN:g} mm around what was seen.")


def _is_over(session: LiveSession, arguments: argparse.Namespace, first_frame: float) -> bool:
    """Whether the time is up, or there is nothing left to do: a recording goes on after the reconstruction has failed."""
    if session.finished.is_set():
        return True
    if session.error is not None and (session.recorder is None or session.recording_failure):
        return True
    return arguments.seconds is not None and time.monotonic() - first_frame >= arguments.seconds


def _why_nothing(statistics: LiveStatistics, stream: StreamStatistics, error: Exception | None) -> str:
    """Why there is no volume: the most frequent reason first."""
    if error is not None:
        return f"The reconstruction could not begin: {in_options(error)}"
    if not statistics.frames_received:
        return "No frame was received, so there is no volume."
    reasons = "; ".join(f"{reason}: {count}" for reason, count in sorted(statistics.skipped.items(), key=lambda item: -item[1]))
    refused = [f"Messages were refused: {reason}" for reason in stream.refusals.values()]
    # What troubles the stream says what to do itself
    advice = [statistics.trouble, *refused] if statistics.trouble or refused else ["Check the tracking, then scan again."]
    if UNCONFIRMED in statistics.skipped:
        advice = [
            *filter(None, advice[:-1]),
            "Let the server send the transforms of its tools, or give --trust-image-pose if it sends no image without a valid pose.",
        ]
    nothing = f"Not one of {statistics.frames_received} frames entered a volume ({reasons})."
    return " ".join(map(in_options, filter(None, [nothing, *advice])))


def _what_else(statistics: LiveStatistics, stream: StreamStatistics, result: Reconstruction) -> list[str]:
    """What happened besides the reconstruction."""
    lines = [f"skipped: {count}: {reason}" for reason, count in statistics.skipped.items() if reason not in result.skipped]
    if statistics.note:
        lines.append(statistics.note)
    if stream.refused:
        lines.append(f"{stream.refused} messages were refused: {' '.join(stream.refusals.values())}")
    if stream.damaged:
        lines.append(f"{stream.damaged} messages were damaged on the way, and left out")
    if statistics.dropped > stream.late:
        lines.append(f"{statistics.dropped - stream.late} messages came faster than this computer took them, and were left out")
    if statistics.repeated:
        lines.append(f"{statistics.repeated} images were sent again after a reconnection, and left out")
    if statistics.other_images:
        lines.append(f"{statistics.other_images} images came from other devices, and were left out")
    return lines


def _recording_line(session: LiveSession) -> str | None:
    recorder = session.recorder
    if recorder is None or recorder.failure or session.recorded is None:
        return session.recording_failure
    recorded = f"recorded {recorder.frames} frames to {session.recorded}"
    more = " ".join(filter(None, (recorder.loss, recorder.note)))
    return f"{recorded}. {more}" if more else recorded
