"""A server that sends a recording as a Plus server would: to rehearse, to test, and to show a live reconstruction without a scanner."""

from __future__ import annotations

import errno
import logging
import socket
import sys
import threading
import time
from collections.abc import Sequence

from ...errors import LiveConnectionError, SettingsError
from ...machine.threads import pause
from ...sweep.frames import TrackedSequence
from ..wire.connection import POLL, check_port
from ..wire.encoding import encode_status
from .frames import ReplayFrames
from .peer import Peer

logger = logging.getLogger(__name__)

PLUS_PORT = 18944
END_INTERVAL = 0.22
"""Time between the statuses that Plus sends once a recording that does not repeat is over, s."""

DRAIN_TIMEOUT = 0.5

MOST_CLIENTS = 32
"""Clients at a time; each costs two threads, and a thousand of them would leave nothing to anybody."""


class ReplayServer:
    """Serves a recording over OpenIGTLink.

    Parameters
    ----------
    sequence : TrackedSequence
        Read with its Plus configuration, so that images carry their pose in Reference.
    port : int
        0 takes any free one; `port` then says which.
    host : str
        The address to listen on: 127.0.0.1 admits this machine only, 0.0.0.0 the whole network.
    rate : float or None, frames/s
        By default the recorded times.
    loop : bool
        Begin again at the end. The time goes on without a gap and the pose jumps, as with Plus.
    header_version : int or None
        1 or 2; None follows the client as Plus does: 1, until the client sends a message of version 2.
    image_to_reference, reference, transforms, valid_only
        See `ReplayFrames`.

    Notes
    -----
    The recording begins when the first client is there; a client that comes later joins in. Once every client has left it is back at
    its beginning. After the last frame of a recording that does not repeat, a STATUS of time 0 goes out every 0.22 s and the
    connections stay open. Time stamps are those of the present, frames as far apart as recorded. A client that reads slowly misses
    whole frames and never gets a part of one; one that takes nothing at all for half a minute is disconnected, and while 32 are connected
    others are turned away.

    Examples
    --------
    >>> with ReplayServer(sequence, port=0) as server:  # doctest: +SKIP
    ...     client = OpenIGTLinkClient(server.host, server.port)
    """

    def __init__(
        self,
        sequence: TrackedSequence,
        port: int = PLUS_PORT,
        host: str = "127.0.0.1",
        *,
        rate: float | None = None,
        loop: bool = False,
        header_version: int | None = None,
        image_to_reference: str | None = None,
        reference: str | None = None,
        transforms: Sequence[str] | None = None,
        valid_only: bool = True,
    ):
        if header_version not in (None, 1, 2):
            raise SettingsError(f"Input header_version must be 1 or 2; got {header_version!r}.")
        self.frames = ReplayFrames(
            sequence,
            rate=rate,
            image_to_reference=image_to_reference,
            reference=reference,
            transforms=transforms,
            valid_only=valid_only,
        )
        self.host = host
        self.port = check_port(port, lowest=0)
        self.loop = loop
        self.sent = 0
        self.served = 0
        self.turned_away = 0
        self._version = header_version
        self._dropped = 0
        self._lock = threading.Lock()
        self._peers: list[Peer] = []
        self._stopping = threading.Event()
        self._played = threading.Event()
        self._deserted = threading.Event()
        self._error: Exception | None = None
        self._listener: socket.socket | None = None
        self._threads: list[threading.Thread] = []

    # ---- control

    def start(self) -> None:
        """Listen and serve; does nothing if it is running.

        Raises
        ------
        LiveConnectionError
            When the port is taken, or the host is no address of this machine.
        """
        if self._listener is not None:
            return
        self._listener = _listen(self.host, self.port)
        self.port = self._listener.getsockname()[1]
        self._stopping.clear()
        self._played.clear()
        self._error = None
        self._threads = [threading.Thread(target=work, name=f"replay {work.__name__}", daemon=True) for work in (self._accept, self._play)]
        try:
            for thread in self._threads:
                thread.start()
        except RuntimeError:  # the system allows no more threads
            self._stopping.set()
            self._listener.close()
            self._listener = None
            raise

    def stop(self) -> None:
        """Close every connection and free the port; what was queued is sent if the clients take it within half a second."""
        if self._listener is None:
            return
        deadline = time.monotonic() + DRAIN_TIMEOUT
        self._stopping.set()
        for thread in self._threads:
            thread.join()
        for peer in self._current_peers():
            peer.drain(max(0.0, deadline - time.monotonic()))
            peer.close()
        self._listener.close()
        self._listener = None

    def wait(self, timeout: float | None = None) -> bool:
        """Wait until the recording has been played once and handed to the clients, or the server stopped; False after `timeout` s.

        Raises
        ------
        AIFReconError
            When the recording turned out to be damaged.
        """
        done = self._played.wait(timeout)
        if self._error is not None:
            raise self._error
        return done

    def serve_until_stopped(self) -> None:
        """Wait for `stop` in another thread, or for an interrupt.

        Raises
        ------
        AIFReconError
            When the recording turned out to be damaged.
        """
        while not pause(POLL, unless=self._stopping):
            pass
        if self._error is not None:
            raise self._error

    def __enter__(self) -> ReplayServer:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    # ---- what it does

    @property
    def clients(self) -> int:
        """Clients that are connected."""
        return len(self._current_peers())

    @property
    def dropped(self) -> int:
        """Frames, over all clients, that a slow one missed."""
        with self._lock:
            return self._dropped + sum(peer.dropped for peer in self._peers)

    def describe(self) -> str:
        """Where it listens and what it sends, in two lines."""
        frames = self.frames
        names = ", ".join(map(str, frames.transforms)) or "none"
        pose = "with its pose" if "_" in frames.image_device else "without a pose"
        speed = len(frames) / frames.period
        again = ", over and over" if self.loop else ""
        return (
            f"Listening on {self.host}, port {self.port}.\n"
            f"Sends {len(frames)} frames at {speed:.3g} frames/s{again}: image {frames.image_device} ({pose}); transforms {names}."
        )

    # ---- threads

    def _accept(self) -> None:
        listener = self._listener
        while listener is not None and not self._stopping.is_set():
            try:
                connection, _ = listener.accept()
            except TimeoutError:
                continue
            except OSError:
                # A client that gave up before it was accepted is no reason to stop serving the others
                self._stopping.wait(POLL)
                continue
            if self.clients >= MOST_CLIENTS:
                self.turned_away += 1
                logger.warning("A client was turned away: %d are connected", MOST_CLIENTS)
                connection.close()
                continue
            peer = Peer(connection, self._version, self._forget)
            with self._lock:
                self._peers.append(peer)
                self.served += 1
            logger.info("A client connected, the %d. since the server started", self.served)
            peer.start()

    def _forget(self, peer: Peer) -> None:
        with self._lock:
            if peer in self._peers:
                self._peers.remove(peer)
                self._dropped += peer.dropped
                logger.info("A client left; it missed %d frames", peer.dropped)
            if not self._peers:
                self._deserted.set()

    def _current_peers(self) -> list[Peer]:
        with self._lock:
            return list(self._peers)

    def _ready_peers(self) -> list[Peer]:
        return [peer for peer in self._current_peers() if peer.ready]

    def _play(self) -> None:
        try:
            while not self._stopping.is_set():
                self._deserted.clear()
                if self._ready_peers():
                    self._play_to_clients()
                else:
                    self._stopping.wait(POLL / 5)
        except Exception as error:  # whoever waits for the server gets it; a thread has nobody to raise it to
            self._error = error
            logger.exception("The replay ended")
            self._stopping.set()
        finally:
            self._played.set()

    def _play_to_clients(self) -> None:
        """The recording from its beginning, until its end and beyond, or until every client has left."""
        begin, begin_wall = time.monotonic(), time.time()
        round_start = 0.0
        while True:
            for place, offset in enumerate(self.frames.offsets):
                due = round_start + float(offset)
                self._stopping.wait(max(0.0, begin + due - time.monotonic()))
                if self._stopping.is_set() or self._deserted.is_set():
                    return
                self._broadcast(place, begin_wall + due)
            if not self.loop:
                break
            round_start += self.frames.period
        for peer in self._current_peers():
            peer.drain(DRAIN_TIMEOUT)
        self._played.set()
        while not self._stopping.wait(END_INTERVAL) and not self._deserted.is_set():
            for peer in self._ready_peers():
                peer.offer(encode_status("", 0.0, text="\n", version=peer.version))

    def _broadcast(self, place: int, timestamp: float) -> None:
        encoded: dict[int, bytes] = {}
        for peer in self._ready_peers():
            version = peer.version
            if version not in encoded:
                encoded[version] = self.frames.messages(place, timestamp, version)
            peer.offer(encoded[version])
        self.sent += 1


