"""The options of a reconstruction, recorded or live, which are the columns of a table of cases too; and the bone that they name."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar

from .. import __version__
from ..compounding.needs import needs_bone
from ..compounding.state import Reconstruction
from ..effective_settings import takes_out_motion
from ..errors import SettingsError
from ..geometry.labels import Labels
from ..geometry.transform_graph import capital
from ..geometry.volume import VoxelGrid
from ..imaging.beams import LINEAR
from ..io.sequence.files import read_sequence
from ..io.volume.files import read_volume
from ..progress import Progress
from ..provenance.record import other_inputs, settings_of, signed
from ..provenance.settings_files import read_settings
from ..provenance.settings_schema import KeptSettings
from ..recipe.recipe import BoneSettings, ImagingSettings, MethodSettings, OutputSettings, VolumeSettings
from ..sweep.poses import ends_of
from ..workflows.job import BoneSource
from .arguments import Options, Output, Rivals, Settings, reading
from .labels_options import PlacedLabelsOptions, labels_from, labels_inputs, names_labels, place_from
from .remedies import as_option
from .sequence_options import ImageOptions

SIDE_OUTPUTS = ("score", "hits", "mask", "cosine")


class _BoneOptions(PlacedLabelsOptions):
    """bone: a registered CT's segmentation, or a bone probability; methods that weight by incidence need one

    Parameters
    ----------
    bone_probability : VOLUME
        ready bone probability, 0 to 1
    bone_frames : SEQUENCE
        no CT: a sequence of a network's predictions for the frames, 8 bit or 0 to 1; of several sweeps once for each
    bone_model : FILE.onnx
        no CT: a network that tells bone in a frame (needs onnxruntime)
    """

    bone_probability: Path | None = None
    bone_frames: list[Path] = []
    bone_model: Path | None = None

    SETTINGS: ClassVar[Settings] = ("bone_from_sweep", BoneSettings)
    RIVALS: ClassVar[Rivals] = (
        ("bone_labels", "bone_probability", "bone_from_sweep", "bone_frames", "bone_model"),
        ("bone_sigma_voxels", "bone_sigma_mm"),
    )


class _VolumeOptions(Options):
    """volume

    Parameters
    ----------
    grid_like : VOLUME
        use this volume's voxels (any orientation)
    score : FILE
        also write this volume: sum of weights
    hits : FILE
        also write this volume: pixels per voxel
    mask : FILE
        also write this volume: 0 empty, 1 measured, 2 filled
    cosine : FILE
        also write this volume: best cosine of incidence
    preview : FILE.png
        also draw cuts through the bone (needs matplotlib)
    """

    grid_like: Path | None = None
    score: Output | None = None
    hits: Output | None = None
    mask: Output | None = None
    cosine: Output | None = None
    preview: Output | None = None

    SETTINGS: ClassVar[Settings] = ("spacing", VolumeSettings, OutputSettings)
    RIVALS: ClassVar[Rivals] = (("grid_like", "spacing"),)


class _AllImageOptions(ImageOptions):
    """image: what the image shows; default: the configuration's, else recognized by the black surround"""

    SETTINGS: ClassVar[Settings] = (ImagingSettings,)


class _TuningOptions(Options):
    """tuning"""

    SETTINGS: ClassVar[Settings] = (MethodSettings, "skip")


class _KeptOptions(Options):
    """settings: repeat a reconstruction, on the same voxels

    Parameters
    ----------
    settings : FILE
        take settings from this volume that aifrecon wrote (.nrrd, .mha, .mhd), or from this file (.json, .toml); files are given as always,
        and options given beside it win
    save_settings : FILE
        also write the settings, what was chosen by itself included (.json, .toml)
    """

    settings: Path | None = None
    save_settings: Output | None = None

    kept: ClassVar[KeptSettings | None] = None
    """What was read."""
    NOT_KEPT: ClassVar[tuple[str, ...]] = ()
    """Settings that are not taken from a file."""

    def complete(self) -> None:
        """Take settings from the file, where one is given."""
        if self.settings is not None:
            kept = read_settings(self.settings)
            taken = _beside_given(self, dict(kept.options))
            vars(self).update({name: value for name, value in taken.items() if name not in (*vars(self), *self.NOT_KEPT)}, kept=kept)


class ReconstructionOptions(_BoneOptions, _AllImageOptions, _VolumeOptions, _TuningOptions, _KeptOptions):
    """All that a reconstruction can be asked for, beside what says how a sweep is tracked."""


_BOX = ("grid_size", "grid_to_reference")
_INSTEAD = {
    "image_to_reference": ("reference",),
    **dict.fromkeys(("spacing", "grid_like"), _BOX),
    "bone_sigma_voxels": ("bone_sigma_mm",),
    **dict.fromkeys(("bone_labels", "bone_probability", "bone_frames", "bone_model"), ("bone_from_sweep",)),
    "apex_px": ("probe", "fan_apex_px"),
    **dict.fromkeys(("fan_angles_deg", "fan_radius_px"), ("fan_pixel_size", "fan_detection")),
}
"""Kept settings that do not go with an option that is given."""


