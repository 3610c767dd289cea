"""A worker for each test."""

from __future__ import annotations

import pytest

from AIFReconLib.worker.worker import Worker


@pytest.fixture
def worker():
    made = Worker()
    yield made
    made.close()
