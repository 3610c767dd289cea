"""Which straight lines look free that bone blocks? Fixed and planned scans, a registered CT, a wrong one and none.

    python Testing/study paths --output study-output/paths

writes paths.md and free-paths.png. Some four minutes per patient and core; an interrupted study goes on where it stopped. Needs
shared/data/lumbar-shape.
"""

from __future__ import annotations

from .command import Study
from .paths_cases import Row, patient_rows
from .paths_figure import paths_figure
from .paths_page import paths_page

STUDY = Study(patient_rows, Row, "volumes", lambda rows: {"paths": paths_page(rows)}, pictures={"free-paths.png": paths_figure})
