"""Python packages that Slicer does not bring along, installed with the user's consent when first needed.

Slicer 5.12 brought `slicer.packaging`, which asks, installs with progress, and says when a restart is due. In 5.10 `slicer.util` asks
and installs.
"""

import importlib
import importlib.metadata
import logging
import pathlib
import subprocess

import slicer
from AIFReconScene.inputs.boneSource import BoneSource
from AIFReconScene.inputs.parameters import LiveSource
from AIFReconScene.work import warmUp, worker
from slicer.i18n import tr as _

from AIFReconLib.errors import AIFReconError

from .longWork import errorsShown

REQUIREMENTS = pathlib.Path(__file__).resolve().parent.parent / "Resources" / "requirements.txt"

MODEL = "onnxruntime>=1.18"
"""What runs a network in a file; the same as the extra `ai` of the library, which a test compares."""

PAGE = "jinja2>=3"
"""What writes pages; the same as a dependency of the library, which a test compares."""

FAST = "numba>=0.60"
"""What makes reconstruction faster; the same as the extra `fast` of the library, which a test compares."""

OFFERED = "AIFRecon/FastOffered"
"""Slicer's setting that says that it was offered, whatever the answer was."""


class PackageMissingError(AIFReconError, RuntimeError):
    """A package is not there, because the user did not want it or because it could not be installed."""


def missingLivePackages() -> list[str]:
    """What live reconstruction needs and is not installed, or is too old; as pip is told."""
    lines = [line.strip() for line in REQUIREMENTS.read_text(encoding="utf-8").splitlines()]
    return [line for line in lines if line and not line.startswith("#") and not isInstalled(line)]


def isInstalled(requirement: str) -> bool:
    """Whether a package is there in a version that the requirement asks for; that its module can be found does not say so."""
    packaging = _slicerPackaging()
    if packaging is not None:
        return packaging.pip_check(requirement)
    from packaging.requirements import Requirement

    asked = Requirement(requirement)
    try:
        return importlib.metadata.version(asked.name) in asked.specifier
    except importlib.metadata.PackageNotFoundError:
        return False


def ensureLivePackages() -> None:
    """Make sure that pyigtl is there, asking the user first; then offer what makes a scan faster.

    Raises PackageMissingError when the user declines, the installation fails, or Slicer runs tests: it installs nothing then.
    """
    question = _("To receive live images, AIFRecon needs the Python package pyigtl, a small download from the internet. Install it now?")
    _ensure(missingLivePackages, question, "live reconstruction needs it")
    offerSpeed()


def ensureModelPackages() -> None:
    """Make sure that onnxruntime is there, asking the user first; errors as for `ensureLivePackages`."""
    question = _("An AI model in a file needs the Python package onnxruntime, a download from the internet. Install it now?")
    _ensure(lambda: [] if isInstalled(MODEL) else [MODEL], question, "an AI model in a file needs it")


def ensurePagePackages() -> None:
    """Make sure that jinja2 is there, asking the user first; errors as for `ensureLivePackages`."""
    question = _("A page needs the Python package jinja2, a small download. Install it now?")
    _ensure(lambda: [] if isInstalled(PAGE) else [PAGE], question, "a page needs it")


def _ensure(missing, question: str, need: str) -> None:
    """Install what is missing where the user agrees."""
    names = ", ".join(missing())
    try:
        # slicer.packaging asks on its own
        if names and (_slicerPackaging() is not None or slicer.util.confirmOkCancelDisplay(question)):
            _install(missing())
    except (RuntimeError, subprocess.CalledProcessError) as error:
        raise PackageMissingError(f"{names} was not installed, and {need}: {error}") from error
    if missing():
        raise PackageMissingError(f"{names} is not installed, and {need}.")


def packagesAreThere(parameters, failure: str, live: bool = False) -> bool:
    """Make sure of what work with these parameters needs, asking the user first; what fails is shown under `failure`.

    It comes before the work, for a question must not lie beneath a progress dialog.
    """
    with errorsShown(failure) as outcome:
        if live and parameters.liveSource == LiveSource.OPENIGTLINK:
            ensureLivePackages()
        if parameters.boneSource == BoneSource.MODEL:
            ensureModelPackages()
    return outcome.error is None


def offerSpeed() -> None:
    """Offer numba, once: the answer is remembered in Slicer's settings. Nothing is asked where it is there, or where Slicer runs tests."""
    settings = slicer.app.userSettings()
    if slicer.app.testingEnabled() or slicer.util.settingsValue(OFFERED, False, slicer.util.toBool, settings) or isInstalled(FAST):
        return
    wanted = slicer.util.confirmYesNoDisplay(
        _(
            "AIFRecon can reconstruct several times faster, with the same result. It needs the Python package numba for that: some 60 MB "
            "from the internet, and some seconds more in the first reconstruction.\n\nInstall it now? You need not, and are asked only "
            "once; slicer.util.pip_install('numba') in the Python console installs it later."
        ),
        _("Faster reconstruction"),
    )
    settings.setValue(OFFERED, True)
    if wanted:
        try:
            _install([FAST], ask=False)
        except (RuntimeError, subprocess.CalledProcessError) as error:
            # Slicer has shown why; the work goes on without it
            logging.getLogger(__name__).info("numba was not installed: %s", error)


def _slicerPackaging():
    """Slicer's own module for this, or None."""
    try:
        return importlib.import_module("slicer.packaging")
    except ImportError:
        return None


def _install(requirements: list[str], ask: bool = True) -> None:
    packaging = _slicerPackaging()
    if packaging is None:
        slicer.util.pip_install(requirements)
    else:
        packaging.pip_ensure(requirements, prompt_install=ask, requester="AIFRecon")
    importlib.invalidate_caches()
    # One that was started before does not find it
    worker.close()
    warmUp()
