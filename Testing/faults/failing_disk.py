"""A disk that fails while it is read, as a network disk does that goes away: a file system of our own through the FUSE interface.

Linux, for root. It holds a few files in one folder, can be read only, and answers every read itself, without a cache: from a given byte on
with an error, or by going away for good.
"""

from __future__ import annotations

import contextlib
import ctypes
import errno
import os
import signal
import struct
import tempfile
from collections.abc import Iterator
from pathlib import Path

from .children import start

IN_HEADER = struct.Struct("<IIQQIIIHH")
OUT_HEADER = struct.Struct("<IiQ")
ROOT = 1
DETACH = 2
DIRECT_IO = 1

LOOKUP, FORGET, GETATTR, OPEN, READ, STATFS, RELEASE, FLUSH, INIT, OPENDIR, READDIR, RELEASEDIR, ACCESS = (
    1, 2, 3, 14, 15, 17, 18, 25, 26, 27, 28, 29, 34,
)  # fmt: skip
INTERRUPT, FORGET_MANY = 36, 42


def possible() -> bool:
    """Whether this machine lets us mount one."""
    return os.path.exists("/dev/fuse") and os.getuid() == 0


@contextlib.contextmanager
def failing_disk(files: dict[str, bytes], fails_at: int, how: str) -> Iterator[Path]:
    """A folder with these files.

    Parameters
    ----------
    files : dict of name to content
    fails_at : int
        Reads that reach beyond this byte of any file fail.
    how : "EIO", "gone" or "short"
        With an input/output error; by the whole disk going away; by ending there although the file is longer.
    """
    libc = ctypes.CDLL(None, use_errno=True)
    with tempfile.TemporaryDirectory(prefix="faults-fuse-") as folder:
        device = os.open("/dev/fuse", os.O_RDWR)
        options = f"fd={device},rootmode=40000,user_id=0,group_id=0".encode()
        if libc.mount(b"faults", folder.encode(), b"fuse", 1, options) != 0:
            raise OSError(ctypes.get_errno(), "the disk cannot be mounted")
        server = start(lambda: _Server(device, files, fails_at, how).serve())
        os.close(device)
        try:
            yield Path(folder)
        finally:
            libc.umount2(folder.encode(), DETACH)
            with contextlib.suppress(ProcessLookupError):
                os.kill(server, signal.SIGKILL)
            os.waitpid(server, 0)


class _Server:
    """Answers the kernel's questions until the disk is taken away."""

    def __init__(self, device: int, files: dict[str, bytes], fails_at: int, how: str):
        self._device, self._fails_at, self._how = device, fails_at, how
        self._files = {ROOT + 1 + number: (name.encode(), content) for number, (name, content) in enumerate(files.items())}

    def serve(self) -> None:
        while True:
            try:
                request = os.read(self._device, 2**18)
            except OSError:
                return
            _, operation, unique, node, *_ = IN_HEADER.unpack_from(request)
            if operation in (FORGET, FORGET_MANY, INTERRUPT):
                continue
            try:
                error, answer = 0, self._answer(operation, node, request[IN_HEADER.size :])
            except OSError as cause:
                error, answer = cause.errno or errno.EIO, b""
            if answer is None:
                return  # and the disk with us
            os.write(self._device, OUT_HEADER.pack(OUT_HEADER.size + len(answer), -error, unique) + answer)

    def _answer(self, operation: int, node: int, body: bytes) -> bytes | None:
        if operation == INIT:
            return struct.pack("<IIIIHHIIHHI28x", 7, 31, 0, 0, 12, 9, 2**17, 1, 0, 0, 0)
        if operation == LOOKUP:
            name = body.rstrip(b"\0")
            found = next((number for number, (known, _) in self._files.items() if known == name), None)
            if found is None:
                raise OSError(errno.ENOENT, "")
            return struct.pack("<QQQQII", found, 0, 3600, 3600, 0, 0) + self._attributes(found)
        if operation == GETATTR:
            return struct.pack("<QII", 3600, 0, 0) + self._attributes(node)
        if operation in (OPEN, OPENDIR):
            return struct.pack("<QII", 0, DIRECT_IO, 0)
        if operation == READ:
            return self._read(node, *struct.unpack_from("<8xQI", body))
        if operation == READDIR:
            return b""
        if operation == STATFS:
            return struct.pack("<QQQQQIIII24x", 1000, 0, 0, 10, 0, 4096, 255, 4096, 0)
        if operation in (RELEASE, RELEASEDIR, FLUSH, ACCESS):
            return b""
        raise OSError(errno.ENOSYS, "")

    def _read(self, node: int, offset: int, size: int) -> bytes | None:
        content = self._files[node][1]
        if min(offset + size, len(content)) <= self._fails_at:
            return content[offset : offset + size]
        if self._how == "EIO":
            raise OSError(errno.EIO, "")
        if self._how == "gone":
            return None
        return content[offset : max(self._fails_at, offset)]

    def _attributes(self, node: int) -> bytes:
        size = 0 if node == ROOT else len(self._files[node][1])
        mode = 0o40755 if node == ROOT else 0o100644
        return struct.pack("<QQQQQQIIIIIIIIII", node, size, size // 512 + 1, 1, 1, 1, 0, 0, 0, mode, 1, 0, 0, 0, 4096, 0)
