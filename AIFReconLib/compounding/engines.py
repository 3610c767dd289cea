"""Which engine does the arithmetic."""

from __future__ import annotations

import logging
from importlib.util import find_spec
from typing import TYPE_CHECKING

from ..errors import SettingsError
from .numpy_engine import NumpyEngine

if TYPE_CHECKING:
    from .compiled.numba_engine import NumbaEngine

logger = logging.getLogger(__name__)

INSTALL_NUMBA = "pip install 'numba>=0.60'"


def choose_engine(wanted: str) -> tuple[type[NumpyEngine] | type[NumbaEngine], str | None]:
    """The class of an engine, and what the user should know about the choice.

    Raises SettingsError when numba is asked for and is not there, or does not work.

    Parameters
    ----------
    wanted : "auto", "numpy" or "numba"
        "auto" is numba where it is installed and works.
    """
    if wanted == "numpy":
        return NumpyEngine, None
    if find_spec("numba") is None:
        if wanted == "numba":
            raise SettingsError(
                f"Input engine must be auto or numpy where numba is not installed; got 'numba'. Install it: {INSTALL_NUMBA}."
            )
        return NumpyEngine, None
    try:
        from .compiled.numba_engine import NumbaEngine
    # A numba that does not fit its numpy or its Python fails in whatever way it likes
    except Exception as error:
        cause = next(iter(str(error).splitlines()), "")
        reason = f"numba is installed but does not work ({type(error).__name__}: {cause})"
        if wanted == "numba":
            raise SettingsError(
                f"Input engine must be auto or numpy: {reason}. Reinstall it: {INSTALL_NUMBA} --force-reinstall."
            ) from error
        logger.warning("%s; the numpy engine stands in", reason, exc_info=True)
        return NumpyEngine, f"Warning: {reason}; the slower numpy engine was used. The voxels are the same."
    return NumbaEngine, None
