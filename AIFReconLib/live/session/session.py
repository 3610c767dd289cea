"""A volume that grows during the scan: source, synchronizer, recording and reconstructor, held together and closed together."""

from __future__ import annotations

import logging
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable
from concurrent.futures import Future, ThreadPoolExecutor, wait
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from ...arrays import Matrix
from ...bone.map import BoneMap
from ...compounding.methods.table import method_named
from ...compounding.needs import needs_beams, require_bone, require_grid_as_asked, require_map_as_asked
from ...compounding.state import Reconstruction, bytes_per_voxel
from ...effective_settings import Imaging, reconstructor_parts, resolve_settings
from ...errors import SettingsError
from ...geometry.volume import VoxelGrid
from ...imaging.sound_speed import depth_factor
from ...message import message_of
from ...progress import Progress, Steps, part
from ...provenance.record import with_origin
from ...recipe.recipe import AUTOMATIC, OF_READING, Recipe
from ...sweep.configuration import NO_CONFIGURATION, PlusConfiguration
from ...sweep.still_images import StillImages
from ..pairing.synchronizer import LiveFrame, Synchronizer, SynchronizerSettings
from ..wire.messages import ImageMessage
from ..wire.sources import CONNECTED, ENDED, QueueSource
from .insertion import LEFT_OUT, WHILE_PAUSED, Inserter
from .recording import Recorder
from .scouting import SCOUTED, Recognition, ScoutedFrames
from .statistics import NO_IMAGES, LiveStatistics, StreamHealth, tracking_words

logger = logging.getLogger(__name__)

SCOUTING, LOOKING, RECONSTRUCTING, PAUSED, FAILED, STOPPED = "scouting", "looking", "reconstructing", "paused", "failed", "stopped"

FRAMES_LOOKED_AT = 24
"""Tracked frames that are awaited to recognize the probe in, where neither options nor a configuration tell."""

MOST_PREDICTIONS = 64

MOST_WATCHES = 8
"""That go on at a time, and snapshots."""

MOST_KEPT_BYTES = 2**30
"""Of pixels that are kept where the motion of the patient is to be taken out."""

POLL = 0.25
"""s after which a source that says nothing is asked again."""


def _read_as_asked(synchronizer: SynchronizerSettings, asked: Recipe) -> tuple[SynchronizerSettings, Recipe]:
    """How a stream is read, what a recipe says of it included, and the recipe for frames that are read so.

    Raises SettingsError when both say it and differ, or for what a stream says itself.
    """
    given = asked.left_open("skip", "motion").given(*OF_READING)
    if "orientation" in given:
        raise SettingsError("Input orientation is for files: a stream's server says how its pixels run. Leave it out.")
    for name, value in given.items():
        if getattr(synchronizer, name) not in (value, getattr(SynchronizerSettings, name)):
            raise SettingsError(f"Input {name} must be that of the synchronizer, {getattr(synchronizer, name)!r}; got {value!r}.")
    return replace(synchronizer, **given), asked.left_open("time_offset", "longest_gap")


