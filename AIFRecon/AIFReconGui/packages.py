"""Python packages that Slicer does not bring along, installed with the user's consent when first needed."""

import importlib.util
import pathlib

import slicer
from slicer.i18n import tr as _

REQUIREMENTS = pathlib.Path(__file__).resolve().parent.parent / "Resources" / "requirements.txt"


def ensureLivePackages() -> None:
    """Make sure that pyigtl is there, asking the user first.

    Raises
    ------
    RuntimeError
        When the user declines or the installation fails.
    """
    if importlib.util.find_spec("pyigtl") is not None:
        return
    try:
        from slicer import packaging
    except ImportError:
        if not slicer.util.confirmOkCancelDisplay(_("Live reconstruction needs the Python package pyigtl. Install it now?")):
            raise RuntimeError(_("pyigtl is not installed, and live reconstruction needs it.")) from None
        slicer.util.pip_install(["-r", str(REQUIREMENTS)])
        return
    packaging.pip_ensure(packaging.load_requirements(REQUIREMENTS), requester="AIFRecon")
