"""Frames in = frames inserted + frames accounted for: what the server sent against what the client says became of it."""

from __future__ import annotations

from dataclasses import dataclass

from AIFReconLib.live.session.session import LiveSession
from AIFReconLib.live.wire.client import OpenIGTLinkClient

from . import stream
from .ledger import AGAIN, DESTROYED, FOREIGN, UNUSABLE, WHOLE


@dataclass(frozen=True)
class Equation:
    """Two numbers that must be the same, in words."""

    says: str
    left: int
    right: int

    @property
    def holds(self) -> bool:
        """Whether they are."""
        return self.left == self.right

    def __str__(self) -> str:
        return f"{'holds' if self.holds else 'BROKEN'}  {self.says}: {self.left} = {self.right}"


def equations(told: dict, client: OpenIGTLinkClient, session: LiveSession, taken: int) -> list[Equation]:
    """Everything that must add up once the stream is over.

    Parameters
    ----------
    told : dict
        The server's account; see `FaultyServer.told`.
    client : OpenIGTLinkClient
    session : LiveSession
        Stopped.
    taken : int
        Images of the scan that the session took from the client.
    """
    fates, stream_, frames = told["fates"], client.statistics, session.statistics
    images = stream_.count("IMAGE")
    foreign = stream_.count("IMAGE", stream.OTHER_DEVICE)
    told_of = frames.frames_received + frames.repeated + frames.other_images
    sent = sum(fates.values())
    out = [
        Equation("image messages sent = destroyed on the wire + arrived", sent, fates[DESTROYED] + images),
        Equation("messages that make no sense: sent = refused", fates[UNUSABLE], stream_.refused),
        Equation("images of the other device: sent = arrived", fates[FOREIGN], foreign),
        Equation(
            "images that arrived = frames + sent again + of the other device + refused + dropped",
            images,
            told_of + stream_.refused + frames.dropped_images,
        ),
        Equation(
            "images of the scan sent whole = taken + dropped",
            fates[WHOLE] + fates[AGAIN] + fates[FOREIGN],
            taken + stream_.dropped_images,
        ),
        Equation(
            "frames = inserted + skipped by reason + waiting",
            frames.frames_received,
            frames.inserted + frames.frames_skipped + frames.waiting,
        ),
        Equation("frames that wait = none", frames.waiting, 0),
    ]
    if session.recorder is not None:
        out.append(Equation("frames = recorded", frames.frames_received, frames.recorded))
    return out
