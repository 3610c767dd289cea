"""`make fuzz`: shares a time out among the targets, each in a process of its own, and says what was run and found.

Exit code 1 when anything was found. The inputs lie in the folder of findings, each beside a text that says what was wrong; mend the
library, and add the input to Testing/Python/tools/test_fuzz_findings.py.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

TESTING = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTING), str(TESTING.parent)]

SHORTEST = 2.0
"""s for which it pays to start a process."""


def fuzz(name: str, seconds: float, findings: Path, corpus: Path, engine: str) -> tuple[int, int, int]:
    """Fuzz one target, starting again after a crash; how many inputs were run, how many accepted, and how often the process crashed."""
    corpus.mkdir(parents=True, exist_ok=True)
    executed = accepted = crashes = 0
    end = time.monotonic() + seconds
    seed = int(time.time())
    while (left := end - time.monotonic()) > SHORTEST and crashes < 5:
        command = [sys.executable, str(Path(__file__).with_name("engines.py")), name, f"--seconds={left}", f"--findings={findings}"]
        command += [f"--corpus={corpus}", f"--engine={engine}", f"--seed={seed + crashes}"]
        log = findings / f"{name}.log"
        with open(log, "wb") as file:
            code = subprocess.run(command, stdout=file, stderr=subprocess.STDOUT, check=False).returncode
        text = log.read_bytes().decode("utf-8", "replace")
        for line in re.findall(r"^FINDING .*$", text, re.MULTILINE):
            print(line, flush=True)
        count = findings / f"{name}.count"
        own, good = map(int, count.read_text().split()) if count.exists() else (0, 0)
        # libFuzzer ends the process without a last word to us, and counts better
        executed += max([own, *map(int, re.findall(r"^stat::number_of_executed_units: (\d+)", text, re.MULTILINE))])
        accepted += good
        count.unlink(missing_ok=True)
        last = findings / f"{name}.last"
        if code and last.exists():
            # The process ended within an input
            crashes += 1
            last.rename(findings / f"{name}-crash{crashes}.bin")
            log.rename(findings / f"{name}-crash{crashes}.txt")
            print(f"FINDING {name}: the process ended with {code}", flush=True)
        elif code:
            raise SystemExit(f"{name} could not be fuzzed:\n{text[-2000:]}")
        else:
            log.unlink()
            last.unlink(missing_ok=True)
    return executed, accepted, crashes


def main() -> int:
    """Fuzz the targets in turn."""
    from fuzz.registry import TARGETS

    parser = argparse.ArgumentParser(description="Fuzz the ways into the library.")
    parser.add_argument("targets", nargs="*", metavar="TARGET", help=f"default: all of {', '.join(TARGETS)}")
    parser.add_argument("--seconds", type=float, default=600.0, help="for all targets together (default: %(default)g)")
    parser.add_argument("--findings", type=Path, help="where to put inputs that break something (default: a new folder)")
    parser.add_argument("--corpus", type=Path, help="where to keep what reached new lines (default: nowhere)")
    parser.add_argument("--engine", choices=("auto", "atheris", "hypothesis"), default="auto")
    arguments = parser.parse_args()
    unknown = sorted(set(arguments.targets) - set(TARGETS))
    if unknown:
        parser.error(f"no such target: {', '.join(unknown)}")
    names = arguments.targets or list(TARGETS)
    findings = arguments.findings or Path(tempfile.mkdtemp(prefix="aifrecon-findings-"))
    findings.mkdir(parents=True, exist_ok=True)
    total = 0
    with tempfile.TemporaryDirectory(prefix="aifrecon-corpus-") as temporary:
        corpus = arguments.corpus or Path(temporary)
        print(f"{'target':26s}{'executions':>12s}{'accepted':>10s}{'s':>7s}{'per s':>8s}  crashes", flush=True)
        for name in names:
            begin = time.monotonic()
            executed, accepted, crashes = fuzz(name, arguments.seconds / len(names), findings, corpus / name, arguments.engine)
            took = time.monotonic() - begin
            print(f"{name:26s}{executed:12d}{accepted:10d}{took:7.0f}{executed / took:8.0f}  {crashes}", flush=True)
            total += executed
    found = sorted(findings.glob("*.bin"))
    print(f"{total} executions, {len(found)} findings" + (f" in {findings}" if found else ""))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
