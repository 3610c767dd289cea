"""`aifrecon replay`: serve a recording as a Plus server would."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import Annotated, ClassVar

from ..io.sequence.files import read_sequence
from ..live.replay.server import PLUS_PORT, ReplayServer
from ..terminal.arguments import Names
from ..terminal.sequence_options import TrackingOptions, configured


class _ReplayOptions(TrackingOptions):
    """Send a tracked sequence over OpenIGTLink with the device names, shared time stamps and statuses of a Plus server. It begins when the
    first client connects and serves until Ctrl-C, which is no error.

    Parameters
    ----------
    sequence : SEQUENCE
        tracked frames, e.g. sweep.igs.mha
    port : P
        0: any free one (default: 18944, as Plus)
    host : ADDRESS
        address to listen on; 0.0.0.0 admits other machines
    rate : FPS
        frames per second (default: the recorded times)
    loop
        begin again at the end
    header_version
        of every message (default: 1 until the client sends one of 2, as Plus)
    transform : NAME
        send this transform, e.g. ProbeToReference; may be given several times (default: the recorded ones and the image's)
    send_invalid
        send invalid transforms too, as identity (default: leave them out)

    Examples
    --------
      aifrecon replay sweep.igs.mha --config PlusDeviceSet.xml
      aifrecon replay sweep.igs.mha --config PlusDeviceSet.xml --loop --rate 30
      aifrecon live --port 18944 --output volume.nrrd        (in a second terminal)
    """

    sequence: Path
    port: int = PLUS_PORT
    host: str = "127.0.0.1"
    rate: float | None = None
    loop: bool = False
    header_version: Annotated[int, (1, 2)] | None = None
    transform: list[str] = []
    send_invalid: bool = False

    WORDS: ClassVar[Names] = ("sequence",)


def run(asked: _ReplayOptions) -> None:
    """Serve until interrupted."""
    ((path, config),) = configured(asked, [asked.sequence])
    server = ReplayServer(
        read_sequence(path, config=config),
        asked.port,
        asked.host,
        rate=asked.rate,
        loop=asked.loop,
        header_version=asked.header_version,
        image_to_reference=asked.image_to_reference,
        reference=asked.reference,
        transforms=asked.transform or None,
        valid_only=not asked.send_invalid,
    )
    # A server is stopped by an interrupt, so that is how it ends well
    with suppress(KeyboardInterrupt), server:
        print(f"{server.describe()}\nCtrl-C stops it.", flush=True)
        server.serve_until_stopped()
    left_out = f"; slow clients missed {server.dropped}" if server.dropped else ""
    print(f"\nStopped. Sent {server.sent} frames to {server.served} client{'s' if server.served != 1 else ''}{left_out}.")
