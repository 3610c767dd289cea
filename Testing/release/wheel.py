"""Installs a wheel into an empty environment, away from this repository, and runs there what the README promises of the library.

python Testing/release/wheel.py dist/aifrecon-0.1.0-py3-none-any.whl

`make wheel-test` builds the wheel and calls this. Every Python block of README.md runs in the new environment, on the files of
`Testing/Python/doc_workplace.py`; so do `aifrecon --version` and `aifrecon info`. What the wheel
asks for comes from where pip finds it.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import venv
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(REPOSITORY / "Testing" / "Python"))

from doc_pages import blocks  # noqa: E402
from doc_workplace import make_workplace  # noqa: E402

SURROUNDINGS = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
"""Which may lead to this repository."""

EXTRAS = "figures"
"""For `plot()`."""


def environment(folder: Path, wheel: Path) -> Path:
    """The folder of the programs of a new environment that holds this wheel and what it needs."""
    venv.create(folder, with_pip=True)
    programs = folder / ("Scripts" if os.name == "nt" else "bin")
    subprocess.run([programs / "python", "-m", "pip", "install", "--quiet", f"{wheel.resolve()}[{EXTRAS}]"], env=SURROUNDINGS, check=True)
    return programs


def run(programs: Path, folder: Path) -> int:
    """How many Python blocks of the README ran in the environment, in a folder that holds their files."""

    def call(*command: str | Path, stdout: int | None = None) -> str:
        return subprocess.run(command, cwd=folder, env=SURROUNDINGS, check=True, text=True, stdout=stdout).stdout

    where = call(programs / "python", "-c", "import AIFReconLib; print(AIFReconLib.__file__)", stdout=subprocess.PIPE).strip()
    if Path(where).is_relative_to(REPOSITORY):
        raise RuntimeError(f"this is not the wheel's library: {where}")
    call(programs / "aifrecon", "--version")
    call(programs / "aifrecon", "info", "sweep.igs.mha", "--config", "PlusDeviceSet.xml")
    texts = [block.text for block in blocks(REPOSITORY / "README.md") if block.language == "python"]
    for text in texts:
        call(programs / "python", "-c", text)
    return len(texts)


def main(wheel: Path) -> None:
    """Try the wheel, and say so."""
    with tempfile.TemporaryDirectory() as folder:
        programs = environment(Path(folder, "environment"), wheel)
        here = Path(folder, "here")
        here.mkdir()
        make_workplace(here)
        print(f"{wheel.name}: installed, and {run(programs, here)} Python blocks of README.md ran")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
