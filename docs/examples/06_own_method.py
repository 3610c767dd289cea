"""
A method of your own
====================

A method says what each pixel of a frame counts. That is one function; it then runs wherever the built-in ones do.
"""

# %%
# The function
# ------------
# Its arguments say by their names which arrays it wants. This one counts a pixel the more, the more squarely a beam
# meets bone there.

from pathlib import Path

from AIFReconLib import (
    BoneMap,
    Recipe,
    read_labels,
    read_sequence,
    read_transform,
    reconstruct,
    register_method,
)
from AIFReconLib.workflows.simulate import write_simulated_patient


@register_method
def squarely_seen(intensity, cosine, probability, reach, floor=0.02):
    """Bone counts the more, the more squarely a beam meets it; what lies in shadow counts little."""
    weight = reach * (floor + probability * cosine**2)
    return weight, intensity


# %%
# A patient
# ---------

patient = Path("patient")
if not (patient / "sweep.igs.mha").exists():
    write_simulated_patient(patient, frames=45)

sequence = read_sequence(patient / "sweep.igs.mha", config=patient / "PlusDeviceSet.xml")
labels = read_labels(patient / "lumbar-segmentation.nrrd").placed_by(read_transform(patient / "CTToReference.tfm"))
bone = BoneMap.from_labels(labels, sigma_mm=4.0)

# %%
# Beside a built-in one
# ---------------------

result = reconstruct(sequence, Recipe(method=squarely_seen.name, spacing=1.0), bone)
picture = result.intensity.plot(mask=result.mask, labels=labels, title=squarely_seen.name)
picture

# %%

built_in = reconstruct(sequence, Recipe(method="aif", spacing=1.0), bone)
picture = built_in.intensity.plot(mask=built_in.mask, labels=labels, title="aif")
picture
