"""`aifrecon replay`: serve a recording as a Plus server would."""

from __future__ import annotations

import argparse
from contextlib import suppress
from pathlib import Path

from ..io.sequence.files import read_sequence
from ..live.replay.server import PLUS_PORT, ReplayServer
from ..terminal.options import Commands
from ..terminal.sequence_options import add_tracking_options

EXAMPLE = """examples:
  aifrecon replay sweep.igs.mha --config PlusDeviceSet.xml
  aifrecon replay sweep.igs.mha --config PlusDeviceSet.xml --loop --rate 30
  aifrecon live --port 18944 --output volume.nrrd        (in a second terminal)"""


def add_to(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "replay",
        description="Send a tracked sequence over OpenIGTLink with the device names, shared time stamps and statuses of a Plus server. "
        "It begins when the first client connects and serves until Ctrl-C, which is no error.",
        examples=EXAMPLE,
    )
    parser.add_argument("sequence", type=Path, metavar="SEQUENCE", help="tracked frames, e.g. sweep.igs.mha")
    server = parser.add_argument_group("server")
    server.add_argument("--port", type=int, default=PLUS_PORT, metavar="P", help="0: any free one (default: %(default)s, as Plus)")
    server.add_argument(
        "--host", default="127.0.0.1", metavar="ADDRESS", help="address to listen on; 0.0.0.0 admits other machines (default: %(default)s)"
    )
    server.add_argument("--rate", type=float, metavar="FPS", help="frames per second (default: the recorded times)")
    server.add_argument("--loop", action="store_true", help="begin again at the end")
    server.add_argument(
        "--header-version", type=int, choices=(1, 2), help="of every message (default: 1 until the client sends one of 2, as Plus)"
    )
    server.add_argument(
        "--transform",
        action="append",
        metavar="NAME",
        help="send this transform, e.g. ProbeToReference; may be given several times (default: the recorded ones and the image's)",
    )
    server.add_argument("--send-invalid", action="store_true", help="send invalid transforms too, as identity (default: leave them out)")
    add_tracking_options(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> None:
    """Serve until interrupted."""
    server = ReplayServer(
        read_sequence(arguments.sequence, config=arguments.config),
        arguments.port,
        arguments.host,
        rate=arguments.rate,
        loop=arguments.loop,
        header_version=arguments.header_version,
        image_to_reference=arguments.image_to_reference,
        reference=arguments.reference,
        transforms=arguments.transform,
        valid_only=not arguments.send_invalid,
    )
    # A server is stopped by an interrupt, so that is how it ends well
    with suppress(KeyboardInterrupt), server:
        print(f"{server.describe()}\nCtrl-C stops it.", flush=True)
        server.serve_until_stopped()
    left_out = f"; slow clients missed {server.dropped}" if server.dropped else ""
    left_out += f"; {server.turned_away} more were turned away" if server.turned_away else ""
    print(f"\nStopped. Sent {server.sent} frames to {server.served} client{'s' if server.served != 1 else ''}{left_out}.")
