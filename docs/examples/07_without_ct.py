"""
Without a CT
============

Bone found in the sweep itself, by its bright echo and the shadow behind, stands in for a registered CT.
"""

# %%
# Bone from the frames
# --------------------

from pathlib import Path

from AIFReconLib import Recipe, bone_from_sweep, read_labels, read_sequence, read_transform, reconstruct
from AIFReconLib.workflows.simulate import write_simulated_patient

patient = Path("patient")
if not (patient / "sweep.igs.mha").exists():
    write_simulated_patient(patient, frames=45)

sequence = read_sequence(patient / "sweep.igs.mha", config=patient / "PlusDeviceSet.xml")
bone = bone_from_sweep(sequence)
print(bone)

# %%
# A volume
# --------
# The outline is the true bone: this patient has a CT, of which the reconstruction knew nothing.

settings = Recipe(method="weighted", spacing=1.0)
result = reconstruct(sequence, settings, bone)
truth = read_labels(patient / "lumbar-segmentation.nrrd").placed_by(read_transform(patient / "CTToReference.tfm"))
picture = result.intensity.plot(mask=result.mask, labels=truth)
picture
