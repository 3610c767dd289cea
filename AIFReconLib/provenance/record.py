"""What a reconstruction was made with: settings that repeat it to the same voxels, and the header of its volumes that says so.

What the inputs say themselves, a Plus configuration above all, is left to them: it says the same again. What the caller gave, and what was
chosen from defaults, poses and images, is kept.
"""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping
from dataclasses import replace
from pathlib import Path

from .. import __version__
from ..compounding.methods.table import BONE_METHODS, is_own_method, method_named
from ..compounding.state import Reconstruction
from ..effective_settings import Imaging, imaging_fields
from ..geometry.volume import Volume
from ..io.disk.regular_files import size_of
from ..message import listed
from ..recipe.recipe import AUTOMATIC, KEPT, OF_READING, OF_REGION, RULES, Recipe
from ..sweep.configuration import PlusConfiguration
from ..sweep.frames import TrackedSequence

SETTINGS, INPUTS, VERSION, METHOD = "AIFRecon_settings", "AIFRecon_inputs", "AIFRecon_version", "AIFRecon_method"
FRAMES, FOUND, SIMULATED = "AIFRecon_frames", "AIFRecon_found", "AIFRecon_simulated"
"""Keys of a volume's header."""

PLACES = (".tfm", ".h5", ".mat")
"""Ends of the names of files that place a CT."""

_SHOWN = "shown"
"""Of an input in a header: no voxel was made of it."""

VOLUMES = ("intensity", "score", "hits", "mask", "cosine")

_BY_CONFIGURATION = ("method", "spacing", "skip", "interpolation", "pixel_rejection")
"""What a configuration may say of a reconstruction, by its names there and in the settings."""


def kept_settings(
    asked: Recipe,
    resolved: Recipe,
    result: Reconstruction,
    imaging: Imaging,
    configuration: PlusConfiguration,
) -> dict[str, object]:
    """The settings that give the same voxels from the same inputs, by the names that settings files have for them.

    Parameters
    ----------
    asked, resolved : Recipe
        As the caller gave them, and as `resolve_settings` returned them.
    result : Reconstruction
        For what it chose: hole limit and grid.
    imaging : Imaging
        That was used.
    configuration : PlusConfiguration
        What it says is left to it.
    """
    given = {name: getattr(asked, name) for name in KEPT if name not in OF_REGION and name not in result.unused}
    kept = {name: value for name, value in given.items() if value is not None and value is not False}
    kept |= result.bone
    for name in OF_READING:
        if kept.get(name) == RULES[name]["default"]:
            # Nothing was asked for, or it was done before the recording came here
            kept.pop(name, None)
    for name in _BY_CONFIGURATION:
        value = getattr(resolved, name)
        if value is not None and value != getattr(configuration, name):
            kept.setdefault(name, value)
    if asked.hole_limit == AUTOMATIC and result.hole_limit > 0:
        kept["hole_limit"] = result.hole_limit
    region = None if imaging.region == configuration.imaged_region else imaging.region
    probe = None if imaging.probe == configuration.probe else imaging.probe
    kept |= imaging_fields(region, probe)
    if method_named(result.method).needs_shadows or asked.bone_from_sweep:
        kept["gray_levels"] = list(imaging.gray_levels.landmarks)
    kept["grid_size"] = list(result.grid.size)
    kept["grid_to_reference"] = result.grid.ijk_to_reference.tolist()
    return kept


def with_origin(
    result: Reconstruction,
    imaging: Imaging,
    asked: Recipe,
    resolved: Recipe,
    configuration: PlusConfiguration,
    inputs: Iterable[Path],
    found_width: bool = False,
) -> Reconstruction:
    """A result as it was made, signed with its settings and inputs; see `kept_settings` and `signed`.

    `found_width`: the width of the bone map was not given. A header names what was found or is simulated.
    """
    kept = kept_settings(asked, resolved, result, imaging, configuration)
    found = {"bone_sigma_mm": found_width, "hole_limit": asked.hole_limit == AUTOMATIC}
    fields = {FOUND: " ".join(name for name, is_found in found.items() if is_found), SIMULATED: "true" * configuration.simulated}
    return _with_fields(signed(result, kept, inputs), {key: value for key, value in fields.items() if value})


def input_files(sequence: TrackedSequence) -> list[Path]:
    """The files of recordings and configurations, as far as they are known."""
    found = (path for each in sequence.sweeps for path in (each.path, each.configuration.path))
    return [path for path in dict.fromkeys(found) if path is not None]


def signed(
    result: Reconstruction,
    settings: Mapping[str, object],
    inputs: Iterable[Path],
    stream: Mapping[str, object] | None = None,
    shown: Collection[Path] = (),
) -> Reconstruction:
    """The result with volumes that say in their headers, when they are written, where they come from.

    Parameters
    ----------
    result : Reconstruction
    settings : mapping
        As `kept_settings` returns them.
    inputs : paths
        Files that were read. Only their names and sizes are kept: folders may name a patient.
    stream : mapping or None
        How a live stream was read; a recording of it needs none of that.
    shown : paths
        Of the inputs: those that pictures show, and no voxel was made of.
    """
    fields = {
        VERSION: __version__,
        METHOD: result.method,
        "AIFRecon_hole_limit_mm": f"{result.hole_limit:g}",
        FRAMES: str(result.frames_inserted),
        SETTINGS: json.dumps(settings, sort_keys=True),
        INPUTS: json.dumps([_named(path) | ({_SHOWN: True} if path in shown else {}) for path in dict.fromkeys(inputs)]),
    }
    if stream:
        fields["AIFRecon_stream"] = json.dumps(stream, sort_keys=True)
    return _with_fields(result, fields)


