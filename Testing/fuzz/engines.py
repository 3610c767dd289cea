"""What chooses the damage: atheris, which follows the coverage of the library's lines, or hypothesis where atheris does not install.

Run for one target, in a process of its own, by `run.py`: a crash ends this process and no other.
"""

from __future__ import annotations

import argparse
import hashlib
import random
import sys
import tempfile
import time
import warnings
from pathlib import Path

TESTING = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTING), str(TESTING.parent)]

try:
    import atheris
except ImportError:
    atheris = None

HANG = 300
"""s after which an input (of hypothesis: a few) is a hang; the process ends."""
COUNT_EVERY = 100
DAMAGES = 20
"""Inputs from one example of hypothesis, whose own work takes longer than most inputs."""


class Session:
    """Runs inputs of one target, and keeps each kind of finding once.

    Parameters
    ----------
    name : str
    findings : Path
        Folder for the inputs that broke the property.
    """

    def __init__(self, name: str, findings: Path):
        from fuzz.registry import TARGETS

        self.target = TARGETS[name]
        self.seeds = self.target.seeds()
        self.findings = findings
        self.kinds: set[str] = set()
        self.executed = self.accepted = 0
        self.folder = Path(tempfile.mkdtemp(prefix="aifrecon-fuzz-"))
        (self.folder / "data.raw").write_bytes(bytes(range(24)) * 3)
        # What crashes the process is in this file then
        self.last = open(findings / f"{name}.last", "wb", buffering=0)  # noqa: SIM115 (it goes with the process)
        self.count = findings / f"{name}.count"

    def run(self, data: bytes) -> None:
        """One input; a finding is written down and does not stop the session."""
        from fuzz.target import Finding, check

        self.executed += 1
        if self.executed % COUNT_EVERY == 0:
            self.count.write_text(f"{self.executed} {self.accepted}")
        self.last.seek(0)
        self.last.write(data)
        self.last.truncate()
        try:
            self.accepted += check(self.target, data, self.folder)
        except Finding as finding:
            if finding.kind not in self.kinds:
                self.kinds.add(finding.kind)
                name = f"{self.target.name}-{hashlib.sha256(finding.kind.encode()).hexdigest()[:8]}"
                (self.findings / f"{name}.bin").write_bytes(data)
                (self.findings / f"{name}.txt").write_text(str(finding), "utf-8", errors="backslashreplace")
                print(f"FINDING {self.target.name}: {finding.kind}", flush=True)


def fuzz_with_atheris(name: str, seconds: float, findings: Path, corpus: Path, seed: int) -> None:
    """Follow coverage for so long. `corpus` grows by what reaches new lines."""
    with atheris.instrument_imports(include=["AIFReconLib", "pyigtl"], enable_loader_override=False):
        import pyigtl  # noqa: F401

        import AIFReconLib.commands.parser  # noqa: F401
        from fuzz import mutation, registry  # noqa: F401
    warnings.simplefilter("error")
    session = Session(name, findings)
    others = session.seeds

    def damaged(data: bytes, max_size: int, number: int) -> bytes:
        # Half of the damage knows headers, half is libFuzzer's own
        if number % 2:
            return mutation.mutate(data or others[0], random.Random(number), session.target.words, others)[:max_size]
        return atheris.Mutate(data, max_size)

    for number, data in enumerate(others):
        (corpus / f"seed{number}").write_bytes(data)
    options = [f"-max_total_time={max(int(seconds), 1)}", f"-timeout={HANG}", "-rss_limit_mb=4096", f"-max_len={mutation.LARGEST}"]
    options += [f"-artifact_prefix={findings / name}-crash-", "-print_final_stats=1", "-close_fd_mask=0", f"-seed={seed}", "-verbosity=1"]
    atheris.Setup([name, *options, str(corpus)], session.run, custom_mutator=damaged)
    atheris.Fuzz()


def fuzz_with_hypothesis(name: str, seconds: float, findings: Path, seed: int) -> None:
    """Damage at random for so long; a hang ends the process with a traceback."""
    import faulthandler

    from hypothesis import HealthCheck, Phase, given, settings
    from hypothesis import seed as seeded
    from hypothesis import strategies as st

    from fuzz.mutation import mutate

    warnings.simplefilter("error")
    session = Session(name, findings)
    end = time.monotonic() + seconds
    rounds = 0
    while time.monotonic() < end:
        rounds += 1

        @seeded(seed + rounds)
        @settings(max_examples=100, deadline=None, database=None, suppress_health_check=list(HealthCheck), phases=[Phase.generate])
        @given(st.sampled_from(session.seeds), st.integers(0, 2**32), st.integers(1, 3))
        def damage(data: bytes, number: int, times: int) -> None:
            rng = random.Random(number)
            faulthandler.dump_traceback_later(HANG, exit=True)
            for _ in range(DAMAGES):
                if time.monotonic() > end:
                    break
                damaged = data
                for _ in range(times):
                    damaged = mutate(damaged, rng, session.target.words, session.seeds)
                session.run(damaged)
            faulthandler.cancel_dump_traceback_later()

        damage()
    session.count.write_text(f"{session.executed} {session.accepted}")


def main() -> int:
    """Fuzz one target."""
    parser = argparse.ArgumentParser(description="Fuzz one target for some seconds; run.py starts this.")
    parser.add_argument("target")
    parser.add_argument("--seconds", type=float, required=True)
    parser.add_argument("--findings", type=Path, required=True)
    parser.add_argument("--corpus", type=Path, required=True)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--engine", choices=("auto", "atheris", "hypothesis"), default="auto")
    arguments = parser.parse_args()
    if arguments.engine == "hypothesis" or (arguments.engine == "auto" and atheris is None):
        fuzz_with_hypothesis(arguments.target, arguments.seconds, arguments.findings, arguments.seed)
    else:
        fuzz_with_atheris(arguments.target, arguments.seconds, arguments.findings, arguments.corpus, arguments.seed)
    return 0


if __name__ == "__main__":
    sys.exit(main())
