"""Reading that goes on while what was read is worked on."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from itertools import islice
from typing import TypeVar

Item = TypeVar("Item")

AHEAD = 8
"""Items that wait to be taken, at most: enough to bridge a slow read, few enough to cost no memory."""


@contextmanager
def read_ahead(items: Iterable[Item], ahead: int = AHEAD) -> Iterator[Iterator[Item]]:
    """The same items in the same order, produced on a thread of their own while the caller works on earlier ones.

    An error of the producer is raised where the item would have come. However the block is left, the thread has ended afterwards:
    it does so when the item that it is at is done.
    """
    iterator = iter(items)

    def following() -> list[Item]:
        return list(islice(iterator, 1))

    with ThreadPoolExecutor(1, "reading ahead") as reader:
        waiting = deque(reader.submit(following) for _ in range(ahead))

        def take() -> Iterator[Item]:
            while read := waiting.popleft().result():
                waiting.append(reader.submit(following))
                yield from read

        try:
            yield take()
        finally:
            reader.shutdown(cancel_futures=True)
