"""The wires of a calibration phantom, as a Plus configuration describes them (PhantomDefinition)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ...arrays import Floats
from ...errors import ConfigurationError
from ..disk.xml_tree import parse_xml
from .xml_attributes import Attributes

FEWEST = 2
"""N's that make a calibration: one leaves open how the image is tilted."""


def read_wire_phantom(path: str | Path) -> dict[str, Floats]:
    """The wires of a phantom of N's by name, (2, 3) mm each: front and back end in the phantom's frame; every three in order are an N.

    The three of an N are side, middle and side, as Plus lists them.

    Raises
    ------
    ConfigurationError
        Where the file describes no such phantom, and names what cannot be used.
    """
    path = Path(path)
    geometry = parse_xml(path).find("PhantomDefinition/Geometry")
    patterns = [] if geometry is None else [each for each in geometry.iterfind("Pattern") if each.get("Type", "").upper() == "NWIRE"]
    if len(patterns) < FEWEST:
        needs = f"a phantom needs {FEWEST} patterns of Type NWire in PhantomDefinition/Geometry; it has {len(patterns)}"
        raise ConfigurationError(f"{path}: {needs}. Give the configuration of your phantom, in the form of Plus 2.2 or later.")
    wires: dict[str, Floats] = {}
    for number, pattern in enumerate(patterns, start=1):
        elements = pattern.findall("Wire")
        if len(elements) != 3:
            raise ConfigurationError(f"{path}: NWire pattern {number} must have three wires; it has {len(elements)}. Correct it.")
        for element in elements:
            attributes = Attributes(path, element, f"NWire pattern {number}, Wire")
            name = attributes.text("Name", required=True)
            if name in wires:
                raise attributes.failure("Name", f"is {name} twice. Give every wire a name of its own.")
            wires[name] = np.array([attributes.numbers(3, end, required=True) for end in ("EndPointFront", "EndPointBack")])
    return wires
