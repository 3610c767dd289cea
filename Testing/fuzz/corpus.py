"""The inputs that reached something, in one file: `corpus.zip` holds TARGET/HASH, in the order of names and without times."""

from __future__ import annotations

import hashlib
import zipfile
from collections.abc import Iterable, Mapping
from pathlib import Path

CORPUS = Path(__file__).with_name("corpus.zip")


def read_corpus(path: Path = CORPUS) -> dict[str, list[bytes]]:
    """The inputs of each target."""
    inputs: dict[str, list[bytes]] = {}
    with zipfile.ZipFile(path) as file:
        for name in sorted(file.namelist()):
            inputs.setdefault(name.split("/")[0], []).append(file.read(name))
    return inputs


def write_corpus(inputs: Mapping[str, Iterable[bytes]], path: Path = CORPUS) -> None:
    """Write all inputs anew; the same inputs give the same bytes."""
    names = {f"{target}/{hashlib.sha256(data).hexdigest()[:12]}": data for target, own in inputs.items() for data in own}
    with zipfile.ZipFile(path, "w") as file:
        for name in sorted(names):
            file.writestr(zipfile.ZipInfo(name), names[name], zipfile.ZIP_DEFLATED, 9)
