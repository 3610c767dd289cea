"""
Your own arrays
===============

Images and poses that are numpy arrays already, from whatever scanner and tracker, and a volume that is one too.
"""

# %%
# Images and poses
# ----------------
# Eighty frames of a ball in speckle: each 120 x 160 pixels of 0.3 mm, 0.5 mm apart, with a pose in mm from the image
# to the room.

import numpy as np

from AIFReconLib import Recipe, TrackedSequence, Volume, reconstruct

rng = np.random.default_rng(0)
frames, rows, columns, pixel = 80, 120, 160, 0.3
image_to_reference = np.tile(np.eye(4), (frames, 1, 1))
image_to_reference[:, 2, 3] = 0.5 * np.arange(frames)

x, y = np.meshgrid(pixel * np.arange(columns), pixel * np.arange(rows))
inside = [np.hypot(np.hypot(x - 24, y - 18), z - 20) < 12 for z in image_to_reference[:, 2, 3]]
images = (
    np.where(inside, rng.rayleigh(60, (frames, rows, columns)), rng.rayleigh(25, (frames, rows, columns))).clip(0, 255).astype(np.uint8)
)

# %%
# A volume
# --------
# ``spacing`` is the size of a pixel in mm; leave it out where the poses hold it.

sequence = TrackedSequence.from_arrays(images, image_to_reference, spacing=(pixel, pixel))
volume = reconstruct(sequence, Recipe(spacing=0.5)).intensity
picture = volume.plot(title="A ball of 24 mm")
picture

# %%
# It is an array that knows where it lies
# ---------------------------------------
# Indices are [k, j, i]; spacing and origin are (x, y, z) in mm. What is cut out stays where it was.

print(volume.shape, volume.spacing, volume.origin)
part = volume[:, 20:60, ::2]
print(part.shape, part.spacing, part.origin)
print("brightness inside", np.mean(np.asarray(volume)[30:50, 26:46, 38:58]))

# %%
# To SimpleITK and back
# ---------------------

image = volume.to_sitk()
print(image.GetSize(), Volume.from_sitk(image).shape)