def _listen(host: str, port: int) -> socket.socket:
    """A listening socket.

    Raises
    ------
    LiveConnectionError
    """
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)[0]
    except (OSError, UnicodeError):
        raise LiveConnectionError(f"Host {host!r} cannot be found. Give 127.0.0.1, 0.0.0.0 or an address of this machine.") from None
    listener = socket.socket(family, kind, protocol)
    try:
        # Elsewhere this frees a port that a server has just left; on Windows it would let two servers share one
        if sys.platform == "win32":
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_EXCLUSIVEADDRUSE, 1)
        else:
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(address)
        listener.listen()
        listener.settimeout(POLL)
    except OSError as error:
        listener.close()
        raise _failure(error, host, port) from None
    return listener


def _failure(error: OSError, host: str, port: int) -> LiveConnectionError:
    if error.errno == errno.EADDRINUSE:
        return LiveConnectionError(
            f"Port {port} is in use by another program, perhaps a PlusServer. Stop it, or choose another port (0 takes any free one)."
        )
    if error.errno == errno.EADDRNOTAVAIL:
        return LiveConnectionError(f"{host} is no address of this machine. Give 127.0.0.1, 0.0.0.0 or one of its addresses.")
    if error.errno == errno.EACCES:
        return LiveConnectionError(f"Port {port} needs special rights. Choose one above 1023; Plus uses {PLUS_PORT}.")
    return LiveConnectionError(f"Port {port} on {host} cannot be served ({error.strerror}). Choose another port.")