def _beside_given(given: _KeptOptions, kept: dict[str, Any]) -> dict[str, Any]:
    """Kept settings without those that do not go with the given ones."""
    names = {name for option, instead in _INSTEAD.items() if getattr(given, option, None) for name in instead}
    asked = _target(given.reference, given.image_to_reference)
    if asked is not None and asked != _target(kept.get("reference"), kept.get("image_to_reference")):
        names.update(_BOX)
    if given.probe == LINEAR:
        names.add("apex_px")
    if not (given.fan_angles_deg or given.fan_radius_px):
        names.discard("fan_apex_px")
    return {name: value for name, value in kept.items() if name not in names}


def _target(reference: object, image_to_reference: object) -> str | None:
    """The frame that both options together name, if they do."""
    if reference:
        return capital(str(reference))
    return ends_of(str(image_to_reference)).target if image_to_reference else None


def with_provenance(
    result: Reconstruction, asked: ReconstructionOptions, inputs: list[Path | None], stream: Mapping[str, object] | None = None
) -> Reconstruction:
    """The result with volumes that know all settings and inputs; notes say what differs from the volume that was to be repeated.

    Parameters
    ----------
    result : Reconstruction
        As `reconstruct` returns it.
    asked : ReconstructionOptions
    inputs : list of Path or None
        Files that were read; those that say where bone is are not named where that was not asked.
    stream : mapping or None
        See `signed`.
    """
    unused = () if needs_bone(result.method, asked.recipe) or takes_out_motion(asked.recipe) else bone_inputs(asked)
    files, kept = [path for path in inputs if path is not None and path not in unused], asked.kept
    notes = [] if kept is None else list(other_inputs(kept.path.name, kept.inputs, files))
    if kept is not None and kept.version not in ("", __version__):
        notes.insert(0, f"The settings are of version {kept.version}, and this is {__version__}: voxels may differ.")
    # Of labels and a CT the labels say where bone is
    shown = [asked.ct] if asked.ct is not None and asked.bone_labels else []
    return replace(signed(result, settings_of(result.intensity), files, stream, shown), messages=(*result.messages, *notes))


def _bytes(text: str) -> int:
    """GB, or the unit that is named, as bytes."""
    found = re.fullmatch(r"\s*(.*?)\s*([kmgt]?i?b|[mgt])?\s*", text, re.IGNORECASE | re.DOTALL)
    size = float(found[1]) * UNITS.get((found[2] or "GB").upper().removesuffix("B"), 0.0) if found else 0.0
    if not 0 < size < float("inf"):
        raise ValueError
    return int(size)


gigabytes = reading(_bytes, "a positive size such as 1.5GB")

UNITS = {"M": 1e6, "G": 1e9, "T": 1e12, "MI": 2.0**20, "GI": 2.0**30, "TI": 2.0**40}
"""Bytes of each, without the B."""


def grid_from(asked: _VolumeOptions) -> VoxelGrid | None:
    """The voxels of --grid-like; None where the recipe says which."""
    return read_volume(asked.grid_like).grid if asked.grid_like else None


# ---- bone

SOURCES = ("bone_from_sweep", "bone_frames", "bone_model", "bone_image")
"""Options by which the frames themselves say where bone is."""


def seen_source(asked: _BoneOptions) -> str | None:
    """The option, as users write it, that lets the frames say where bone is; None where there is none."""
    return next((as_option(name) for name in SOURCES if getattr(asked, name, None)), None)


def check_bone_options(asked: _BoneOptions) -> None:
    """Return if the options that say where bone is go together.

    Raises SettingsError otherwise.
    """
    source = seen_source(asked)
    if asked.bone_frames_px and not asked.bone_frames:
        raise SettingsError("--bone-frames-px says what predictions cover, and there are none. Give --bone-frames.")
    if source and asked.bone_transform:
        raise SettingsError(f"--bone-transform places a CT, and {source} needs none. Leave out one of them.")
    if source and asked.speed_of_sound is not None:
        raise SettingsError(f"{source} takes depths as the images show them. Leave out --speed-of-sound, or give --bone-labels.")
    if asked.bone_transform and not (names_labels(asked) or asked.bone_probability):
        raise SettingsError("--bone-transform places a bone input, and there is none. Give --bone-labels, --ct or --bone-probability.")


def bone_inputs(asked: _BoneOptions) -> list[Path | None]:
    """The files that say where bone is, the description of a model among them."""
    model = [] if asked.bone_model is None else [asked.bone_model, asked.bone_model.with_suffix(".json")]
    given = [*labels_inputs(asked), asked.bone_probability, asked.bone_transform, *asked.bone_frames]
    return [*given, *(path for path in model if path.is_file())]


def bone_source_from(asked: _BoneOptions, progress: Progress | None = None, labels: Labels | None = None) -> BoneSource:
    """What the options name as bone, read; `labels` are theirs where they were read already.

    Raises SettingsError when options do not go together.
    """
    check_bone_options(asked)
    labels = labels_from(asked, progress) if labels is None else labels
    probability = read_volume(asked.bone_probability) if asked.bone_probability else None
    predictions = [read_sequence(path) for path in asked.bone_frames]
    return BoneSource(labels, probability, place_from(asked), predictions or None, asked.bone_model)
