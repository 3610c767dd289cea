"""What does each method make of real bone? A cadaver's fibula swept from several angles, its CT in place and misplaced.

    python Testing/study real_bone --output real-bone-output

writes tables and three pictures; an interrupted run goes on where it stopped. Half an hour on one core.
"""

from __future__ import annotations

from pathlib import Path

from measured import keep

from AIFReconLib.evaluation.figures import require_matplotlib
from AIFReconLib.terminal.console import ProgressBar

from .command import kept_in, reported, study_parser
from .paths_page import table_of
from .real_bone_angles import angle_rows, angle_tables, shadow_rows, traced_echoes
from .real_bone_cases import RealBone, real_bone_rows
from .real_bone_figures import angle_figure, real_bone_figures
from .real_bone_page import in_the_pages
from .real_bone_paths import path_rows


def main(words: list[str]) -> int:
    """Run what is missing, then write the page and the pictures; the answer is the exit status."""
    arguments = study_parser("real_bone", __doc__).parse_args(words)
    output: Path = arguments.output

    def work_through() -> list[str]:
        require_matplotlib()
        bone = RealBone.found()
        output.mkdir(parents=True, exist_ok=True)
        with ProgressBar() as progress:
            rows = real_bone_rows(bone, output, arguments.jobs, progress)
            echoes = traced_echoes(bone.sequence, bone.truth, every=4)
            angles, shadows = angle_rows(echoes), shadow_rows(echoes)
            texts = {**in_the_pages(rows), "real-bone-paths": table_of(path_rows(bone, output, arguments.jobs, progress))}
            written = kept_in(output, {**texts, "real-bone-by-angle": angle_tables(angles, shadows)})
            written += [*real_bone_figures(output, bone, rows), angle_figure(output, angles, shadows)]
            written += keep(texts, "make real-bone") if arguments.pages else []
        return [f"{len(rows)} reconstructions of a real bone", *map(str, written)]

    return reported(work_through)
