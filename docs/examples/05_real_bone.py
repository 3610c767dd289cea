"""
Real bone
=========

A cadaver's fibula, swept by a tracked linear probe from several angles, with its surface from CT. Ultrasound and CT
are the example record of UltraBones100k, published under CC BY 4.0; they are not part of this project. Where
``AIFRECON_DATA_DIR`` names no folder with ``fibula/``, this page was built without them and shows no pictures.
"""

# sphinx_gallery_thumbnail_path = 'docs/images/real-bone-cuts.png'

# %%
# The recording
# -------------
# Every eighth of its 568 frames.

import os
from pathlib import Path

from AIFReconLib import BoneMap, Recipe, read_labels, read_sequence, reconstruct
from AIFReconLib.sweep.edits import select_frames

folder = Path(os.environ.get("AIFRECON_DATA_DIR") or "../../../shared/data") / "fibula"
is_there = folder.is_dir()
if is_there:
    whole = read_sequence(folder / "fibula-distal.igs.mha")
    sequence = select_frames(whole, every=8)
    labels = read_labels(folder / "fibula-labels.nrrd")
    print(sequence)
else:
    print("Skipped: the recording is not here.")

# %%
# The mean, and every beam weighted by its angle to bone
# ------------------------------------------------------

if is_there:
    average = reconstruct(sequence, Recipe(method="average", spacing=0.6, probe="linear"))
    picture = average.intensity.plot(mask=average.mask, labels=labels, title="average")

# %%

if is_there:
    bone = BoneMap.from_labels(labels, sigma_mm=2.0)
    weighted = reconstruct(sequence, Recipe(method="weighted", spacing=0.6, probe="linear"), bone)
    picture = weighted.intensity.plot(mask=weighted.mask, labels=labels, title="weighted")
