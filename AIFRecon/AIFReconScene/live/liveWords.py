"""What the tab Live says of a scan: in large letters whether the probe is seen and what to do next, and in small ones what is counted."""

import time
from dataclasses import dataclass

from slicer.i18n import tr as _

from AIFReconLib.live.wire.sources import CONNECTED

from ..panelWords import inPanelWords


@dataclass(frozen=True)
class LiveWords:
    """What is said in large letters."""

    state: str  #: Whether the probe is seen, or what is wrong
    isWell: bool  #: Whether all is as it should be
    move: str  #: What the person with the probe is to do now
    isScouting: bool  #: Whether the box is still to be found

    @classmethod
    def of(cls, live, advised: str) -> "LiveWords":
        """The words of a `LiveReconstruction`, with what guidance says to do next (empty: nothing)."""
        statistics = live.statistics
        failed, apart = statistics.phase == "failed", False
        scouting = live.seen.is_scouting
        isSeen = statistics.tracking == "tracked"
        tracking = _("Probe seen") if isSeen else _stopped(statistics) or statistics.tracking
        tracked = isSeen and not failed and not live.lost
        if live.lost and not failed:
            state = _("Going on in a moment")
        elif failed:
            state = _("Error: the picture no longer grows")
        elif scouting:
            state = _("Quick first scan") if tracked else tracking
        else:
            state = _("Paused") if statistics.phase == "paused" else tracking
        if tracked and live.seen.has_fallen:
            state, apart = _("The CT no longer fits"), True
        return cls(state, tracked and not apart, _nextMove(live, tracked, scouting, apart, advised), scouting)


def linesOf(live) -> list:
    """What is counted of a `LiveReconstruction`, and what is wrong, line by line; each line once."""
    statistics, seen = live.statistics, live.seen
    lines = [] if statistics.phase == "failed" else [_rate(statistics)]
    lines.append(counts(statistics))
    told = (*seen.bone_lines, seen.agreement, live.lost, statistics.trouble, live.displayProblem, *seen.problems)
    lines += [inPanelWords(line) for line in told if line]
    return list(dict.fromkeys(lines))


def counts(statistics) -> str:
    """Where the frames went."""
    message = _("{inserted} of {received} frames added to the picture").format(
        inserted=statistics.inserted, received=statistics.frames_received
    )
    reasons = "; ".join(f"{count} {reason}" for reason, count in statistics.skipped.items())
    return message + (f" ({reasons})" if reasons else "")


def _nextMove(live, tracked: bool, scouting: bool, apart: bool, advised: str) -> str:
    statistics = live.statistics
    if live.lost and statistics.phase != "failed":
        return _("Hold the probe still")
    if statistics.phase == "failed":
        return _("Press “Start over...”, or Stop; why is under “More”")
    if apart:
        return _("Press “Place CT on sweep”")
    if statistics.phase == "paused":
        return _("Press Pause again to go on")
    if not tracked:
        return _whatToCheck(statistics)
    if scouting and not advised:
        return _("Scan the area once, then press “Use the scanned area”")
    return advised or _("Keep scanning")


def _stopped(statistics) -> str:
    """Which of images and positions come no more, and since when; empty while images come."""
    if statistics.images_stopped is None:
        return ""
    message = _("No images since {time}") if statistics.poses_stopped is None else _("No images, no positions since {time}")
    return message.format(time=_clock(statistics.images_stopped))


def _whatToCheck(statistics) -> str:
    if not statistics.frames_received and statistics.images_stopped is None:
        return _("Check Plus, and the connection below")
    if statistics.connection != CONNECTED:
        return _("The connection is lost: check Plus and the network")
    if statistics.images_stopped is not None:
        return _("Connected, but nothing comes: check Plus and the scanner")
    if statistics.poses_stopped is not None:
        message = _("No positions since {time}: check the tracker, and bring into its view what is not seen")
        return message.format(time=_clock(statistics.poses_stopped))
    return _("Bring what is not seen into the tracker's view")


def _clock(ago: float) -> str:
    """The time of day so many s ago."""
    return time.strftime("%H:%M:%S", time.localtime(time.time() - ago))


def _rate(statistics) -> str:
    """Rate and latency of what comes, and from where."""
    unknown = statistics.latency_p50 != statistics.latency_p50
    latency = _("no latency yet") if unknown else _("latency {latency:.0f} ms").format(latency=1000 * statistics.latency_p50)
    return _("{rate:.0f} frames/s, {latency}; {connection}").format(
        rate=statistics.frame_rate, latency=latency, connection=statistics.connection
    )
