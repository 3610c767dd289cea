"""What Slicer's extension index asks of this repository, checked without a network; and the one edit that publishing takes.

python Testing/release/extension_index.py                                                       what is ready, and what waits
python Testing/release/extension_index.py --homepage https://github.com/OWNER/SlicerAIFRecon    writes every address from this one

The rules are those of the index's own check and of its form for new extensions, as of August 2026 (Slicer/ExtensionsIndex, 07f1d1b).
docs/publishing.md goes through them. The index reads CMakeLists.txt as text, so its addresses are spelled out there: no CMake
variable.
"""

from __future__ import annotations

import argparse
import json
import re
import struct
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlsplit

REPOSITORY = Path(__file__).resolve().parents[2]
SCHEMA = "https://raw.githubusercontent.com/Slicer/Slicer/main/Schemas/slicer-extension-catalog-entry-schema-v1.0.2.json#"
BRANCH = "main"
ICON = "Resources/AIFRecon.png"
SCREENSHOTS = ("result", "compare", "registration", "guidance")
LICENSES = ("LICENSE", "LICENCE", "License.txt", "license.txt", "LICENSE.txt", "COPYING", "COPYING.txt")
LARGEST_MB = 100
UNKNOWN = "NA"


@dataclass(frozen=True)
class Rule:
    """One thing that the index asks: whether it is met, or None where it waits for the repository's address."""

    asks: str
    met: bool | None
    found: str = ""


def extension_of(cmake: str) -> dict[str, str]:
    """The `EXTENSION_` values of CMakeLists.txt, and its project as `NAME`, as the index reads them."""
    values = dict(re.findall(r'^set\((EXTENSION_\w+) "([^"]*)"\)', cmake, re.MULTILINE))
    project = re.search(r"project\s*\(\s*([^\s)]+)", cmake)
    return {**values, "NAME": project.group(1) if project else ""}


def addresses(homepage: str) -> dict[str, str]:
    """What follows from the address of the repository."""
    raw = homepage.replace("https://github.com/", "https://raw.githubusercontent.com/") + f"/{BRANCH}/"
    pictures = " ".join(f"{raw}Resources/Screenshots/{name}.png" for name in SCREENSHOTS)
    return {"EXTENSION_HOMEPAGE": homepage, "EXTENSION_ICONURL": raw + ICON, "EXTENSION_SCREENSHOTURLS": pictures}


def entry(extension: dict[str, str]) -> dict[str, object]:
    """The file that the index takes, NAME.json."""
    depends = extension["EXTENSION_DEPENDS"]
    return {
        "$schema": SCHEMA,
        "build_dependencies": [] if depends == UNKNOWN else depends.split(),
        "build_subdirectory": ".",
        "category": extension["EXTENSION_CATEGORY"],
        "scm_revision": BRANCH,
        "scm_url": extension["EXTENSION_HOMEPAGE"] + ".git",
        "tier": 1,
    }


def rules(extension: dict[str, str], repository: Path = REPOSITORY) -> Iterator[Rule]:
    """Everything that can be checked here."""
    homepage = extension["EXTENSION_HOMEPAGE"]
    known = homepage != UNKNOWN
    parts = urlsplit(homepage)
    name = extension["NAME"]
    yield Rule(
        "the extension's name is the project's and does not begin with Slicer", bool(name) and not name.lower().startswith("slicer"), name
    )
    yield Rule("the category is Ultrasound", extension["EXTENSION_CATEGORY"] == "Ultrasound", extension["EXTENSION_CATEGORY"])
    description = extension["EXTENSION_DESCRIPTION"]
    yield Rule("the description is one or two sentences", 40 < len(description) < 300, description)
    people = extension["EXTENSION_CONTRIBUTORS"]
    yield Rule(
        "contributors are Name (Organization)", re.fullmatch(r"[^(),]+ \([^()]+\)(, [^(),]+ \([^()]+\))*", people) is not None, people
    )
    width, height = struct.unpack(">II", (repository / ICON).read_bytes()[16:24])
    yield Rule("the icon has 128 x 128 pixels", (width, height) == (128, 128), f"{width} x {height}")
    pictures = [repository / "Resources" / "Screenshots" / f"{shot}.png" for shot in SCREENSHOTS]
    yield Rule("there is a screenshot", all(path.is_file() for path in pictures), f"{len(pictures)}")
    found = [one for one in LICENSES if (repository / one).is_file()]
    yield Rule("the license lies at the top", bool(found), ", ".join(found))
    yield _small_enough(repository)
    yield Rule("the address is one of https", parts.scheme == "https" if known else None, homepage)
    repository_name = parts.path.strip("/").split("/")[-1]
    yield Rule("the repository's name begins with Slicer", repository_name.startswith("Slicer") if known else None, repository_name)
    expected = addresses(homepage) if known else dict.fromkeys(addresses(homepage), UNKNOWN)
    wrong = [key for key, value in expected.items() if extension[key] != value]
    yield Rule(
        "every address follows from that of the repository", (not wrong if known else None) if not wrong else False, ", ".join(wrong)
    )


