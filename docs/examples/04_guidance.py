"""
Guidance
========

Which bone a sweep has met, how squarely, and where to look next.
"""

# %%
# A sweep that is not finished
# ----------------------------
# The first third of the frames of a simulated scan.

from pathlib import Path

from AIFReconLib import read_labels, read_sequence, read_transform
from AIFReconLib.guidance.coverage import coverage
from AIFReconLib.sweep.edits import select_frames
from AIFReconLib.workflows.simulate import write_simulated_patient

patient = Path("patient")
if not (patient / "sweep.igs.mha").exists():
    write_simulated_patient(patient, frames=45)

whole = read_sequence(patient / "sweep.igs.mha", config=patient / "PlusDeviceSet.xml")
sequence = select_frames(whole, last=14)
labels = read_labels(patient / "lumbar-segmentation.nrrd")
ct_to_reference = read_transform(patient / "CTToReference.tfm")

# %%
# What it met
# -----------
# Shares of the bone that a probe on the back can reach at all.

met = coverage(sequence, labels, ct_to_reference)
print("\n".join(met.lines()))

# %%
# Bone seen from behind, by the best angle at which a beam met it: the squarer, the brighter.

import matplotlib.pyplot as plt
import numpy as np

bone = met.met.bone
points = bone.surface.points_reference
angle = np.degrees(np.arccos(np.clip(np.nan_to_num(met.met.best_cosine, nan=-1.0), -1.0, 1.0)))
seen = angle < 90

plt.figure(figsize=(6, 6))
plt.scatter(*points[~seen][:, [0, 2]].T, s=4, color="lightgray", linewidths=0, label="not met")
shown = plt.scatter(*points[seen][:, [0, 2]].T, s=4, c=angle[seen], cmap="viridis_r", vmin=0, vmax=80, linewidths=0)
plt.colorbar(shown, label="best angle of incidence, degrees")
plt.gca().set(xlabel="x, mm", ylabel="z, mm", aspect="equal")
plt.legend(loc="lower right")
plt.show()

# %%
# Where to look next
# ------------------
# The pass that adds most for its labor, told from where the probe is now.

from AIFReconLib.guidance.next_move import NextMove
from AIFReconLib.guidance.probe import ProbeImages, ProbeOnBack, Skin
from AIFReconLib.sweep.poses import sweep_poses

probe = ProbeOnBack(ProbeImages.simulated(), Skin.over(bone), bone.patient_to_reference)
poses = sweep_poses(sequence).image_to_reference
move = NextMove(bone, probe).advise(met.met, poses[-1])
print(move.words)
