"""
A first reconstruction
======================

From a recorded sweep, its calibration and a registered CT to a volume, by plain averaging and by weighting every beam
by its angle to bone.
"""

# %%
# A patient, as files
# -------------------
# A sweep as Plus records it, its configuration with the calibration, the CT's segmentation, and its registration as
# Slicer saves it. Put the names of
# your own files here; ``aifrecon simulate --output patient --frames 45`` makes the same ones.

from pathlib import Path

from AIFReconLib import BoneMap, Recipe, read_labels, read_sequence, read_transform, reconstruct
from AIFReconLib.workflows.simulate import write_simulated_patient

patient = Path("patient")
if not (patient / "sweep.igs.mha").exists():
    write_simulated_patient(patient, frames=45)

sequence = read_sequence(patient / "sweep.igs.mha", config=patient / "PlusDeviceSet.xml")
labels = read_labels(patient / "lumbar-segmentation.nrrd").placed_by(read_transform(patient / "CTToReference.tfm"))
print(sequence)

# %%
# One frame of the sweep
# ----------------------

import matplotlib.pyplot as plt

plt.figure(figsize=(6, 5))
plt.imshow(sequence.images[22], cmap="gray")
plt.axis("off")
plt.show()

# %%
# The mean of all pixels
# ----------------------
# Bone that beams met aslant is dim in most frames, and the mean blurs it away. Blue was not scanned; orange is the
# outline of bone in the CT.

settings = Recipe(method="average", spacing=1.0)
average = reconstruct(sequence, settings)
picture = average.intensity.plot(mask=average.mask, labels=labels)
picture

# %%
# The same, weighted by the angle to bone
# ---------------------------------------
# The bone map says where the CT expects bone and which way it faces; ``weighted`` believes it where the image agrees.

bone = BoneMap.from_labels(labels, sigma_mm=4.0)
weighted = reconstruct(sequence, Recipe(method="weighted", spacing=1.0), bone)
picture = weighted.intensity.plot(mask=weighted.mask, labels=labels)
picture

# %%
# In numbers
# ----------
# How far bone stands out from tissue (CNR), and how much of the bone that its beams met is seen.

from AIFReconLib import evaluate

for name, result in {"average": average, "weighted": weighted}.items():
    measured = evaluate(result.intensity, labels, sweep=sequence).to_dict()
    print(f"{name:9} CNR {measured['bone_cnr']:.2f}, coverage {measured['bone_coverage']:.0%}")

# %%
# Keep it
# -------
# It opens in Slicer where it belongs, over the CT. The header says how it was made.

weighted.intensity.write(patient / "volume.nrrd")