def _with_fields(result: Reconstruction, fields: Mapping[str, str]) -> Reconstruction:
    volumes = {name: volume for name in VOLUMES if (volume := getattr(result, name)) is not None}
    return replace(result, **{name: replace(volume, fields={**volume.fields, **fields}) for name, volume in volumes.items()})


def settings_of(volume: Volume) -> dict[str, object]:
    """The settings that a volume was made with; none where it does not say so, or not as it is understood here."""
    found = _said(volume.fields, SETTINGS)
    return found if isinstance(found, dict) else {}


def made_in_header(fields: Mapping[str, str]) -> dict[str, object]:
    """The same of a header, with the method, which a configuration may have named, the number of frames and the files that it was made
    from; nothing where it does not say so."""
    method, settings = fields.get(METHOD), _said(fields, SETTINGS)
    if not method:
        return {}
    names = [each["name"] for each in inputs_in(fields) if not each.get(_SHOWN)]
    known = settings if isinstance(settings, dict) else {}
    found, simulated = fields.get(FOUND, "").split(), SIMULATED in fields
    return {**known, "method": method, "frames": fields.get(FRAMES, ""), "inputs": names, "found": found, "simulated": simulated}


def _said(fields: Mapping[str, str], key: str) -> object:
    try:
        return json.loads(fields.get(key, "null"))
    except (ValueError, RecursionError):
        return None


def weighted_by(volume: Volume, paths: Iterable[Path]) -> bool:
    """Whether one of these files said where bone is to the method that made a volume, by what its header says."""
    before, method = inputs_in(volume.fields), volume.fields.get(METHOD, "")
    if settings_of(volume).get("bone_sigma_mm") == AUTOMATIC:  # its own echoes said it
        return False
    return (method in BONE_METHODS or is_own_method(method)) and any(_named(path) in before for path in paths)


def unlike_inputs(headers: Mapping[str, Mapping[str, str]], given: Iterable[Path | None]) -> list[str]:
    """What speaks against volumes and files that are given with them being of one scan, a sentence each.

    Two files of one name are of two patients, and the place of the CT with which a volume was made is needed again.

    Parameters
    ----------
    headers : mapping
        Fields of each volume's header by its name.
    given : paths
        Labels, CT, their place and recordings; None for what is not given.
    """
    files = [_named(path) for path in given if path is not None]
    inputs = {name: inputs_in(fields) for name, fields in headers.items()}
    known = {each["name"]: ("is given", each.get("bytes")) for each in files if not _is_place(each)}
    others: dict[tuple[str, str], list[str]] = defaultdict(list)
    for name, found in inputs.items():
        for each in found:
            other, size = known.setdefault(each["name"], (name, each.get("bytes")))
            if size != each.get("bytes") and not _is_place(each):
                others[name, other].append(str(each["name"]))
    told = [
        f"WARNING: {name} was made from another {listed(files)} than {other}. Are both of the same patient?"
        for (name, other), files in others.items()
    ]
    for name, found in inputs.items():
        place = next(filter(_is_place, found), None)
        if place is None or place in files or not any(each in found for each in files):
            continue
        if all(each["name"] == place["name"] for each in files if _is_place(each)):
            which = f"{place['name']} ({place.get('bytes')} bytes)"
            told.append(f"WARNING: {name} was made with {which}, which places the CT, and it is not given now.")
    return told


def _is_place(entry: Mapping[str, object]) -> bool:
    """Whether an input placed a CT: another place is found for the same patient, too."""
    return str(entry["name"]).endswith(PLACES)


def inputs_in(fields: Mapping[str, str]) -> list[Mapping[str, object]]:
    """The files that a header names."""
    found = _said(fields, INPUTS)
    return [each for each in found if isinstance(each, dict) and "name" in each] if isinstance(found, list) else []


def _named(path: Path) -> dict[str, object]:
    try:
        return {"name": path.name, "bytes": size_of(path)}
    except OSError:  # it was there when it was read
        return {"name": path.name}


def other_inputs(source: str, before: Iterable[Mapping[str, object]], inputs: Iterable[Path]) -> list[str]:
    """How the inputs differ from those of the volume that is repeated, a sentence each.

    Parameters
    ----------
    source : str
        Name of that volume.
    before : iterable of mappings
        Its inputs, as its header has them.
    inputs : paths
    """
    sizes = defaultdict(set)
    for path in inputs:
        sizes[path.name].add(_named(path).get("bytes"))
    notes = []
    for each in before:
        name, size = each.get("name"), each.get("bytes")
        if name not in sizes:
            notes.append(f"{source} was made from {name} too, which is not given now.")
        elif size not in sizes[str(name)]:
            notes.append(f"{name} is not the file that {source} was made from: its size was {size} bytes.")
    return notes
