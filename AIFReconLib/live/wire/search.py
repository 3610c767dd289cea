"""Where a scanner's server answers: on this computer first, then where one has been before. Nobody else's computer is asked."""

from __future__ import annotations

import socket

from ...progress import Progress, report

Server = tuple[str, int]
"""Host and port."""

LOCALHOST = "127.0.0.1"
PORTS = (18944, 18945, 18946, 18947)
"""That Plus gives to its servers, one after the other."""

PATIENCE = 0.5
"""s for an answer: a server in the next room takes some milliseconds."""

MOST_REMEMBERED = 5


def answering(remembered: list[Server], progress: Progress | None = None) -> Server | None:
    """The first server that takes a connection, as (host, port), here or among those that are remembered; None where none does."""
    servers = list(dict.fromkeys([*((LOCALHOST, port) for port in PORTS), *remembered]))
    for number, (host, port) in enumerate(servers):
        report(progress, number / len(servers), f"Asking {host}, port {port}")
        try:
            socket.create_connection((host, port), PATIENCE).close()
        except OSError:
            continue
        return host, port
    return None


def from_text(text: str) -> list[Server]:
    """Servers that `as_text` has written; what cannot be understood is left out."""
    pairs = (each.rpartition(" ") for each in text.split(";"))
    return [(host, int(port)) for host, _space, port in pairs if host and port.isdecimal()]


def as_text(servers: list[Server]) -> str:
    """Servers as one line for the settings, the newest first."""
    return ";".join(f"{host} {port}" for host, port in dict.fromkeys(servers[:MOST_REMEMBERED]))
