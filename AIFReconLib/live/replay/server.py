"""A server that sends a recording as a Plus server would: to rehearse, to test, and to show a live reconstruction without a scanner."""

from __future__ import annotations

import asyncio
import errno
import logging
import socket
import threading
import time
from typing import Any

from ...errors import LiveConnectionError, SettingsError
from ...sweep.frames import TrackedSequence
from ..wire.connection import POLL, check_port
from ..wire.encoding import encode_status
from ..wire.framing import Framer
from .frames import ReplayFrames

logger = logging.getLogger(__name__)

PLUS_PORT = 18944
END_INTERVAL = 0.22
"""Time between the statuses that Plus sends once a recording that does not repeat is over, s."""

DRAIN_TIMEOUT = 0.5

QUEUE_BYTES = 64 * 2**20
"""What may wait for a client that reads too slowly; beyond it whole frames are left out."""

REQUEST_LIMIT = 2**20
"""Bytes of a client's message; what Plus understands is far smaller."""

GREETING = 0.25
"""How long a new client is given to ask for header version 2 before the first frame goes out, s."""


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
    loop : bool
        Begin again at the end. The time goes on without a gap and the pose jumps, as with Plus.
    header_version : int or None
        1 or 2; None follows the client as Plus does: 1, until the client sends a message of version 2.
    rate, image_to_reference, reference, transforms, valid_only
        See `ReplayFrames`.

    Notes
    -----
    The recording begins when the first client is there; a client that comes later joins in. Once every client has left it is back at
    its beginning. After the last frame of a recording that does not repeat, a STATUS of time 0 goes out every 0.22 s and the
    connections stay open. Time stamps are those of the present, frames as far apart as recorded. A client that reads slowly misses
    whole frames and never gets a part of one. One thread serves all.

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
        loop: bool = False,
        header_version: int | None = None,
        **of_frames: Any,
    ):
        if header_version not in (None, 1, 2):
            raise SettingsError(f"Input header_version must be 1 or 2; got {header_version!r}.")
        self.frames = ReplayFrames(sequence, **of_frames)
        self.host = host
        self.port = check_port(port, lowest=0)
        self.loop = loop
        self.sent = self.served = self.dropped = 0
        self._version = header_version
        self._clients: list[_Client] = []
        self._playing: asyncio.Task[None] | None = None
        self._stopping, self._played = threading.Event(), threading.Event()
        self._error: Exception | None = None
        self._thread: threading.Thread | None = None

    # ---- control

    def start(self) -> None:
        """Listen and serve; does nothing when called again.

        Raises
        ------
        LiveConnectionError
            When the port is taken, or the host is no address of this machine.
        """
        if self._thread is None:
            listener = _listen(self.host, self.port)
            self.port = listener.getsockname()[1]
            thread = threading.Thread(target=self._run, args=(listener,), name="replay", daemon=True)
            try:
                thread.start()
            except RuntimeError:  # the system allows no more threads
                listener.close()
                raise
            self._thread = thread

    def stop(self) -> None:
        """Close every connection and free the port; what was queued is sent if the clients take it within half a second."""
        self._stopping.set()
        if self._thread is not None:
            self._thread.join()

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
        """Wait for `stop` in another thread, or for an interrupt; raises as `wait`."""
        while self._thread is not None and self._thread.is_alive():  # whose own wait may turn an interrupt into an error of its lock
            time.sleep(POLL)
        self.wait()

    def __enter__(self) -> ReplayServer:
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    # ---- what it does

    @property
    def clients(self) -> int:
        """Clients that are connected."""
        return len(self._clients)

    def describe(self) -> str:
        """Where it listens and what it sends, in two lines."""
        frames = self.frames
        names = ", ".join(map(str, frames.transforms)) or "none"
        pose = "with its pose" if "_" in frames.image_device else "without a pose"
        again = ", over and over" if self.loop else ""
        return (
            f"Listening on {self.host}, port {self.port}.\n"
            f"Sends {len(frames)} frames at {len(frames) / frames.period:.3g} frames/s{again}: "
            f"image {frames.image_device} ({pose}); transforms {names}."
        )

    # ---- the thread

    def _run(self, listener: socket.socket) -> None:
        try:
            asyncio.run(self._serve(listener))
        except Exception as error:  # whoever waits for the server gets it; a thread has nobody to raise it to
            self._error = error
            logger.exception("The replay ended")
        finally:
            self._played.set()

    async def _serve(self, listener: socket.socket) -> None:
        """Play the recording from its beginning whenever there are clients; the last one that leaves ends that."""
        server = await asyncio.start_server(self._meet, sock=listener)
        try:
            while not self._stopping.is_set():
                await asyncio.sleep(POLL / 5)
                if self._playing is not None and self._playing.done():
                    # It ends by itself only where the recording is damaged
                    self._playing.result()
                elif self._playing is None and any(client.is_ready for client in self._clients):
                    self._playing = asyncio.create_task(self._play())
        finally:
            server.close()
            await self._drain()
            for client in self._clients:
                client.writer.transport.abort()
            await asyncio.sleep(POLL)

    async def _meet(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Listen to a client for as long as it is there."""
        client = _Client(writer, self._version or 1)
        self._clients.append(client)
        self.served += 1
        logger.info("A client connected, the %d. since the server started", self.served)
        framer = Framer(REQUEST_LIMIT)
        try:
            while data := await reader.read(2**16):
                for message in framer.feed(data):
                    if self._version is None and message.version > 1:
                        client.version = 2
                    client.has_asked = True
                    if message.kind == "GET_STATUS":
                        self._send(client, _status(client.version))
        except OSError:
            pass
        finally:
            self._clients.remove(client)
            logger.info("A client left")
            writer.transport.abort()
            if not self._clients and self._playing is not None:
                self._playing.cancel()
                self._playing = None

    async def _play(self) -> None:
        """The recording until its end and beyond."""
        begin, begin_wall, round_start = time.monotonic(), time.time(), 0.0
        while True:
            for number, offset in enumerate(self.frames.offsets):
                due = round_start + float(offset)
                await asyncio.sleep(max(begin + due - time.monotonic(), 0.0))
                ready = [client for client in self._clients if client.is_ready]
                versions = {client.version for client in ready}
                encoded = {version: self.frames.messages(number, begin_wall + due, version) for version in versions}
                for client in ready:
                    self._send(client, encoded[client.version])
                self.sent += 1
            if not self.loop:
                break
            round_start += self.frames.period
        await self._drain()
        self._played.set()
        while True:
            await asyncio.sleep(END_INTERVAL)
            for client in self._clients:
                self._send(client, _status(client.version))

    def _send(self, client: _Client, data: bytes) -> None:
        """Queue whole messages, or leave them out where too much waits; never waits."""
        if client.waiting and client.waiting + len(data) > QUEUE_BYTES:
            self.dropped += 1
        elif not client.writer.transport.is_closing():
            client.writer.write(data)

    async def _drain(self) -> None:
        """Wait until everything queued is with the operating system, but not for long."""
        end = time.monotonic() + DRAIN_TIMEOUT
        while any(client.waiting for client in self._clients) and time.monotonic() < end:
            await asyncio.sleep(POLL / 5)


class _Client:
    """One that is connected, and which header version it wants."""

    def __init__(self, writer: asyncio.StreamWriter, version: int):
        self.writer, self.version, self.has_asked = writer, version, False
        self._accepted = time.monotonic()

    @property
    def is_ready(self) -> bool:
        """Whether it has said which version it wants, or has had its time to."""
        return self.has_asked or time.monotonic() - self._accepted > GREETING

    @property
    def waiting(self) -> int:
        """Bytes that wait to be sent."""
        return self.writer.transport.get_write_buffer_size()


def _status(version: int) -> bytes:
    """What Plus says when it has nothing else to say."""
    return encode_status("", 0.0, text="\n", version=version)


def _listen(host: str, port: int) -> socket.socket:
    """A listening socket.

    Raises LiveConnectionError when there can be none.
    """
    try:
        family, *_, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)[0]
        return socket.create_server(address[:2], family=family)
    except (socket.gaierror, UnicodeError):
        raise LiveConnectionError(f"Host {host!r} cannot be found. Give 127.0.0.1, 0.0.0.0 or an address of this machine.") from None
    except OSError as error:
        why = {
            errno.EADDRINUSE: f"Port {port} is in use by another program, perhaps a PlusServer. Stop it, or choose another port (0 takes "
            "any free one).",
            errno.EADDRNOTAVAIL: f"{host} is no address of this machine. Give 127.0.0.1, 0.0.0.0 or one of its addresses.",
            errno.EACCES: f"Port {port} needs special rights. Choose one above 1023; Plus uses {PLUS_PORT}.",
        }
        other = f"Port {port} on {host} cannot be served ({error.strerror}). Choose another port."
        raise LiveConnectionError(why.get(error.errno or 0, other)) from None
