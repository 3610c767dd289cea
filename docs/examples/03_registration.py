"""
Registration
============

A CT that lies somewhere else finds its place on the bone that the sweep shows, and says how sure that is.
"""

# %%
# A CT 8 mm and 5 degrees off
# ---------------------------

from pathlib import Path

import numpy as np

from AIFReconLib import read_labels, read_sequence, read_transform, register
from AIFReconLib.simulation.scan import random_rigid
from AIFReconLib.workflows.simulate import write_simulated_patient

patient = Path("patient")
if not (patient / "sweep.igs.mha").exists():
    write_simulated_patient(patient, frames=45)

sequence = read_sequence(patient / "sweep.igs.mha", config=patient / "PlusDeviceSet.xml")
labels = read_labels(patient / "lumbar-segmentation.nrrd")
truth = read_transform(patient / "CTToReference.tfm")

middle = labels.placed_by(truth).grid.corners().mean(axis=0)
start = random_rigid(8.0, 5.0, np.random.default_rng(1), about=middle) @ truth

# %%
# Where it belongs
# ----------------
# An answer that is not unique, or where CT and sweep do not agree, is refused; the sentence says why.

found = register(sequence, labels, start)
print("accepted:", found.accepted, found.refusal or "")
print(f"{found.agreement.share:.0%} of the bone echoes lie on bone, median {found.agreement.median_distance:.1f} mm")
print("not held by the sweep:", [str(words) for words in found.uncertain] or "nothing")

off = np.linalg.norm((found.transform @ np.linalg.inv(truth) - np.eye(4)) @ [*middle, 1.0])
print(f"{found.moved:.1f} mm moved, now {off:.1f} mm from the truth")

# %%
# What the sweep shows, before and after
# --------------------------------------
# Echoes of bone (yellow) over the CT's bone, seen from the side, in a slab of 6 mm about the midline.

import matplotlib.pyplot as plt

figure, axes = plt.subplots(1, 2, figsize=(10, 5), sharex=True, sharey=True)
for ax, title, transform in zip(axes, ("before", "after"), (start, found.transform)):
    bone = labels.placed_by(transform)
    k, j, i = np.nonzero(bone.array)
    points = (bone.ijk_to_reference @ np.stack([i, j, k, np.ones(len(i))]))[:3].T
    for where, color, size in ((points[::7], "lightgray", 2), (found.echoes.points, "goldenrod", 3)):
        slab = where[np.abs(where[:, 0] - middle[0]) < 3.0]
        ax.scatter(slab[:, 1], slab[:, 2], s=size, color=color, linewidths=0)
    ax.set(title=title, xlabel="y, mm", ylabel="z, mm", aspect="equal")
plt.show()
