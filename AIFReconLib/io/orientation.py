"""Ultrasound image orientation codes: which way the stored pixels run, and what brings them to MF.

Two letters name the transducer axis along +x and +y of the stored image: M marked or U unmarked (lateral), F far or N near
(axial). B-mode images are MF, MN, UF or UN; radio-frequency data lie across. A third letter, A or D, names the elevational
direction, which 2D frames do not have.
"""

from __future__ import annotations

import re

from .metafile import Metafile
from .text_values import shorten

IN_MEMORY = "MFA"
"""How frames are kept and written: marked side at column 0, transducer at row 0."""

BRIGHTNESS = "BRIGHTNESS"
_DISPLAYABLE_TYPES = (BRIGHTNESS, "RGB_COLOR")

_ORIENTATION_KEY = "ultrasoundimageorientation"
_TYPE_KEY = "ultrasoundimagetype"


def is_image_key(key: str) -> bool:
    """Whether a header key holds the orientation or the type: MetaImage writes them as one word, NRRD with spaces."""
    return _plain(key) in (_ORIENTATION_KEY, _TYPE_KEY)


def required_flips(metafile: Metafile) -> tuple[bool, bool]:
    """Whether columns, and whether rows must be reversed to bring the stored images to MF.

    Raises
    ------
    SequenceFormatError
        For radio-frequency data and for a code that is none.
    """
    values = {_plain(key): value for key, value in metafile.fields.items() if is_image_key(key)}
    image_type = values.get(_TYPE_KEY, "").upper() or BRIGHTNESS
    code = values.get(_ORIENTATION_KEY, "").upper() or IN_MEMORY
    if image_type.startswith("RF_") or re.fullmatch("[FN][MU][AD]?", code):
        raise metafile.failure(
            f"it holds radio-frequency data (type {image_type}, orientation {code}), which are not images. Export B-mode frames from Plus."
        )
    if image_type not in _DISPLAYABLE_TYPES:
        raise metafile.failure(
            f"UltrasoundImageType must be {' or '.join(_DISPLAYABLE_TYPES)}; got {shorten(image_type)!r}. Export B-mode frames from Plus."
        )
    if not re.fullmatch("[MU][FN][AD]?", code):
        raise metafile.failure(
            f"UltrasoundImageOrientation must be MF, MN, UF or UN; got {shorten(code)!r}. Correct the header: "
            "a wrong code mirrors the anatomy."
        )
    return code[0] == "U", code[1] == "N"


def _plain(key: str) -> str:
    return key.replace(" ", "").lower()
