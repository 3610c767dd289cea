"""Python packages that Slicer does not bring along, installed with the user's consent when first needed."""

import importlib.util
import pathlib
import subprocess

import slicer
from slicer.i18n import tr as _

from AIFReconLib.errors import AIFReconError

REQUIREMENTS = pathlib.Path(__file__).resolve().parent.parent / "Resources" / "requirements.txt"


class PackageMissingError(AIFReconError, RuntimeError):
    """A package is not there, because the user did not want it or because it could not be installed."""


def ensureLivePackages() -> None:
    """Make sure that pyigtl is there, asking the user first.

    Raises
    ------
    PackageMissingError
        When the user declines or the installation fails.
    """
    if importlib.util.find_spec("pyigtl") is not None:
        return
    try:
        from slicer import packaging
    except ImportError:
        packaging = None
    try:
        if packaging is not None:
            packaging.pip_ensure(packaging.load_requirements(REQUIREMENTS), requester="AIFRecon")
        elif slicer.util.confirmOkCancelDisplay(_("Live reconstruction needs the Python package pyigtl. Install it now?")):
            slicer.util.pip_install(["-r", str(REQUIREMENTS)])
    except (RuntimeError, subprocess.CalledProcessError) as error:
        raise PackageMissingError("pyigtl was not installed, and live reconstruction needs it: {why}", why=error) from error
    importlib.invalidate_caches()
    if importlib.util.find_spec("pyigtl") is None:
        raise PackageMissingError("pyigtl is not installed, and live reconstruction needs it.")
