"""How many processes there is memory for, and how many threads each of them gets."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

from ..errors import AIFReconError, FileFormatError, SettingsError
from ..io.metafile.opening import METAIMAGE_SUFFIXES, NRRD_SUFFIXES, read_metafile
from ..machine.memory import SAFETY, available_memory
from ..machine.threads import usable_cores
from ..recipe.recipe import DEFAULT_SPACING
from ..terminal.labels_options import labels_inputs, names_labels
from ..terminal.reconstruction_options import seen_source
from ..terminal.sequence_options import sequences_from
from ..workflows.reconstruct import plan
from .table import Case, with_method

PROCESS = 450_000_000
"""Bytes of a worker with all libraries, pictures drawn; measured."""

OURS = 300_000_000
"""Bytes of the process that the user talks to."""

PER_LABEL = 24
"""Bytes per voxel of the labels: bone map, distances and what they are made of."""

OVER_PLAN = 1.2
"""What a reconstruction takes in all, against what its voxels do."""

LOOKED_AT = 3
"""Cases that are opened to find out what the largest one needs."""


@dataclass(frozen=True)
class Shares:
    """How this computer is shared out.

    Parameters
    ----------
    workers, threads : int
        Processes, and threads of the engine in each.
    memory : int or None
        Bytes that each process may take.
    needed : int
        Bytes that the largest case is expected to need.
    """

    workers: int
    threads: int
    memory: int | None
    needed: int

    def __str__(self) -> str:
        memory = "" if self.memory is None else f" and {self.memory / 1e9:.1f} GB"
        large = f"; the largest case, of {self.needed / 1e9:.1f} GB, is worked in parts"
        message = f"{self.workers} process(es) with {self.threads} thread(s){memory} each"
        return message if self.memory is None or self.needed <= self.memory else message + large


def shared_out(cases: Sequence[Case], workers: int | None = None, memory: int | None = None) -> Shares:
    """Processes, as many as cores and memory allow, among which the threads of the engine are divided.

    Raises SettingsError when that is too little for a single process.

    Parameters
    ----------
    cases : sequence of Case
        That are to be computed.
    workers : int or None
        As many as the user asks for.
    memory : int or None
        Bytes for all together, this process included; by default what is free.
    """
    if memory is not None and memory < OURS + PROCESS:
        raise SettingsError(
            f"Input --memory must be at least {(OURS + PROCESS) / 1e9:.2f} GB, which one process and this one take; got "
            f"{memory / 1e9:.2f}. Give more."
        )
    largest = sorted(cases, key=_weight, reverse=True)[:LOOKED_AT]
    cores, needed = usable_cores(), PROCESS + max(map(_of_case, largest), default=0)
    if memory is None and (free := available_memory()) is not None:
        memory = max(int(SAFETY * free), OURS + PROCESS)
    left = math.inf if memory is None else memory - OURS
    # Asked for or not, more processes than can be there at all are none
    fitting = [workers, left // PROCESS] if workers else [cores, len(cases), left // needed]
    count = max(int(min(fitting)), 1)
    return Shares(count, max(cores // count, 1), None if memory is None else int(left // count), needed)


def _weight(case: Case) -> float:
    """How large a case is against others, as far as can be told without opening it."""
    spacing = case.arguments.spacing or DEFAULT_SPACING
    finest = min(spacing) if isinstance(spacing, tuple) else spacing
    return float(sum(path.stat().st_size for path in case.inputs if path.is_file()) / finest**3)


def _of_case(case: Case) -> int:
    """Bytes of the volume and of the bone; 0 of a case that cannot be opened, as its worker will say."""
    arguments = with_method(case.arguments, case.methods[0])
    has_bone = bool(names_labels(arguments) or arguments.bone_probability or seen_source(arguments))
    with suppress(AIFReconError, OSError):
        sequences = sequences_from(arguments, arguments.sweeps)
        planned = plan(sequences, arguments.recipe, has_bone=has_bone).memory
        headers = [path for path in labels_inputs(arguments) if path.suffix.lower() in (*METAIMAGE_SUFFIXES, *NRRD_SUFFIXES)]
        largest = max((math.prod(read_metafile(path, FileFormatError).size) for path in headers), default=0)
        return int(OVER_PLAN * (planned + PER_LABEL * largest))
    return 0
