"""The client: a connection to an OpenIGTLink server that keeps itself alive and hands on every message in order.

pyigtl decodes, but the connection is our own: its client keeps the newest message of each device only, checks no checksum, and notices
neither the end of a stream nor a stall.
"""

from __future__ import annotations

import logging
import socket
import threading
import time

from ...errors import LiveConnectionError, LiveMessageError, SettingsError
from ...message import message_of
from .connection import check_port, open_connection
from .decoding import codec, decode
from .encoding import encode_status_request
from .framing import SIZE_LIMIT, Framer, RawMessage
from .messages import EventKind, StreamEvent
from .sources import CONNECTED, QueueSource

logger = logging.getLogger(__name__)

CONNECTING, WAITING = "connecting", "waiting to reconnect"

CHUNK = 2**18
"""Bytes asked of the operating system at a time."""

EVENT_INTERVAL = 1.0
"""Shortest time between two events about messages that are refused, s: it may be every one."""

IN_THE_MIDDLE = " in the middle of a message"

STOP_TIMEOUT = 0.8
RESOLVING_TIMEOUT = 10.0


class OpenIGTLinkClient(QueueSource):
    """Receives from a server, in a thread of its own, until it is stopped. It starts once; make another for another scan.

    Eight parameters: an address, what is taken, and limits that a test or a slow network may want otherwise.

    Parameters
    ----------
    port : int
        Plus listens on 18944.
    queue_size : int
        Messages that wait to be taken; beyond it the oldest are dropped and counted.
    queue_bytes : int
        Bytes of pixels that wait to be taken.
    size_limit : int
        Bytes of a message body at most.
    stall_after : float, s
        Without a message for so long, the stream has stalled.
    connect_timeout : float, s
    retry_delays : tuple of float, s
        Pauses between attempts to connect; the last one repeats. They begin anew once a message has arrived.

    Notes
    -----
    All methods may be called from any thread. The state is ``connecting``, ``connected``, ``waiting to reconnect`` or ``stopped``. The
    first message sent on every connection is a GET_STATUS of header version 2, because Plus then adds metadata and statuses. A stream
    that is no longer one of messages is given up, and the client connects again.

    Examples
    --------
    >>> with OpenIGTLinkClient("localhost", 18944) as client:  # doctest: +SKIP
    ...     message = client.get(timeout=1.0)
    """

    def __init__(
        self,
        host: str,
        port: int,
        *,
        queue_size: int = 512,
        queue_bytes: int = 256 * 2**20,
        size_limit: int = SIZE_LIMIT,
        stall_after: float = 2.0,
        connect_timeout: float = 3.0,
        retry_delays: tuple[float, ...] = (0.5, 1.0, 2.0, 5.0),
    ):
        if not isinstance(host, str) or not host.strip():
            raise SettingsError(f"Input host must be a host name or an IP address; got {host!r}.")
        if queue_size < 1 or queue_bytes < 1 or size_limit < 1 or stall_after <= 0 or connect_timeout <= 0 or not retry_delays:
            raise SettingsError("Input limits and times of a client must be positive, and retry_delays must not be empty.")
        super().__init__(queue_size, queue_bytes)
        self.host = host.strip()
        self.port = check_port(port)
        self._size_limit = size_limit
        self._stall_after = stall_after
        self._connect_timeout = connect_timeout
        self._retry_delays = tuple(retry_delays)
        self._state = CONNECTING
        self._refusal_told = -EVENT_INTERVAL
        self._stopping, self._attempted = threading.Event(), threading.Event()
        self._first_error: LiveConnectionError | None = None
        self._thread = threading.Thread(target=self._work, name=f"OpenIGTLink {self.host}:{self.port}", daemon=True)

    def start(self, wait: bool = False) -> None:
        """Begin to connect and receive; does nothing when called again.

        Parameters
        ----------
        wait : bool
            Wait for the outcome of the first attempt. If it fails the client is stopped again.

        Raises
        ------
        LiveConnectionError
            With `wait`, when the first attempt fails; always, when pyigtl is not installed.
        """
        codec()
        with self._changed:
            if self._open and self._thread.ident is None:
                self._thread.start()
        if wait:
            decided = self._attempted.wait(self._connect_timeout + RESOLVING_TIMEOUT)
            if not decided or self._first_error:
                self.stop()
                raise self._first_error or LiveConnectionError(
                    f"Host {self.host!r} was not found in {RESOLVING_TIMEOUT:g} s. Check its name, or give its IP address."
                )

    def stop(self) -> None:
        """Disconnect; returns within a second, whatever the client is doing. What was received can still be taken."""
        self._stopping.set()
        super().stop()
        if self._thread.ident is not None and self._thread is not threading.current_thread():
            self._thread.join(STOP_TIMEOUT)

    def __enter__(self) -> OpenIGTLinkClient:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    # ---- the thread

    def _work(self) -> None:
        failed = connections = 0
        while not self._stopping.is_set():
            self._state = CONNECTING
            before, reason = self._counts.received.total(), ""
            try:
                connection = open_connection(self.host, self.port, self._connect_timeout)
            except LiveConnectionError as error:
                reason = message_of(error)
                self._first_error = None if self._attempted.is_set() else error
            else:
                with connection:
                    self._attempted.set()
                    self._counts.reconnects, connections = connections, connections + 1
                    reason = self._serve(connection)
            if self._stopping.is_set():
                return
            if self._counts.received.total() > before:
                failed = 0
            delay = self._retry_delays[min(failed, len(self._retry_delays) - 1)]
            failed += 1
            self._state = WAITING
            self._attempted.set()
            self._emit("disconnected", f"{reason} Connecting again in {delay:g} s.", logging.WARNING)
            self._stopping.wait(delay)

    def _serve(self, connection: socket.socket) -> str:
        """Receive until the connection ends, and say why it did."""
        self._state = CONNECTED
        self._emit("connected", f"Connected to {self.host}, port {self.port}.", logging.INFO)
        framer = Framer(self._size_limit)
        try:
            connection.sendall(encode_status_request())
            ended = self._receive_all(connection, framer)
        except OSError as error:
            ended = f"The connection was lost ({error.strerror or 'the network failed'})"
        return f"{ended}{IN_THE_MIDDLE * framer.is_within}."

    def _receive_all(self, connection: socket.socket, framer: Framer) -> str:
        """Receive until the stream ends, makes no sense any more or the client is stopped, and say which."""
        buffer = bytearray(CHUNK)
        last, stalled = time.monotonic(), False
        while not self._stopping.is_set():
            size = _receive(connection, buffer)
            now = time.monotonic()
            if size == 0:
                return "The server closed the connection"
            messages = framer.feed(memoryview(buffer)[:size]) if size else []
            for message in messages:
                self._take(message, now)
            if framer.problem is not None:
                return framer.problem
            if messages:
                last, stalled = now, False
            elif not stalled and now - last > self._stall_after:
                stalled, seen = True, f"nothing arrived{IN_THE_MIDDLE * framer.is_within}"
                self._emit("stalled", f"For {now - last:.1f} s {seen}. Waiting; check {self.host}, and the network.", logging.WARNING)
        return "The client was stopped"

    def _take(self, message: RawMessage, now: float) -> None:
        """Count a message, and queue what it holds; where that cannot be used, tell why, but not too often: counters tell the rest."""
        if message.problem is None:
            self._count(message.device, message.kind)
        try:
            for content in decode(message, now):
                self._queue(content)
        except LiveMessageError as error:
            why = message_of(error)
            with self._changed:
                self._counts.damaged += message.problem is not None
                self._counts.refused += message.problem is None
                self._counts.refusals[message.kind] = why
            if now - self._refusal_told >= EVENT_INTERVAL:
                self._refusal_told = now
                self._emit("refused", why, logging.WARNING)

    def _emit(self, kind: EventKind, detail: str, level: int) -> None:
        logger.log(level, "%s", detail)
        self._queue(StreamEvent(kind, detail, time.monotonic()))


def _receive(connection: socket.socket, buffer: bytearray) -> int | None:
    """Bytes received into `buffer`: 0 at the end of the stream, None if there are none for now."""
    try:
        return connection.recv_into(buffer)
    except TimeoutError as error:
        if error.errno is not None:  # not our own short time limit, but the operating system's: the other machine is gone
            raise
        return None
