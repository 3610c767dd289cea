"""`--settings` and `--save-settings`: a reconstruction that is repeated, with what was chosen for it by itself."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

from .. import __version__
from ..compounding.state import Reconstruction
from ..geometry.transform_graph import capital
from ..imaging.beams import LINEAR
from ..provenance.record import other_inputs, settings_of, signed
from ..provenance.settings_files import check_settings_path, read_settings, write_settings
from ..provenance.settings_schema import KeptSettings
from ..sweep.poses import ends_of
from .one_line_parser import OneLineParser


def add_settings_options(parser: argparse.ArgumentParser, without: tuple[str, ...] = ()) -> None:
    """Declare both; settings in `without` are not taken from a file."""
    group = parser.add_argument_group("settings", "repeat a reconstruction, on the same voxels")
    group.add_argument(
        "--settings",
        type=Path,
        metavar="FILE",
        help="take settings from this volume that aifrecon wrote (.nrrd, .mha, .mhd), or from this file (.json, .toml); files are given "
        "as always, and options given beside it win",
    )
    group.add_argument(
        "--save-settings", type=Path, metavar="FILE", help="also write the settings, what was chosen by itself included (.json, .toml)"
    )
    parser.set_defaults(kept=None)
    if isinstance(parser, OneLineParser):
        parser.defaults_from = _defaults_without(without)


def _defaults_without(without: tuple[str, ...]) -> Callable[[argparse.Namespace], Mapping[str, object]]:
    """What makes defaults of the file that the given options name."""

    def defaults(given: argparse.Namespace) -> Mapping[str, object]:
        if given.settings is None:
            return {}
        kept = read_settings(given.settings)
        options = {name: value for name, value in kept.options.items() if name not in without}
        if given.image_to_reference and given.reference is None:
            # What is given names both ends
            _drop(options, "reference")
        if given.spacing or given.grid_like or _is_in_another_frame(given, kept.options):
            _drop(options, "grid_size", "grid_to_reference")
        if given.bone_sigma_voxels is not None:
            _drop(options, "bone_sigma_mm")
        if given.bone_labels or given.bone_probability or given.bone_frames or given.bone_model:
            _drop(options, "bone_from_sweep")
        if given.probe == LINEAR:
            _drop(options, "apex_px")
        if given.apex_px:
            _drop(options, "probe")
        if given.fan_angles_deg or given.fan_radius_px:
            _drop(options, "fan_pixel_size", "fan_detection", *(["fan_apex_px"] if given.apex_px else []))
        return {**options, "kept": kept}

    return defaults


def _drop(options: dict[str, object], *names: str) -> None:
    for name in names:
        options.pop(name, None)


def _is_in_another_frame(given: argparse.Namespace, kept: Mapping[str, object]) -> bool:
    """Whether the options ask for a frame of reference that the kept box need not be in."""
    asked = _target(given.reference, given.image_to_reference)
    return asked is not None and asked != _target(kept.get("reference"), kept.get("image_to_reference"))


def _target(reference: object, image_to_reference: object) -> str | None:
    """The frame that both options together name, if they do."""
    if reference:
        return capital(str(reference))
    return ends_of(str(image_to_reference)).target if image_to_reference else None


def check_save_settings(arguments: argparse.Namespace) -> None:
    """Return if --save-settings can be obeyed, as far as can be told before a long computation."""
    if arguments.save_settings is not None:
        check_settings_path(arguments.save_settings)


def with_provenance(
    result: Reconstruction,
    arguments: argparse.Namespace,
    inputs: list[Path | None],
    stream: Mapping[str, object] | None = None,
) -> Reconstruction:
    """The result with volumes that know all settings and inputs; notes say what differs from the volume that was to be repeated.

    Parameters
    ----------
    result : Reconstruction
        As `reconstruct` returns it.
    arguments : Namespace
    inputs : list of Path or None
        Files that were read.
    stream : mapping or None
        See `signed`.
    """
    files = [path for path in inputs if path is not None]
    kept: KeptSettings | None = arguments.kept
    notes = () if kept is None else (*_about_version(kept), *other_inputs(kept.path.name, kept.inputs, files))
    return replace(signed(result, settings_of(result.intensity), files, stream), said=(*result.said, *notes))


def _about_version(kept: KeptSettings) -> list[str]:
    if kept.version in ("", __version__):
        return []
    return [
        f"The settings are of version {kept.version}, and this is {__version__}: voxels may differ.",
    ]


def save_settings(result: Reconstruction, arguments: argparse.Namespace) -> list[Path]:
    """Write what --save-settings asks for; the answer names the file, where one was written."""
    if arguments.save_settings is None:
        return []
    write_settings(settings_of(result.intensity), arguments.save_settings)
    return [arguments.save_settings]