def _small_enough(repository: Path) -> Rule:
    asks = f"the repository is at most {LARGEST_MB} MB"
    try:
        listed = subprocess.run(["git", "ls-files", "-z"], cwd=repository, capture_output=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        return Rule(asks, None, "only git knows which files belong to it, and it is not here")
    files = (repository / name for name in listed.stdout.decode().split("\0") if name)
    size = sum(path.stat().st_size for path in files if path.is_file()) / 2**20
    return Rule(asks, size <= LARGEST_MB, f"{size:.0f} MB, without its history")


def published(cmake: str, homepage: str) -> str:
    """CMakeLists.txt with the addresses that follow from the repository's."""
    for key, value in addresses(homepage).items():
        cmake = re.sub(rf'^set\({key} "[^"]*"\)', f'set({key} "{value}")', cmake, flags=re.MULTILINE)
    return cmake


def with_urls(project: str, homepage: str) -> str:
    """pyproject.toml with the same addresses for the package index."""
    owner, name = urlsplit(homepage).path.strip("/").split("/")[:2]
    urls = {"Homepage": homepage, "Documentation": f"https://{owner.lower()}.github.io/{name}/", "Issues": f"{homepage}/issues"}
    urls["Changelog"] = f"{homepage}/blob/{BRANCH}/CHANGELOG.md"
    table = "[project.urls]\n" + "".join(f'{key} = "{value}"\n' for key, value in urls.items()) + "\n"
    project = re.sub(r"^\[project\.urls\]\n(?:.+\n)*\n", "", project, flags=re.MULTILINE)
    return project.replace("[project.scripts]", f"{table}[project.scripts]")


def with_repository(citation: str, homepage: str) -> str:
    """CITATION.cff with the place of the code."""
    citation = re.sub(r"^repository-code:.*\n", "", citation, flags=re.MULTILINE)
    return re.sub(r"^(license: .*\n)", rf'\1repository-code: "{homepage}"\n', citation, flags=re.MULTILINE)


EDITS = {"CMakeLists.txt": published, "pyproject.toml": with_urls, "CITATION.cff": with_repository}


def main(arguments: list[str] | None = None, repository: Path = REPOSITORY) -> int:
    """0 when nothing is wrong, waiting or not; 1 when a rule is broken."""
    parser = argparse.ArgumentParser(description="Check what Slicer's extension index asks; write the addresses that publishing needs.")
    parser.add_argument(
        "--homepage", metavar="URL", help="https://github.com/OWNER/SlicerAIFRecon: write every address that follows from it"
    )
    homepage = parser.parse_args(arguments).homepage
    if homepage:
        for name, edit in EDITS.items():
            path = repository / name
            path.write_text(edit(path.read_text("utf-8"), homepage.rstrip("/").removesuffix(".git")), "utf-8")
    extension = extension_of((repository / "CMakeLists.txt").read_text("utf-8"))
    found = list(rules(extension, repository))
    for rule in found:
        print(f"  {'waits' if rule.met is None else 'ok' if rule.met else 'WRONG':6} {rule.asks}{': ' if rule.found else ''}{rule.found}")
    if extension["EXTENSION_HOMEPAGE"] != UNKNOWN:
        print(f"\n{extension['NAME']}.json for the index:\n{json.dumps(entry(extension), indent=2)}")
    return 1 if any(rule.met is False for rule in found) else 0


if __name__ == "__main__":
    sys.exit(main())
