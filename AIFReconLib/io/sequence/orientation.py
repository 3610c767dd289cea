"""Ultrasound image orientation codes: which way the stored pixels run, and what brings them to MF.

Two letters name the transducer axis along +x and +y of the stored image: M marked or U unmarked (lateral), F far or N near
(axial). B-mode images are MF, MN, UF or UN; radio-frequency data lie across. A third letter, A or D, names the elevational
direction, which 2D frames do not have.

Slicer's sequences may carry the code as the attribute ``Sequences.UltrasoundImageOrientation``, which it copies from the file it
imported. Its writer of metafiles spells an unknown orientation ``??`` and the type ``BRIGHTNESSBRIGHTNESS``.
"""

from __future__ import annotations

import re

from ...errors import SettingsError
from ...message import shorten
from ..metafile.metafile import Metafile
from ..metafile.opening import NRRD_SUFFIXES

IN_MEMORY = "MFA"
"""How frames are kept and written: marked side at the last column (on the right), transducer at row 0."""

BRIGHTNESS = "BRIGHTNESS"
_DISPLAYABLE_TYPES = (BRIGHTNESS, "RGB_COLOR")

_ORIENTATION_KEY = "ultrasoundimageorientation"
_TYPE_KEY = "ultrasoundimagetype"
_SLICER_PREFIX = "sequences."

_UNKNOWN_CODES = ("??", "XX")
"""How IGSIO and Slicer write that they do not know the orientation."""


def is_image_key(key: str) -> bool:
    """Whether a header key holds the orientation or the type: MetaImage writes them as one word, NRRD with spaces."""
    return _plain(key) in (_ORIENTATION_KEY, _TYPE_KEY)


def parse_orientation(code: str) -> str:
    """A B-mode orientation that somebody asks for, upper case.

    Raises SettingsError when it is none.
    """
    if not re.fullmatch("[MU][FN][AD]?", code.upper()):
        raise SettingsError(f"Input orientation must be MF, MN, UF or UN; got {shorten(code)!r}. Say which way the stored pixels run.")
    return code.upper()


def required_flips(metafile: Metafile, stated: str | None = None) -> tuple[bool, bool]:
    """Whether columns, and whether rows must be reversed to bring the stored images to MF.

    Raises SequenceFormatError for radio-frequency data and for a code that is none.

    Parameters
    ----------
    metafile : Metafile
    stated : str or None
        The orientation that the caller knows better than the file.
    """
    with_blanks = metafile.path.suffix.lower() in NRRD_SUFFIXES
    # Plus keeps the other format's key of a file that it converts, and means its own
    keys = sorted(filter(is_image_key, metafile.fields), key=lambda key: ((" " in key) == with_blanks, "." not in key))
    values = {_plain(key): metafile.fields[key] for key in keys}
    image_type = values.get(_TYPE_KEY, "").upper().replace(BRIGHTNESS * 2, BRIGHTNESS) or BRIGHTNESS
    code = stated or values.get(_ORIENTATION_KEY, "").upper() or IN_MEMORY
    if image_type.startswith("RF_") or re.fullmatch("[FN][MU][AD]?", code):
        raise metafile.failure(f"it holds radio-frequency data (type {image_type}, orientation {code}). Export B-mode frames from Plus.")
    if image_type not in _DISPLAYABLE_TYPES:
        must = f"UltrasoundImageType must be {' or '.join(_DISPLAYABLE_TYPES)}"
        raise metafile.failure(f"{must}; got {shorten(image_type)!r}. Export B-mode frames from Plus.")
    if not re.fullmatch("[MU][FN][AD]?", code):
        who = ": whoever wrote the file did not know it" * (code in _UNKNOWN_CODES)
        raise metafile.failure(
            f"UltrasoundImageOrientation must be MF, MN, UF or UN; got {shorten(code)!r}{who}.",
            "Look which side of the images is marked and say it with {orientation:CODE}: a wrong code mirrors the anatomy.",
        )
    return code[0] == "U", code[1] == "N"


def _plain(key: str) -> str:
    return key.replace(" ", "").lower().removeprefix(_SLICER_PREFIX)
