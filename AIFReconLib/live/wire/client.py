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
from ...message import said
from .connection import check_port, open_connection
from .decoding import USED_TYPES, codec, decode
from .encoding import encode_status_request
from .framing import SIZE_LIMIT, Damage, Frame, Framer, Recovery
from .message_queue import MessageQueue
from .messages import EventKind, StreamEvent, StreamMessage
from .statistics import Counters, StreamStatistics

logger = logging.getLogger(__name__)

CONNECTING, CONNECTED, WAITING, STOPPED = "connecting", "connected", "waiting to reconnect", "stopped"

CHUNK = 2**18
"""Bytes asked of the operating system at a time."""

EVENT_INTERVAL = 1.0
"""Shortest time between two events about the same trouble, s: a stream can be damaged many times a second."""

EVENT_LEVELS = {"connected": logging.INFO, "resynchronized": logging.INFO}
"""At which events are logged; the others are warnings."""

STOP_TIMEOUT = 0.8
RESOLVING_TIMEOUT = 10.0


class OpenIGTLinkClient:
    """Receives from a server, in a thread of its own, until it is stopped.

    Parameters
    ----------
    host : str
    port : int
        Plus listens on 18944.
    queue_size : int
        Messages that wait to be taken; beyond it the oldest are dropped and counted.
    queue_bytes : int
        Bytes of pixels that wait to be taken.
    size_limit : int
        Bytes of a message body beyond which a header is taken for damage.
    stall_after : float, s
        Without a message for so long, the stream has stalled.
    connect_timeout : float, s
    retry_delays : tuple of float, s
        Pauses between attempts to connect; the last one repeats. They begin anew once a message has arrived.

    Notes
    -----
    `start` and `stop` may be called in any order and any number of times. All methods may be called from any thread. The first message
    sent on every connection is a GET_STATUS of header version 2, because Plus then adds metadata and statuses.

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
        self.host = host.strip()
        self.port = check_port(port)
        self._size_limit = size_limit
        self._stall_after = stall_after
        self._connect_timeout = connect_timeout
        self._retry_delays = tuple(retry_delays)
        self._queue = MessageQueue(queue_size, queue_bytes)
        self._control = threading.Lock()
        self._run: _Run | None = None

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
            if self._run is None or self._run.stopping.is_set():
                self._queue.open()
                self._run = _Run(self)
                self._run.start()
            run = self._run
        if wait:
            decided = run.attempted.wait(self._connect_timeout + RESOLVING_TIMEOUT)
            if not decided or run.first_error:
                self.stop()
                if run.first_error:
                    raise run.first_error
                raise LiveConnectionError(
                    f"Host {self.host!r} was not found in {RESOLVING_TIMEOUT:g} s. Check its name, or give its IP address."
                )

    def connect_once(self) -> None:
        """`start` that fails at once where there is no server: see its `wait`."""
        self.start(wait=True)

    def stop(self) -> None:
        """Disconnect; returns within a second, whatever the client is doing. What was received can still be taken."""
        with self._control:
            run = self._run
        if run is not None:
            run.stopping.set()
            self._queue.close()
            run.join()

    def __enter__(self) -> OpenIGTLinkClient:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    # ---- what was received

    def get(self, timeout: float | None = None) -> StreamMessage | None:
        """The next message or event in order of arrival; None if there is none within `timeout` s, or the client is stopped and empty."""
        return self._queue.get(timeout)

    @property
    def state(self) -> str:
        """``connecting``, ``connected``, ``waiting to reconnect`` or ``stopped``."""
        run = self._run
        return STOPPED if run is None or run.stopping.is_set() else run.state

    @property
    def last_error(self) -> str | None:
        """Why there is no connection, or why the last one ended, in plain words; None while connected."""
        run = self._run
        return None if run is None else run.last_error

    @property
    def statistics(self) -> StreamStatistics:
        """A snapshot of all counters since `start`."""
        run = self._run
        return StreamStatistics() if run is None else run.snapshot(self._queue.dropped, self._queue.dropped_images)

    def devices(self) -> dict[str, tuple[str, ...]]:
        """Names of the devices seen since `start`, each with the types of its messages, in order of appearance."""
        seen: dict[str, tuple[str, ...]] = {}
        for device, kind in self.statistics.received:
            seen[device] = (*seen.get(device, ()), kind)
        return seen


class _Run:
    """One life of a client, from start to stop: a thread that outlives its stop (the name of a host is resolved) touches nothing new."""

    def __init__(self, client: OpenIGTLinkClient):
        self._client = client
        self._queue = client._queue
        self._lock = threading.Lock()
        self._counters = Counters()
        self._event_times: dict[str, float] = {}
        self._thread = threading.Thread(target=self._work, name=f"OpenIGTLink {client.host}:{client.port}", daemon=True)
        self.stopping = threading.Event()
        self.attempted = threading.Event()
        self.first_error: LiveConnectionError | None = None
        self.last_error: str | None = None
        self.state = CONNECTING

    def start(self) -> None:
        self._thread.start()

    def join(self) -> None:
        if self._thread is not threading.current_thread():
            self._thread.join(STOP_TIMEOUT)

    def snapshot(self, dropped: int, dropped_images: int) -> StreamStatistics:
        with self._lock:
            return self._counters.snapshot(time.monotonic(), dropped, dropped_images)

    def _work(self) -> None:
        client, attempt = self._client, 0
        while not self.stopping.is_set():
            self.state = CONNECTING
            delay = client._retry_delays[min(attempt, len(client._retry_delays) - 1)]
            attempt += 1
            try:
                connection = open_connection(client.host, client.port, client._connect_timeout, self.stopping.is_set)
            except LiveConnectionError as error:
                reason: str = said(error)
                self.first_error = None if self.attempted.is_set() else error
            else:
                if connection is None:
                    break
                with connection:
                    reason, received = self._serve(connection)
                if received:
                    attempt, delay = 1, client._retry_delays[0]
            if self.stopping.is_set():
                break
            self.last_error, self.state = reason, WAITING
            self.attempted.set()
            self._emit("disconnected", f"{reason} Connecting again in {delay:g} s.")
            self.stopping.wait(delay)

    def _serve(self, connection: socket.socket) -> tuple[str, bool]:
        """Receive until the connection ends; returns why, and whether a message came."""
        with self._lock:
            self._counters.connections += 1
        self.last_error, self.state = None, CONNECTED
        self.attempted.set()
        self._emit("connected", f"Connected to {self._client.host}, port {self._client.port}.")
        framer, before = Framer(self._client._size_limit), self._counters.last_message
        skipped = self._counters.skipped_bytes
        try:
            connection.sendall(encode_status_request())
            reason = self._receive_all(connection, framer, skipped)
        except OSError as error:
            cause = error.strerror or "the network failed"
            reason = _ended(f"The connection was lost ({cause})", framer)
        # A message that will never come to its end may have swallowed whole ones
        while parts := framer.look_inside():
            self._take_all(parts, time.monotonic())
        with self._lock:
            self._counters.skipped_bytes = skipped + framer.skipped
        return reason, self._counters.last_message != before

    def _receive_all(self, connection: socket.socket, framer: Framer, skipped: int) -> str:
        """Receive until the stream ends or the client is stopped, and say which; `skipped` bytes were lost on earlier connections."""
        buffer = bytearray(CHUNK)
        view = memoryview(buffer)
        last, stalled = time.monotonic(), False
        while not self.stopping.is_set():
            size = _receive(connection, buffer)
            now = time.monotonic()
            if size == 0:
                return _ended("The server closed the connection", framer)
            parts = framer.feed(view[:size]) if size else []
            if now - last > self._client._stall_after and not parts:
                seen = _seen(framer)
                # A message that does not come to its end may have begun anew inside itself
                parts = framer.look_inside()
                if not stalled and not parts:
                    stalled = True
                    detail = f"For {now - last:.1f} s {seen}. Waiting; check {self._client.host}, and the network."
                    self._emit("stalled", detail)
            if self._take_all(parts, now):
                last, stalled = now, False
            with self._lock:
                self._counters.received_bytes += size or 0
                self._counters.skipped_bytes = skipped + framer.skipped
        return "The client was stopped."

    def _take_all(self, parts: list[Frame | Damage | Recovery], now: float) -> bool:
        """Take parts of the stream; whether there is a message among them."""
        for part in parts:
            self._take(part, now)
        return any(isinstance(part, Frame) for part in parts)

    def _take(self, part: Frame | Damage | Recovery, now: float) -> None:
        """Count a part of the stream, and queue what it holds."""
        if isinstance(part, Damage):
            with self._lock:
                self._counters.bad_crc += part.kind == "checksum"
                self._counters.refused_sizes += part.kind == "size"
                self._counters.refusals[part.kind] = f"{part.detail}."
            self._emit("refused", f"{part.detail}. It is left out; looking for the next message.", part.kind)
        elif isinstance(part, Recovery):
            with self._lock:
                self._counters.resyncs += 1
            detail = f"{part.skipped} bytes that belong to no message were skipped; the stream is in order again."
            self._emit("resynchronized", detail, "in order")
        else:
            header = part.header
            with self._lock:
                self._counters.count_message(header.device, header.kind, now, used=header.kind in USED_TYPES)
            try:
                for message in decode(part, now):
                    self._queue_up(message)
            except LiveMessageError as error:
                with self._lock:
                    self._counters.refused += 1
                    self._counters.refusals[header.kind] = said(error)
                self._emit("refused", said(error), "contents")

    def _emit(self, kind: EventKind, detail: str, trouble: str | None = None) -> None:
        """Queue an event; those about the same trouble at most once in a while, because counters tell the rest."""
        now = time.monotonic()
        if trouble is not None:
            if now - self._event_times.get(trouble, -EVENT_INTERVAL) < EVENT_INTERVAL:
                return
            self._event_times[trouble] = now
        logger.log(EVENT_LEVELS.get(kind, logging.WARNING), "%s", detail)
        self._queue_up(StreamEvent(kind, detail, now))

    def _queue_up(self, message: StreamMessage) -> None:
        if self.stopping.is_set() or not self._queue.put(message):
            with self._lock:
                self._counters.discard(message)


def _receive(connection: socket.socket, buffer: bytearray) -> int | None:
    """Bytes received into `buffer`: 0 at the end of the stream, None if there are none for now."""
    try:
        return connection.recv_into(buffer)
    except TimeoutError as error:
        if error.errno is not None:  # not our own short time limit, but the operating system's: the other machine is gone
            raise
        return None


def _seen(framer: Framer) -> str:
    """What arrives of a stream from which no message comes."""
    if framer.searching:
        return "only bytes that are no message arrive"
    pending = framer.describe_pending()
    return f"nothing arrived in the middle of {pending}" if pending else "nothing arrived"


def _ended(how: str, framer: Framer) -> str:
    """How a connection ended, and in the middle of what."""
    pending = framer.describe_pending()
    return f"{how} in the middle of {pending}." if pending else f"{how}."
