"""What a method needs to be told: where bone is, how the beams run, what a frame itself shows of bone."""

from __future__ import annotations

from ..errors import SettingsError
from ..recipe.recipe import Recipe
from .methods.table import method_named


def needs_bone(name: str, settings: Recipe) -> bool:
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
        raise SettingsError(f"{wish} needs to know where bone is. Give labels or a bone probability, or choose method average.")
    return uses_bone
