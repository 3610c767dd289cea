"""Opening a connection, and in plain words why it failed."""

from __future__ import annotations

import errno
import socket
import sys

from ...errors import LiveConnectionError, SettingsError

POLL = 0.05
"""How often a waiting socket looks whether it must stop, s."""

_KEEP_ALIVE = {"TCP_KEEPIDLE": 5, "TCP_KEEPALIVE": 5, "TCP_KEEPINTVL": 2, "TCP_KEEPCNT": 4}
_UNREACHABLE = (errno.ENETUNREACH, errno.EHOSTUNREACH, getattr(errno, "EHOSTDOWN", errno.EHOSTUNREACH))


def check_port(port: int, lowest: int = 1) -> int:
    """`port`, if it is one.

    Raises SettingsError otherwise.
    """
    if not isinstance(port, int) or isinstance(port, bool) or not lowest <= port <= 65535:
        raise SettingsError(f"Input port must be a whole number from {lowest} to 65535; got {port!r}. Plus listens on 18944.")
    return port


def open_connection(host: str, port: int, timeout: float) -> socket.socket:
    """A connected socket whose operations time out after `POLL` seconds.

    Raises LiveConnectionError saying whether the host was not found, refuses, or does not answer within `timeout` s. How long the search
    for its name takes is up to the operating system.
    """
    try:
        connection = socket.create_connection((host, port), timeout)
    except (socket.gaierror, UnicodeError) as error:
        reason = getattr(error, "strerror", None) or "not a host name"
        raise LiveConnectionError(f"Host {host!r} cannot be found ({reason}). Check its name, or give its IP address.") from None
    except OSError as error:
        raise LiveConnectionError(_why_not_connected(error, host, port, timeout)) from None
    # The operating system notices within seconds that the other machine is gone, where it can
    connection.settimeout(POLL)
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for name, value in _KEEP_ALIVE.items():
        # TCP_KEEPALIVE is the idle time on macOS; where TCP_KEEPIDLE is known, that is
        if hasattr(socket, name) and not (name == "TCP_KEEPALIVE" and sys.platform != "darwin"):
            connection.setsockopt(socket.IPPROTO_TCP, getattr(socket, name), value)
    return connection


def _why_not_connected(error: OSError, host: str, port: int, timeout: float) -> str:
    if isinstance(error, ConnectionRefusedError):
        return f"{host} has no server on port {port}. Start the server there (PlusServer), and check the port in its configuration."
    if isinstance(error, TimeoutError):
        return (
            f"{host} does not answer on port {port} within {timeout:g} s. Check that the machine is on, that it is on this network, "
            "and that its firewall admits the port."
        )
    if error.errno in _UNREACHABLE:
        return f"{host} cannot be reached. Check the network, and that the machine is on."
    reason = errno.errorcode.get(error.errno or 0, f"error {error.errno}")
    return f"{host}, port {port}, cannot be connected to ({reason}). Check host and port."
