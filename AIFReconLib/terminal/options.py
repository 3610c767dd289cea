"""Arguments that several commands share, and what they mean to the library."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Sequence
from dataclasses import fields, replace
from pathlib import Path
from typing import TypeAlias

from ..arrays import Singles
from ..bone.from_sweep import bone_from_sweep
from ..bone.map import SIGMA_VOXELS, BoneMap
from ..compounding.methods.table import OWN_METHOD, is_own_method
from ..compounding.own.method import load_method
from ..errors import AIFReconError, MethodError, OutputError, SettingsError
from ..evaluation.visibility import BEAM_THICKNESS
from ..imaging.beams import LINEAR, SECTOR, ProbeGeometry
from ..imaging.detection import detect_imaging
from ..imaging.images import ImageStack
from ..imaging.region import ClipRectangle, ImageRegion, chosen_region
from ..io.metafile.opening import data_files
from ..io.plus.configuration import read_plus_configuration
from ..io.plus.importance_mask import read_importance_mask
from ..io.transform.files import read_transform
from ..io.volume.files import read_labels, read_volume
from ..progress import Progress
from ..provenance.kept import KeptSettings
from ..registration.labeled_bone import LabeledBone
from ..resolve import resolve_imaging
from ..settings import AUTOMATIC, ReconstructionSettings, rule_of
from ..sweep.configuration import PlusConfiguration
from ..sweep.frames import TrackedSequence
from ..sweep.poses import sweep_poses
from .one_line_parser import OneLineParser
from .remedies import in_options
from .seen_bone_options import add_seen_bone_options, check_seen_bone, seen_bone_from

Commands: TypeAlias = "argparse._SubParsersAction[OneLineParser]"
"""What a command adds itself to."""

PARAMETERS = {spec.name: rule_of(spec.metadata) for spec in fields(ReconstructionSettings)}


class OwnChoices(tuple[str, ...]):
    """The choices of a setting to which the names of methods of one's own belong."""

    def __contains__(self, name: object) -> bool:
        return super().__contains__(name) or (isinstance(name, str) and is_own_method(name))