class LiveSession:
    """Reconstructs while scanning. Use it in a `with` block, or call `stop`.

    Ten parameters: what is reconstructed as in `reconstruct`, and what only a stream has.

    Parameters
    ----------
    source : QueueSource
        E.g. an `OpenIGTLinkClient`; started and stopped by the session.
    bone : BoneMap or None
        Needed by methods that weight by incidence.
    grid : VoxelGrid or None
        Where to reconstruct. None: in the configuration's box, else it begins by scouting; see `grid_from_scout` and `use_grid`.
    configuration : PlusConfiguration or None
        Gives calibration, names of frames, box, region, probe, method, spacing and skip where the other arguments leave them open.
    record : str, Path, Recorder or None
        A sequence file for every frame that is received, tracked or not.
    frame_limit : int or None
        End after so many frames.
    predictions_device : str or None
        An image device that sends what a network says of bone, with the time stamps of the images that it was made of. Its images are no
        frames: they wait in `predictions`, the newest few, until somebody takes them.
    longest_delay : float or None, s
        When the frames that wait to be inserted will take longer than this, some are left out, evenly, and counted. None: none is ever left
        out; the source then has to wait or to drop messages.

    Attributes
    ----------
    grid : VoxelGrid or None
        The voxels that are or will be filled.
    earlier : iterable of (LiveFrame, bool)
        To be set before `start`: frames that are recorded already and come before those of the source, and whether each counts.

    Raises
    ------
    SettingsError
        When the method needs a bone map and there is none.
    OutputError
        When the recording cannot be written. Troubles that show while frames come in end up in `error`.

    Notes
    -----
    Two threads: one takes messages, makes frames of them and records them; the other inserts. Watches work in
    `pool`. Frames are inserted in the order in which their images arrive, so with images in the order of their
    times the volume is, to the bit, that of `reconstruct` on the recording with the same grid, region and probe.
    Frames in are accounted for: ``frames_received = inserted + skipped + waiting`` in `statistics`.
    """

    def __init__(
        self,
        source: QueueSource,
        settings: Recipe | None = None,
        bone: BoneMap | None = None,
        grid: VoxelGrid | None = None,
        *,
        configuration: PlusConfiguration | None = None,
        synchronizer: SynchronizerSettings | None = None,
        record: str | Path | Recorder | None = None,
        frame_limit: int | None = None,
        predictions_device: str | None = None,
        longest_delay: float | None = 1.0,
    ):
        self._source = source
        self._configuration = configuration = configuration or NO_CONFIGURATION
        synchronizer, asked = _read_as_asked(synchronizer or SynchronizerSettings(), settings or Recipe())
        require_map_as_asked(asked, bone)
        if grid is not None:
            require_grid_as_asked(asked, grid)
        self.settings = resolve_settings(asked, configuration, bone is not None)
        parts = reconstructor_parts(asked, self.settings, configuration)
        self._fits_spacing = parts.fits_spacing
        self._method = self.settings.method_for(bone is not None)
        require_bone(self._method, self.settings, bone is not None)
        needs_probe = needs_beams(self._method, self.settings) or depth_factor(self.settings) != 1.0
        self._judges = method_named(self._method).needs_shadows
        self._of_volume = Recognition(asked, configuration, needs_probe, self._judges)
        self._of_watches = Recognition(asked, configuration, True, True)
        self._asked = asked
        self._prepared: Future[None] | None = None
        self._synchronizer = Synchronizer(synchronizer, configuration)
        self.recorder = record if record is None or isinstance(record, Recorder) else Recorder(record)
        self.recorded: Path | None = None
        self.finished = threading.Event()
        self.latest: LiveFrame | None = None
        self.recent: deque[LiveFrame] = deque(maxlen=2 * FRAMES_LOOKED_AT)
        self._frame_limit = frame_limit
        self.kept: list[LiveFrame] | None
        self.in_place: list[Matrix]
        self._forget_motion()
        self.at_end: Callable[[Progress | None], None] | None = None
        self._predictions_device = predictions_device
        self.predictions: deque[ImageMessage] = deque(maxlen=MOST_PREDICTIONS)
        names = self._synchronizer.settings
        sign = partial(
            with_origin,
            asked=replace(asked, image_to_reference=names.image_to_reference, reference=names.reference),
            resolved=self.settings,
            configuration=configuration,
            inputs=[] if configuration.path is None else [configuration.path],
        )
        self._inserter = Inserter(self.settings, bone, longest_delay, sign, parts)
        self.grid: VoxelGrid | None = grid or asked.grid or (None if names.image_to_reference or names.reference else parts.grid)
        self._lock, self._looking = threading.RLock(), threading.Lock()
        self.pool = ThreadPoolExecutor(MOST_WATCHES, "aifrecon live watch")
        self._look_from = 0
        self._phase = SCOUTING if self.grid is None else RECONSTRUCTING if self._of_volume.is_over else LOOKING
        self._scouted = ScoutedFrames()
        self._paused = self._started = self._closed = False
        self._heard, self._still = StreamHealth(), StillImages()
        self._collect_error: Exception | None = None
        self.earlier: Iterable[tuple[LiveFrame, bool]] = ()
        self._collector = threading.Thread(target=self._collect, name="aifrecon live reception", daemon=True)

    # ---- control

    def start(self) -> None:
        """Begin to receive: to scout without a grid, to reconstruct with one. Does nothing when called again. A session starts once."""
        with self._lock:
            if self._closed:
                raise RuntimeError("stop() was called: this session takes no more frames. Make a new one.")
            if self._started:
                return
            self._started = True
            self._start_inserting()
            self._source.start()
            self._collector.start()

    def prepare(self, timeout: float | None = None) -> bool:
        """Compile what inserts, make the volume and place the bone map before `start`, so that no frame waits for it; whether that is done.

        Without a grid, or with a probe or gray levels that the first frames are to show, no volume can be made yet.
        """
        with self._lock:
            self._start_inserting()
        return self._prepared is None or bool(wait([self._prepared], timeout).done)

    def pause(self) -> None:
        """Insert nothing until `resume`. Frames are still received, shown, recorded and counted."""
        self._paused = True

    def resume(self) -> None:
        """Go on after `pause`."""
        self._paused = False

    def reset(self) -> None:
        """Empty the volume and begin to count anew, on the same grid; frames that wait are forgotten. The recording goes on."""
        with self._lock:
            self._inserter.restart()
            self._forget_motion()
            if self._phase in (SCOUTING, LOOKING):
                self._scouted = ScoutedFrames()

    def grid_from_scout(self, spacing: float | tuple[float, float, float] | None = None, margin: float = 0.0) -> VoxelGrid:
        """The box around the frames seen since scouting began; raises as `reconstruct`, NoUsableFramesError where none was seen.

        Parameters
        ----------
        spacing : float, (x, y, z) or None, mm
            That of the settings by default.
        margin : float, mm
            Added on each side, for a scan that reaches farther.
        """
        with self._lock:
            fits = self._fits_spacing and spacing is None
            settings = self.settings if spacing is None else replace(self.settings, spacing=spacing)
            cost = bytes_per_voxel(self._method, self._inserter.bone_on_grid, self.settings.best_cosine, shares=True)
            return self._scouted.grid(self._find_imaging(self._scouted), settings, cost, margin, fits)

    def use_grid(self, grid: VoxelGrid) -> None:
        """Reconstruct on `grid` from now on, beginning with the frames seen while scouting that were kept."""
        with self._lock:
            self.grid = grid
            if not self._of_volume.is_over and self._scouted.usable < FRAMES_LOOKED_AT and not self._closed:
                self._phase = LOOKING
            else:
                self._begin(grid)

    def rebuild(self, kept: list[LiveFrame], motions: Matrix, bone: Steps[object], lines: tuple[str, ...]) -> Steps[bool]:
        """Make the volume anew, beside the one that grows, of frames that lie elsewhere, and put it in its place.

        Parameters
        ----------
        kept : list
            As `kept` was when the motions were looked for.
        motions : (n, 4, 4) array, mm
            What is to be done to the poses of its first n frames; those that follow, and those to come, go with the last.
        bone : steps
            What is to be done before the first frame is inserted, and after the bone was placed.
        lines : tuple of str
            What the volume is to say of it.

        Returns
        -------
        done : bool
            Not where the volume was emptied meanwhile, or there is none.
        """
        beside = self._inserter.beside()
        if beside is None:
            return False
        yield from bone
        moved = [_moved(frame, motion) for frame, motion in zip(kept, motions, strict=False)]
        for number, frame in enumerate(moved):
            beside.insert(frame)
            yield number / len(moved), "Laying passes on each other"
        with self._lock:
            if self.kept is not kept:
                return False
            self._motion = motions[-1]
            since = [_moved(frame, self._motion) for frame in kept[len(moved) :]]
            self._inserter.put_in_place(beside, since, lines)
            self.in_place = [frame.placed()[1] for frame in (*moved, *since)]
        return True

    def use_bone(self, bone: BoneMap) -> None:
        """Take another bone map, the CT having been placed anew, from `use_grid` or `reset` on; a volume that grows keeps its own."""
        self._inserter.use_bone(bone)

    def stop(self, progress: Progress | None = None) -> None:
        """Receive no more, insert and record what was received, and finish the recording. Can be called again.

        A recording that cannot be finished is no error of the reconstruction: see `recording_failure`.
        """
        with self._lock:
            closed, self._closed = self._closed, True
        if closed:
            return
        self._source.stop()
        if self._started:
            self._collector.join()
        self._close_scouting()
        if self.at_end is not None:
            self.at_end(part(progress, 0.0, 0.8))
        self._inserter.close()
        self.pool.shutdown(wait=False)
        self._phase = STOPPED
        self.finished.set()
        if self.recorder is not None:
            self.recorded = self.recorder.finish(part(progress, 0.8, 1.0))

    def finish(self, progress: Progress | None = None) -> Reconstruction | None:
        """`stop`, and the final volume, holes filled; None when there never was a grid. It can be asked for once."""
        self.stop(part(progress, 0.0, 0.7))
        return self._inserter.finish(part(progress, 0.7, 1.0))

    def __enter__(self) -> LiveSession:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    # ---- what is seen of it

    def snapshot(self, progress: Progress | None = None) -> Reconstruction | None:
        """The volume as it is now, holes filled; None before there is one. No frame is lost by it."""
        return self._inserter.snapshot(progress)

    def wait_for_rest(self, timeout: float) -> bool:
        """Return when next a frame was inserted and none waits, or after `timeout`, s; whether none waits."""
        return self._inserter.wait_for_rest(timeout)

    def imaging(self) -> Imaging | None:
        """Region, probe and gray levels of the images, as far as need be as the latest frames show them; None while these are too few.

        Raises
        ------
        BeamGeometryError
            When they cannot be told from these. Later ones are looked at again.
        """
        with self._looking:
            frames = [frame for frame in tuple(self.recent) if frame.status == "OK"]
            seen = self._of_watches
            if not seen.is_over and len(frames) >= FRAMES_LOOKED_AT and frames[-1].number >= self._look_from:
                self._look_from = frames[-1].number + FRAMES_LOOKED_AT
                seen.look_at(ScoutedFrames(frames))
            return seen.imaging if seen.is_over else None

    @property
    def scouted(self) -> int:
        """Tracked frames seen since scouting began."""
        return self._scouted.usable

    def devices(self) -> dict[str, tuple[str, ...]]:
        """Names of the devices that the source has seen, but for that of predictions, each with the types of its messages."""
        return {name: types for name, types in self._source.devices().items() if name != self._predictions_device}

    @property
    def error(self) -> Exception | None:
        """What stopped the reconstruction; `reset` or `use_grid` tries again. Volume and recording so far are not lost."""
        return self._collect_error or self._inserter.error

    @property
    def recording_failure(self) -> str | None:
        """Why the recording ended early or could not be finished, and where its frames are; None while all is well."""
        return None if self.recorder is None else self.recorder.failure

    @property
    def statistics(self) -> LiveStatistics:
        """A snapshot of everything that is counted."""
        # For the user, a failure matters more than a pause, and a pause more than what is paused
        phase = FAILED if self.error is not None and self._phase != STOPPED else PAUSED if self._paused else self._phase
        now, latest, recorder, pairing = time.monotonic(), self.latest, self.recorder, self._synchronizer
        counted, state, error = self._source.statistics, self._source.state, self.error
        images_stopped, poses_stopped = self._heard.stopped(now, None if latest is None else latest.received)
        troubles = (self._heard.trouble(now, lasts=state != CONNECTED), pairing.problem, pairing.note)
        return LiveStatistics(
            phase=phase,
            connection=state,
            tracking=NO_IMAGES if latest is None or images_stopped else tracking_words(latest.status, pairing.reference),
            dropped=counted.dropped,
            dropped_images=counted.dropped_images,
            repeated=pairing.repeated,
            other_images=pairing.other_images,
            recorded=0 if recorder is None else recorder.frames,
            recording_failure=self.recording_failure,
            trouble=message_of(error) if error is not None else next(filter(None, troubles), None),
            note=pairing.note,
            images_stopped=images_stopped,
            poses_stopped=poses_stopped,
            **self._inserter.counters.counts(now),
        )

    def _start_inserting(self) -> None:
        if self._prepared is not None:
            return
        self._prepared = self._inserter.start()
        if self._phase == RECONSTRUCTING and self.grid is not None:
            self._prepared = self._inserter.begin(self.grid, lambda: self._find_imaging(ScoutedFrames()))

    # ---- the receiving thread

    def _collect(self) -> None:
        try:
            for frame, counts in self.earlier:
                self._synchronizer.frames = frame.number + 1
                self._take_one(frame, live=False, counts=counts)
            while not self.finished.is_set():
                deadline, now = self._synchronizer.deadline, time.monotonic()
                message = self._source.get(POLL if deadline is None else min(max(deadline - now, 0.0), POLL))
                if message is None and self._source.state == ENDED:
                    break
                if isinstance(message, ImageMessage) and message.device == self._predictions_device:
                    self.predictions.append(message)
                    continue
                frames = self._synchronizer.expire(time.monotonic()) if message is None else self._synchronizer.feed(message)
                self._heard.note(message)
                self._take(frames)
            self._take(self._synchronizer.flush())
        except Exception as error:  # kept and reported: the volume so far, and the recording, must survive it
            self._collect_error = error
            logger.exception("The reception of a live scan ended")
        self.finished.set()

    def _take(self, frames: list[LiveFrame]) -> None:
        for frame in frames:
            if self._frame_limit is not None and frame.number >= self._frame_limit:
                break
            self._take_one(frame)
            if frame.number + 1 == self._frame_limit:
                self.finished.set()

    def _take_one(self, frame: LiveFrame, live: bool = True, counts: bool = True) -> None:
        is_left_out = frame.number % (self.settings.skip or 1) != 0
        if live and self.recorder is not None:
            self.recorder.append(frame)
        if not is_left_out:
            frame = self._still.judged(frame)
        if live:
            self.latest = _moved(frame, self._motion)
            self.recent.append(self.latest)
        with self._lock:
            self._inserter.counters.receive(frame.received)
            if not counts or (live and self._paused):
                self._inserter.counters.skip(WHILE_PAUSED)
            elif is_left_out:
                self._inserter.counters.skip(LEFT_OUT)
            elif self._phase == RECONSTRUCTING:
                self._put(frame, live)
            else:
                self._scouted.add(frame)
                if self.grid is not None and self._phase == LOOKING and self._scouted.usable >= FRAMES_LOOKED_AT:
                    self._begin(self.grid)

    def _put(self, frame: LiveFrame, live: bool) -> None:
        """Hand over a frame where it lies now, and keep it as it was recorded where motion is to be taken out."""
        if self.kept is not None and frame.image is not None and frame.status == "OK":
            alike = not self.kept or all(getattr(frame.image, name) == getattr(self.kept[0].image, name) for name in ("shape", "dtype"))
            if alike and len(self.kept) * frame.image.nbytes > MOST_KEPT_BYTES:
                self.kept = None
            elif alike:
                self.kept.append(frame)
        self._inserter.put(_moved(frame, self._motion), live)

    def _begin(self, grid: VoxelGrid) -> None:
        """Reconstruct from now on, what was scouted first."""
        scouted, self._scouted = self._scouted, ScoutedFrames()
        frames = list(scouted)

        def imaging() -> Imaging:
            found = self._find_imaging(scouted)
            scouted.clear()
            return found

        self._inserter.begin(grid, imaging)
        self._forget_motion()
        for frame in frames:
            self._put(frame, live=False)
        self._phase = RECONSTRUCTING

    def _forget_motion(self) -> None:
        self.kept = [] if self._asked.motion == AUTOMATIC else None
        self.in_place, self._motion = [], np.eye(4)

    def _close_scouting(self) -> None:
        """Account for the frames that still wait for a grid or for more of them."""
        with self._lock:
            if self.grid is not None and self._phase == LOOKING and self._scouted.usable:
                self._begin(self.grid)
            for frame in self._scouted:
                self._inserter.counters.skip(SCOUTED if frame.status == "OK" else frame.status)
            self._scouted.clear()

    def _find_imaging(self, scouted: ScoutedFrames) -> Imaging:
        """How the images are to be read: as given and configured, else recognized in the frames that were scouted."""
        known = self._of_volume.imaging
        if known is None or (scouted.usable and not self._of_volume.is_over):
            known = self._of_volume.look_at(scouted)
        gray_notes = known.gray_levels.notes if self._judges else ()
        return replace(known, notes=(*self._configuration.warnings, *known.notes, *gray_notes, *scouted.notes))


def _moved(frame: LiveFrame, motion: Matrix) -> LiveFrame:
    """A frame where it lies after a motion (4, 4), mm; one without a pose as it is."""
    pose = frame.image_to_reference
    return frame if pose is None else replace(frame, image_to_reference=motion @ pose)
