"""Opening a connection, in a way that can be stopped and says in plain words why it failed."""

from __future__ import annotations

import errno
import selectors
import socket
import sys
import time
from collections.abc import Callable

from ...errors import LiveConnectionError, SettingsError

POLL = 0.05
"""How often a waiting socket looks whether it must stop, s."""

_KEEP_ALIVE = {"TCP_KEEPIDLE": 5, "TCP_KEEPALIVE": 5, "TCP_KEEPINTVL": 2, "TCP_KEEPCNT": 4}
_UNREACHABLE = (errno.ENETUNREACH, errno.EHOSTUNREACH, getattr(errno, "EHOSTDOWN", errno.EHOSTUNREACH))
_IN_PROGRESS = (0, errno.EINPROGRESS, errno.EWOULDBLOCK, getattr(errno, "WSAEWOULDBLOCK", errno.EWOULDBLOCK))


def check_port(port: int, lowest: int = 1) -> int:
    """`port`, if it is one.

    Raises SettingsError otherwise.
    """
    if not isinstance(port, int) or isinstance(port, bool) or not lowest <= port <= 65535:
        raise SettingsError(f"Input port must be a whole number from {lowest} to 65535; got {port!r}. Plus listens on 18944.")
    return port


def open_connection(host: str, port: int, timeout: float, stopped: Callable[[], bool]) -> socket.socket | None:
    """A connected socket whose operations time out after `POLL` seconds; None if it was stopped meanwhile.

    Parameters
    ----------
    host : str
    port : int
    timeout : float, s
        For connecting, once the name is resolved. Resolving it is up to the operating system and cannot be stopped.
    stopped : function () -> bool

    Raises
    ------
    LiveConnectionError
        Saying whether the host was not found, refuses, or does not answer.
    """
    try:
        addresses = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)
    except (OSError, UnicodeError) as error:
        reason = getattr(error, "strerror", None) or "not a host name"
        raise LiveConnectionError(f"Host {host!r} cannot be found ({reason}). Check its name, or give its IP address.") from None
    deadline = time.monotonic() + timeout
    code = errno.ETIMEDOUT
    for family, kind, protocol, _, address in addresses:
        connection, opened = socket.socket(family, kind, protocol), False
        try:
            code = _connect(connection, address, deadline, stopped)
            if code == 0 and not stopped():
                _prepare(connection)
                opened = True
                return connection
        finally:
            if not opened:
                connection.close()
        if stopped():
            return None
    raise _failure(code, host, port, timeout)


def _connect(connection: socket.socket, address: tuple[str | int | bytes, ...], deadline: float, stopped: Callable[[], bool]) -> int:
    """Connect; returns 0, or the error's number."""
    connection.setblocking(False)
    code = connection.connect_ex(address)
    if code not in _IN_PROGRESS:
        return code
    with selectors.DefaultSelector() as selector:
        selector.register(connection, selectors.EVENT_WRITE)
        while not stopped():
            if selector.select(POLL):
                return connection.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR)
            if time.monotonic() > deadline:
                return errno.ETIMEDOUT
    return errno.ECANCELED


def _prepare(connection: socket.socket) -> None:
    """Let the operating system notice within seconds that the other machine is gone, where it can."""
    connection.settimeout(POLL)
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for name, value in _KEEP_ALIVE.items():
        # TCP_KEEPALIVE is the idle time on macOS; where TCP_KEEPIDLE is known, that is
        if hasattr(socket, name) and not (name == "TCP_KEEPALIVE" and sys.platform != "darwin"):
            connection.setsockopt(socket.IPPROTO_TCP, getattr(socket, name), value)


def _failure(code: int, host: str, port: int, timeout: float) -> LiveConnectionError:
    if code in (errno.ECONNREFUSED, getattr(errno, "WSAECONNREFUSED", errno.ECONNREFUSED)):
        return LiveConnectionError(
            f"{host} has no server on port {port}. Start the server there (PlusServer), and check the port in its configuration."
        )
    if code in _UNREACHABLE:
        return LiveConnectionError(f"{host} cannot be reached. Check the network, and that the machine is on.")
    if code in (errno.ETIMEDOUT, getattr(errno, "WSAETIMEDOUT", errno.ETIMEDOUT)):
        return LiveConnectionError(
            f"{host} does not answer on port {port} within {timeout:g} s. Check that the machine is on, that it is on this network, "
            "and that its firewall admits the port."
        )
    try:
        reason = errno.errorcode[code]
    except KeyError:
        reason = f"error {code}"
    return LiveConnectionError(f"{host}, port {port}, cannot be connected to ({reason}). Check host and port.")
