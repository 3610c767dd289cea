"""`aifrecon coverage`: which bone a sweep has met, and how squarely."""

from __future__ import annotations

from typing import Annotated, ClassVar

from ..effective_settings import takes_out_motion
from ..errors import SettingsError
from ..evaluation.visibility import BEAM_THICKNESS
from ..guidance.coverage import coverage
from ..guidance.mesh import ColoredBone, bone_mesh, met_on_mesh
from ..io.volume.surfaces import write_surface
from ..progress import part
from ..registration.labeled_bone import LabeledBone
from ..terminal.arguments import Names, Options, Output, Settings, Spellings, positive
from ..terminal.console import ProgressBar
from ..terminal.labels_options import labels_from, place_from
from ..terminal.outputs import tell, write_json
from ..terminal.sequence_options import SequencesOptions, sequences_from
from ..workflows.reconstruct import mended


class _CoverageOptions(SequencesOptions):
    """Tell from poses, images and a registered CT's segmentation how much of each bone the beams hit, at which angles, and what a
    reconstruction will show of it. Without a CT: of the surface that echoes show, and of where it may go on.

    Parameters
    ----------
    surface : FILE.vtp
        also write the bone's surface, with best cosine and frames at its points
    report : FILE.json
        also write the table as JSON
    beam_thickness : MM
        width of the beams across the image plane

    Examples
    --------
      aifrecon coverage sweep.igs.mha --config PlusDeviceSet.xml --bone-labels lumbar.nrrd --bone-transform CTToReference.tfm
      aifrecon coverage sweep.igs.mha --config PlusDeviceSet.xml

    Shares are of the bone that a probe on the back can reach at all. 'aifrecon plan' says which passes would show more.
    """

    surface: Output | None = None
    report: Output | None = None
    beam_thickness: Annotated[float, positive] = BEAM_THICKNESS

    SETTINGS: ClassVar[Settings] = ("motion",)
    SPELLED: ClassVar[Spellings] = {**Options.SPELLED, "report": ("-o", "--output", "--report")}
    FIRST: ClassVar[Names] = ("bone_labels", "ct", "bone_transform", "config", "surface", "report", "quiet")


def run(asked: _CoverageOptions) -> None:
    """Read, follow the beams, say what was met."""
    with ProgressBar() as progress:
        labels, placed = labels_from(asked, part(progress, 0.0, 0.05)), place_from(asked)
        if labels is None and placed is not None:
            raise SettingsError("A transform places the CT's bone, and there is none. Give --bone-labels or --ct, or no --bone-transform.")
        sequences = sequences_from(asked, asked.sequences)
        recipe = asked.recipe
        bone = None if labels is None else LabeledBone(labels, placed, sequences, recipe)
        labels = None if bone is None else bone.labels
        if takes_out_motion(recipe):
            sequences = [mended(sequences, bone, recipe)]
        found = coverage(
            sequences,
            labels,
            placed,
            recipe=recipe,
            thickness=asked.beam_thickness,
            progress=part(progress, 0.05, 0.95),
        )
        if asked.surface:
            met = found.met.bone
            mesh = bone_mesh(met.distance) if met.is_of_ct else ColoredBone.of(met).mesh
            write_surface(asked.surface, mesh.points_reference, mesh.triangles, **met_on_mesh(mesh, found.met))
        write_json(asked.report, found.to_dict())
    notes = labels.notes if labels is not None else ()
    tell("\n".join(found.lines()), [*notes, *found.notes], [asked.surface, asked.report])
