"""`aifrecon bone-map`: the probability map alone."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

from ..compounding.methods.aif import AIF
from ..compounding.methods.table import DEFAULT_METHOD_WITH_BONE
from ..errors import SettingsError
from ..io.volume.files import check_volume_path
from ..progress import part
from ..recipe.recipe import AUTOMATIC
from ..registration.labeled_bone import LabeledBone
from ..terminal.arguments import Names, Output, Rivals, Settings
from ..terminal.console import ProgressBar
from ..terminal.labels_options import LabelsOptions, required_labels
from ..terminal.outputs import tell


class _BoneMapOptions(LabelsOptions):
    """Make a bone probability map, to look at or to reuse with --bone-probability. Without a width it is that of weighted where CT and
    sweep were not compared; with one, that of the paper's methods.

    Parameters
    ----------
    given : LABELS
        segmentation of the CT: a volume, a model, or a folder of masks
    output : VOLUME
        where to write (.nrrd, .mha, .mhd, .nii, .nii.gz)
    """

    given: Path | None = None
    output: Output

    WORDS: ClassVar[Names] = ("given",)
    SETTINGS: ClassVar[Settings] = ("bone_sigma_voxels", "bone_sigma_mm")
    RIVALS: ClassVar[Rivals] = (("bone_sigma_voxels", "bone_sigma_mm"),)


def run(asked: _BoneMapOptions) -> None:
    """Read, smooth, write."""
    if asked.given is not None:
        asked.bone_labels = [asked.given, *asked.bone_labels]
    check_volume_path(asked.output)
    if asked.bone_sigma_mm == AUTOMATIC:
        raise SettingsError("--bone-sigma-mm auto compares the CT with a sweep, and there is none. Give a number.")
    with ProgressBar() as progress:
        labels = required_labels(asked, part(progress, 0.0, 0.3))
        # The paper's map where its width is given, else that of the default method
        method = DEFAULT_METHOD_WITH_BONE if asked.bone_sigma_voxels is None and asked.bone_sigma_mm is None else AIF.name
        bone = LabeledBone(labels, recipe=asked.recipe).map(method, part(progress, 0.3, 1.0))
        bone.probability.write(asked.output)
    size = " x ".join(str(n) for n in bone.probability.grid.size)
    made = ", ".join(f"{name.removeprefix('bone_').replace('_', ' ')} {value:g}" for name, value in bone.made.items())
    tell(f"bone probability on {size} voxels around the labels, 0 elsewhere", [made, *labels.notes], [asked.output])
