"""The client: a connection to an OpenIGTLink server that keeps itself alive and hands on every message in order.

pyigtl decodes, but the connection is our own: its client keeps the newest message of each device only, checks no checksum, and notices
neither the end of a stream nor a stall.
"""

from __future__ import annotations

import logging
import socket
import threading
import time
from collections import Counter
from dataclasses import replace

from ...errors import LiveConnectionError, LiveMessageError, SettingsError
from ...message import message_of
from .connection import check_port, open_connection
from .decoding import codec, decode
from .encoding import encode_status_request
from .framing import SIZE_LIMIT, Framer, RawMessage
from .messages import EventKind, StreamEvent
from .sources import CONNECTED, DEVICES, ENDED, QueueSource, StreamStatistics

logger = logging.getLogger(__name__)

CONNECTING, WAITING = "connecting", "waiting to reconnect"

CHUNK = 2**18
"""Bytes asked of the operating system at a time."""

EVENT_INTERVAL = 1.0
"""Shortest time between two events about messages that are refused, s: it may be every one."""

OTHERS = "(others)"

IN_THE_MIDDLE = " in the middle of a message"

STOP_TIMEOUT = 0.8
RESOLVING_TIMEOUT = 10.0


class OpenIGTLinkClient(QueueSource):
    """Receives from a server, in a thread of its own, until it is stopped.

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
    `start` and `stop` may be called in any order and any number of times. All methods may be called from any thread. The first message
    sent on every connection is a GET_STATUS of header version 2, because Plus then adds metadata and statuses. A stream that is no longer
    one of messages is given up, and the client connects again.

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
        self._control = threading.Lock()
        self._lock = threading.Lock()
        self._stopping, self._attempted = threading.Event(), threading.Event()
        self._begin_anew(is_open=False)

    def _begin_anew(self, is_open: bool = True) -> None:
        super()._begin_anew(is_open)
        self._received: Counter[tuple[str, str]] = Counter()
        self._refusals: dict[str, str] = {}
        self._refused = self._damaged = self._connections = 0
        self._refusal_told = -EVENT_INTERVAL
        self._first_error: LiveConnectionError | None = None
        self._state = CONNECTING

    # ---- control

    def start(self, wait: bool = False) -> None:
        """Begin to connect and receive; does nothing if it is running.

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
        with self._control:
            if not self._open:
                # A thread that outlives its stop, for the name of a host is resolved, sees its own event
                self._stopping, self._attempted = stopping, attempted = threading.Event(), threading.Event()
                self._begin_anew()
                name = f"OpenIGTLink {self.host}:{self.port}"
                self._thread = threading.Thread(target=self._work, args=(stopping, attempted), name=name, daemon=True)
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
        with self._control:
            was_open = self._open
            self._stopping.set()
            super().stop()
        if was_open and self._thread is not threading.current_thread():
            self._thread.join(STOP_TIMEOUT)

    def __enter__(self) -> OpenIGTLinkClient:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    # ---- what was received

    @property
    def state(self) -> str:
        """``connecting``, ``connected``, ``waiting to reconnect`` or ``stopped``."""
        return self._state if self._open else ENDED

    @property
    def statistics(self) -> StreamStatistics:
        """A snapshot of all counters since `start`, over all connections."""
        with self._lock:
            return replace(
                super().statistics,
                received=dict(self._received),
                refused=self._refused,
                damaged=self._damaged,
                reconnects=max(0, self._connections - 1),
                refusals=dict(self._refusals),
            )

    def devices(self) -> dict[str, tuple[str, ...]]:
        """Names of the devices seen since `start`, each with the types of its messages, in order of appearance."""
        seen: dict[str, tuple[str, ...]] = {}
        for device, kind in self.statistics.received:
            seen[device] = (*seen.get(device, ()), kind)
        return seen

    # ---- the thread

    def _work(self, stopping: threading.Event, attempted: threading.Event) -> None:
        attempt = 0
        while not stopping.is_set():
            self._state = CONNECTING
            reason, before = "", self._received.total()
            try:
                connection = open_connection(self.host, self.port, self._connect_timeout)
            except LiveConnectionError as error:
                if stopping.is_set():
                    break
                reason = message_of(error)
                self._first_error = None if attempted.is_set() else error
            else:
                with connection:
                    if stopping.is_set():
                        break
                    attempted.set()
                    reason = self._serve(connection, stopping)
            if stopping.is_set():
                break
            if self._received.total() > before:
                attempt = 0
            delay = self._retry_delays[min(attempt, len(self._retry_delays) - 1)]
            attempt += 1
            self._state = WAITING
            attempted.set()
            self._emit("disconnected", f"{reason} Connecting again in {delay:g} s.", logging.WARNING)
            stopping.wait(delay)

    def _serve(self, connection: socket.socket, stopping: threading.Event) -> str:
        """Receive until the connection ends, and say why it did."""
        with self._lock:
            self._connections += 1
        self._state = CONNECTED
        self._emit("connected", f"Connected to {self.host}, port {self.port}.", logging.INFO)
        framer = Framer(self._size_limit)
        try:
            connection.sendall(encode_status_request())
            ended = self._receive_all(connection, framer, stopping)
        except OSError as error:
            ended = f"The connection was lost ({error.strerror or 'the network failed'})"
        return f"{ended}{IN_THE_MIDDLE * framer.is_within}."

    def _receive_all(self, connection: socket.socket, framer: Framer, stopping: threading.Event) -> str:
        """Receive until the stream ends, makes no sense any more or the client is stopped, and say which."""
        buffer = bytearray(CHUNK)
        view = memoryview(buffer)
        last, stalled = time.monotonic(), False
        while not stopping.is_set():
            size = _receive(connection, buffer)
            now = time.monotonic()
            if size == 0:
                return "The server closed the connection"
            messages = framer.feed(view[:size]) if size else []
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
        """Count a message, and queue what it holds."""
        if message.problem is not None:
            with self._lock:
                self._damaged += 1
            self._refuse(message.kind, message.problem, now)
            return
        with self._lock:
            key = message.device, message.kind
            self._received[key if key in self._received or len(self._received) < DEVICES else (OTHERS, OTHERS)] += 1
        try:
            for content in decode(message, now):
                self.put(content)
        except LiveMessageError as error:
            with self._lock:
                self._refused += 1
            self._refuse(message.kind, message_of(error), now)

    def _refuse(self, kind: str, why: str, now: float) -> None:
        """Tell why a message is left out; at most once in a while, because counters tell the rest."""
        with self._lock:
            self._refusals[kind] = why
        if now - self._refusal_told >= EVENT_INTERVAL:
            self._refusal_told = now
            self._emit("refused", why, logging.WARNING)

    def _emit(self, kind: EventKind, detail: str, level: int) -> None:
        logger.log(level, "%s", detail)
        self.put(StreamEvent(kind, detail, time.monotonic()))


def _receive(connection: socket.socket, buffer: bytearray) -> int | None:
    """Bytes received into `buffer`: 0 at the end of the stream, None if there are none for now."""
    try:
        return connection.recv_into(buffer)
    except TimeoutError as error:
        if error.errno is not None:  # not our own short time limit, but the operating system's: the other machine is gone
            raise
        return None
