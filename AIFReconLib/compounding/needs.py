"""What a method needs to be told, and which settings concern it; settings that ask for something else than what is given are refused."""

from __future__ import annotations

import numpy as np

from ..bone.map import BoneMap
from ..errors import SettingsError
from ..geometry.volume import VoxelGrid
from ..message import listed
from ..recipe.recipe import AUTOMATIC, OF_LABELS, OF_READING, Recipe
from .methods.method import CompoundingMethod
from .methods.table import BUILT_IN, method_named


def needs_bone(name: str | CompoundingMethod, settings: Recipe) -> bool:
    """Whether a reconstruction by a method, built in or registered, reads the bone map; a MethodError where there is no such method."""
    return method_named(name).needs_bone or settings.best_cosine


def bone_on_grid(name: str, settings: Recipe, grows: bool = False) -> bool:
    """Whether the bone map is kept on every voxel: read wherever a pixel enters, not just where frames show bone, or one that `grows`."""
    return needs_bone(name, settings) and (grows or settings.best_cosine or method_named(name).reads_bone == "everywhere")


def needs_beams(name: str, settings: Recipe) -> bool:
    """Whether a reconstruction reads the beams' directions."""
    return needs_bone(name, settings) or method_named(name).needs_shadows


def require_bone(name: str, settings: Recipe, has_bone: bool) -> bool:
    """Whether a reconstruction reads the bone map; a SettingsError where it does and there is none."""
    uses_bone = needs_bone(name, settings)
    if uses_bone and not has_bone:
        wish = f"Method {name}" if method_named(name).needs_bone else "The cosine of incidence"
        raise SettingsError(
            f"{wish} needs to know where bone is.",
            ("Give {bone_labels} or {ct}, or {bone_from_sweep} for what the echoes show, or choose {method:average}."),
        )
    return uses_bone


def unused_settings(name: str, settings: Recipe, bone: BoneMap | None) -> dict[str, str]:
    """Settings that do not concern a method with this bone map, and why, by name."""
    chosen = method_named(name)
    of_some = {each: [method.name for method in BUILT_IN if each in method.uses] for method in BUILT_IN for each in method.uses}
    unused = {each: f"it is for {listed(names)}, and this is {name}" for each, names in of_some.items() if each not in chosen.uses}
    if settings.speed_of_sound is None:
        unused["scanner_speed_of_sound"] = "it matters with the true speed_of_sound alone"
    made = () if bone is None else bone.made
    if not needs_bone(name, settings):
        unused |= dict.fromkeys(("bone_from_sweep", "bone_direction", *OF_LABELS), f"{name} looks at no bone")
    else:
        unused |= {each: "the bone map was not made by it" for each in OF_LABELS if each not in made}
        if bone is not None and bone.slopes is not None:
            unused["bone_direction"] = "this bone map says itself where bone faces"
    return unused


def require_map_as_asked(settings: Recipe, bone: BoneMap | None) -> None:
    """Raise `SettingsError` where settings ask for another bone map than the one that is given."""
    made = {} if bone is None else bone.made
    reads_it = settings.method is None or bone is not None or needs_bone(settings.method, settings)
    if settings.bone_from_sweep and reads_it and "bone_from_sweep" not in made:
        if bone is not None:
            raise SettingsError("Input bone_from_sweep looks for bone in the sweep, and a bone map is given. Leave out one of them.")
        raise SettingsError("Input bone_from_sweep looks at a whole recording. Give bone=bone_from_sweep(sequence), or use reconstruct.")
    for name, value in settings.given(*OF_LABELS).items():
        if value not in (AUTOMATIC, made.get(name, value)):
            raise SettingsError(
                f"Input {name} must be that of the bone map, {made[name]}; got {value}. Leave it out, or make the map by it."
            )


def require_grid_as_asked(settings: Recipe, grid: VoxelGrid) -> None:
    """Raise `SettingsError` where settings ask for other voxels than those of the grid."""
    asked = settings.grid
    if asked is not None and not (asked.size == grid.size and np.allclose(asked.ijk_to_reference, grid.ijk_to_reference)):
        raise SettingsError("Input grid_size and grid_to_reference must be those of the grid that is given. Leave out one of them.")
    if settings.spacing is not None and not np.allclose(grid.spacing, settings.spacing_xyz(), rtol=1e-3):
        has = " x ".join(f"{mm:g}" for mm in grid.spacing)
        raise SettingsError(f"Input spacing must be that of the grid, {has} mm; got {settings.spacing}. Leave out one of them.")


def refuse_reading(settings: Recipe) -> None:
    """Raise `SettingsError` where settings say how a recording is read, for who gets frames as they are placed."""
    given = settings.given(*OF_READING)
    if given:
        raise SettingsError(
            f"Input {listed(given)} says how a recording is read, and here frames are given. Leave it out, or use reconstruct."
        )