class MethodAction(argparse.Action):
    """Takes the name of a method. One of the user's own is imported: the module that was named here, and no other."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: str | Sequence[object] | None,
        option_string: str | None = None,
    ) -> None:
        """Take the name."""
        name = str(values)
        try:
            if is_own_method(name):
                load_method_here(name)
        except MethodError as error:
            parser.error(f"argument {option_string}: {in_options(error).rstrip('.')}")
        setattr(namespace, self.dest, name)


def load_method_here(name: str) -> None:
    """Import the module of a method of one's own, from the folder that the program is called in too.

    Raises
    ------
    MethodError
        When it cannot be had.
    """
    # As `python -m` has it: the installed program knows the packages alone
    if not {"", os.getcwd()} & set(sys.path):
        sys.path.append(os.getcwd())
    load_method(name)


def add_setting(group: argparse._ActionsContainer, name: str, flag: str | None = None, metavar: str | None = None) -> None:
    """Declare the option of one reconstruction parameter from its entry in `settings`."""
    rule = PARAMETERS[name]
    spec = next(spec for spec in fields(ReconstructionSettings) if spec.name == name)
    default = spec.default
    number: Callable[[str], float | str] = int if rule["whole"] else float
    unit = f" [{rule['unit']}]" if rule["unit"] else ""
    shown = "" if default is None else f" (default: {default:g})" if isinstance(default, int | float) else f" (default: {default})"
    if rule["word"] is not None:
        number = _number_or(rule["word"])
    option, words = flag or "--" + name.replace("_", "-"), rule["help"] + unit + shown
    if rule["choices"] and rule["own"]:
        group.add_argument(option, dest=name, help=words, choices=OwnChoices([*rule["choices"], OWN_METHOD]), action=MethodAction)
    elif rule["choices"]:
        group.add_argument(option, dest=name, help=words, choices=rule["choices"])
    else:
        group.add_argument(option, dest=name, help=words, type=number, metavar=metavar or "N")


def _number_or(word: str) -> Callable[[str], float | str]:
    """What reads a number or this word from the command line."""

    def read(text: str) -> float | str:
        try:
            return word if text == word else float(text)
        except ValueError:
            raise argparse.ArgumentTypeError(f"must be {word} or a number such as 0.5, without a unit; got {text!r}") from None

    return read


def settings_from(arguments: argparse.Namespace) -> ReconstructionSettings:
    """The settings that the given options ask for; options that were not given keep their defaults."""
    given = {name: value for name in PARAMETERS if (value := getattr(arguments, name, None)) is not None}
    return replace(ReconstructionSettings(), **given)


def add_bone_options(parser: argparse.ArgumentParser) -> None:
    """Where bone is: labels or a probability, and its registration."""
    bone = parser.add_argument_group(
        "bone", "a registered CT's segmentation, or a bone probability; methods that weight by incidence need one"
    )
    source = bone.add_mutually_exclusive_group()
    source.add_argument("--bone-labels", type=Path, metavar="VOLUME", help="segmentation of the CT; any label above 0 is bone")
    source.add_argument("--bone-probability", type=Path, metavar="VOLUME", help="ready bone probability, 0 to 1")
    source.add_argument(
        "--bone-from-sweep", action="store_true", help="no CT: take for bone what is bright with darkness behind it in the sweep itself"
    )
    add_seen_bone_options(source, bone)
    add_sigma_options(bone)
    bone.add_argument(
        "--bone-transform",
        type=Path,
        metavar="FILE",
        help="transform CT -> Reference as Slicer saves it (.tfm, .txt, .h5); default: none needed",
    )
    bone.add_argument(
        "--bone-belief",
        type=float,
        metavar="N",
        help="how far labels are believed, above 0 to 1 (default: 1; less where --bone-sigma-mm auto chooses a wide map)",
    )
    add_setting(bone, "bone_direction")


def add_sigma_options(group: argparse._ActionsContainer, automatic: bool = True) -> None:
    """Smoothing of the bone map, in voxels or mm; `automatic` where there is a sweep that may tell how much."""
    sigma = group.add_mutually_exclusive_group()
    default = f"default: {SIGMA_VOXELS:g}" + (", but for weighted" if automatic else "")
    sigma.add_argument(
        "--bone-sigma-voxels", type=float, metavar="N", help=f"smoothing of the bone map, in voxels of the labels ({default})"
    )
    if automatic:
        words = f"the same in mm, or {AUTOMATIC}: by how well CT and sweep agree (default of weighted: {AUTOMATIC})"
        sigma.add_argument("--bone-sigma-mm", type=_number_or(AUTOMATIC), metavar="MM", help=words)
    else:
        sigma.add_argument("--bone-sigma-mm", type=float, metavar="MM", help="the same in mm")


def check_bone_options(arguments: argparse.Namespace) -> None:
    """Return if the options that say where bone is go together.

    Raises
    ------
    SettingsError
    """
    check_seen_bone(arguments)
    if arguments.bone_transform and not (arguments.bone_labels or arguments.bone_probability):
        raise SettingsError("--bone-transform places a bone input, and there is none. Give --bone-labels or --bone-probability.")


def labeled_bone_from(
    arguments: argparse.Namespace,
    sequence: TrackedSequence | None,
    region: ImageRegion | None = None,
    probe: ProbeGeometry | None = None,
) -> LabeledBone | None:
    """The labels that the options name, placed in Reference; None where they name none. `region` and `probe` are those of `imaging_from`;
    a live scan has no sequence yet."""
    check_bone_options(arguments)
    if not arguments.bone_labels:
        return None
    return LabeledBone(
        read_labels(arguments.bone_labels),
        read_transform(arguments.bone_transform) if arguments.bone_transform else None,
        sequence,
        sigma_voxels=arguments.bone_sigma_voxels,
        sigma_mm=arguments.bone_sigma_mm,
        belief=arguments.bone_belief,
        region=region,
        probe=probe,
        image_to_reference=arguments.image_to_reference,
        reference=arguments.reference,
    )


def bone_from(
    arguments: argparse.Namespace,
    method: str,
    labeled: LabeledBone | None,
    sequence: TrackedSequence | None,
    region: ImageRegion | None = None,
    probe: ProbeGeometry | None = None,
    progress: Progress | None = None,
) -> BoneMap | None:
    """The bone map that a method gets of the labels of `labeled_bone_from`, or of what else the options name; None where they name none.

    `sequence`, `region` and `probe` (as `imaging_from` returns them) are looked at for --bone-from-sweep alone; a live scan has none yet.
    """
    if labeled is not None:
        return labeled.map(method, progress)
    if arguments.bone_from_sweep:
        if sequence is None:
            raise SettingsError("--bone-from-sweep looks at a recorded sweep. Give --bone-labels or --bone-probability.")
        poses = sweep_poses(sequence, arguments.image_to_reference, arguments.reference)
        poses.require_usable(sequence.name)
        return bone_from_sweep(sequence, poses, resolve_imaging(sequence, poses, True, region, probe), progress=progress)
    if sequence is not None and (seen := seen_bone_from(arguments, sequence, region, probe, progress)) is not None:
        return seen
    if arguments.bone_probability:
        to_reference = read_transform(arguments.bone_transform) if arguments.bone_transform else None
        return BoneMap.from_probability(read_volume(arguments.bone_probability), to_reference)
    return None


def add_imaging_options(parser: argparse.ArgumentParser) -> argparse._ArgumentGroup:
    """Probe, clip rectangle and fan; the answer is the group, for more of the kind."""
    image = parser.add_argument_group("image", "what the image shows; default: the configuration's, else recognized by the black surround")
    image.add_argument("--probe", choices=("auto", LINEAR, SECTOR), default="auto", help="shape of the beams (default: auto)")
    image.add_argument("--apex-px", type=float, nargs=2, metavar=("COLUMN", "ROW"), help="virtual apex of a sector probe")
    image.add_argument(
        "--clip-px", type=float, nargs=4, metavar=("X", "Y", "W", "H"), help="use this rectangle of the image (columns X to X + W)"
    )
    image.add_argument("--fan-angles-deg", type=float, nargs=2, metavar=("A", "B"), help="use this fan about the apex, from +y toward +x")
    image.add_argument("--fan-radius-px", type=float, nargs=2, metavar=("R0", "R1"), help="between these radii about the apex")
    return image


def add_placing_options(group: argparse._ActionsContainer) -> None:
    """How a CT is laid on a sweep, and when the answer is taken."""
    group.add_argument("--per-segment", action="store_true", help="let each label move on its own: the spine has bent since the CT")
    group.add_argument("--level", type=int, metavar="N", help="write the place N levels higher (negative: lower) than the best one")
    group.add_argument("--accept", action="store_true", help="write the best place even if it is ambiguous or does not agree")


def add_beam_option(group: argparse._ActionsContainer) -> None:
    """How wide beams are where the bone that they reach is looked for."""
    group.add_argument(
        "--beam-thickness",
        type=float,
        default=BEAM_THICKNESS,
        metavar="MM",
        help="width of the beams across the image plane (default: %(default)g)",
    )


def add_importance_option(group: argparse._ActionsContainer) -> None:
    """How much each pixel counts."""
    group.add_argument(
        "--importance-mask",
        type=Path,
        metavar="IMAGE",
        help="weight of each pixel in an average: 8-bit gray image as large as the frames, 0 does not count",
    )


def importance_from(arguments: argparse.Namespace) -> Singles | None:
    """The weight of each pixel that the options give, as `read_importance_mask` returns it."""
    return read_importance_mask(arguments.importance_mask) if arguments.importance_mask else None


def imaging_from(
    arguments: argparse.Namespace, configuration: PlusConfiguration, images: ImageStack | None = None
) -> tuple[ImageRegion | None, ProbeGeometry | None]:
    """Region and probe that the options ask for; None where they leave it to the configuration or the images (None before a scan).

    Those of --settings stand in the configuration's place, and are what is meant where no option says otherwise.
    """
    kept: KeptSettings | None = getattr(arguments, "kept", None)
    if kept is not None and kept.region is not None:
        configuration = replace(configuration, region=kept.region, scan_region=None)
    if kept is not None and kept.probe is not None:
        configuration = replace(configuration, probe=kept.probe)
    apex = tuple(arguments.apex_px) if arguments.apex_px else None
    probe = _probe(arguments.probe, apex, configuration, images)
    clip = ClipRectangle(tuple(arguments.clip_px[:2]), tuple(arguments.clip_px[2:])) if arguments.clip_px else None
    known = probe or configuration.probe
    region = chosen_region(configuration.imaged_region, clip, arguments.fan_angles_deg, arguments.fan_radius_px, apex, known)
    return (region, probe) if kept is None else (region or kept.region, probe or kept.probe)


def _probe(
    kind: str, apex: tuple[float, float] | None, configuration: PlusConfiguration, images: ImageStack | None
) -> ProbeGeometry | None:
    if kind == LINEAR:
        if apex:
            raise SettingsError("A linear probe has no apex. Leave out --apex-px, or give --probe sector.")
        return ProbeGeometry(LINEAR)
    if apex:
        return ProbeGeometry(SECTOR, apex)
    if kind != SECTOR:
        return None
    known = configuration.probe
    if known is None:
        if images is None:
            raise SettingsError("A sector probe has an apex, which is not known before the scan. Give --apex-px COLUMN ROW.")
        known = detect_imaging(images).probe  # the apex in pixels does not depend on their size
    if known.kind != SECTOR:
        raise SettingsError(
            "The images or the configuration show a linear probe, not a sector. Give --apex-px COLUMN ROW to say otherwise."
        )
    return known


def refuse_to_overwrite(outputs: list[Path | None], inputs: list[Path | None]) -> None:
    """Stop before work begins when an output is an input, or two outputs are one file.

    What an input names is an input too, a header's data file and a configuration's importance mask, and so is each file of a folder.
    """
    given = [path for path in inputs if path is not None]
    seen = {as_compared(file): "an input" for path in given for file in [real_path(path), *data_files(path), *_importance_mask(path)]}
    folders = {as_compared(real_path(path)) for path in given if path.is_dir()}
    for path in outputs:
        if path is None:
            continue
        for name, file in {as_compared(file): file for file in [real_path(path), *_companions(path)]}.items():
            within = file.exists() and any(as_compared(parent) in folders for parent in file.parents)
            if name in seen or within:
                raise OutputError(
                    "{path} would overwrite {other} ({file}). Choose another name.".format(
                        path=path, other=seen.get(name, "an input"), file=file.name
                    )
                )
            seen[name] = "another output"


def _importance_mask(path: Path) -> list[Path]:
    """The mask that a Plus configuration names, without links; nothing for other files."""
    try:
        mask = read_plus_configuration(path).importance_mask if path.suffix.lower() == ".xml" else None
    except AIFReconError:
        return []
    return [real_path(mask)] if mask is not None else []


def real_path(path: Path) -> Path:
    """The path without links; one that leads in a circle stays as it is."""
    return Path(os.path.realpath(path))


def as_compared(path: Path) -> str:
    """A name as the disk compares it: on Windows and macOS Sweep.mha is sweep.mha."""
    return str(path).casefold() if sys.platform in ("win32", "darwin") else str(path)


def _companions(path: Path) -> list[Path]:
    """What is written beside `path`: a .mhd header has its voxels in a .raw or .zraw file."""
    return [real_path(path).with_suffix(suffix) for suffix in (".raw", ".zraw")] if path.suffix.lower() == ".mhd" else []
