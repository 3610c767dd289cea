"""
Live, from Python
=================

Frames come over OpenIGTLink while somebody scans, and the volume grows. Here a server of our own plays the scanner;
put the host and port of your Plus server in its place.
"""

# %%
# A server
# --------

from pathlib import Path

from AIFReconLib import LiveSession, OpenIGTLinkClient, Recipe, ReplayServer, SynchronizerSettings, VoxelGrid, read_sequence
from AIFReconLib.workflows.simulate import write_simulated_patient

patient = Path("patient")
if not (patient / "sweep.igs.mha").exists():
    write_simulated_patient(patient, frames=45)

sequence = read_sequence(patient / "sweep.igs.mha", config=patient / "PlusDeviceSet.xml")
server = ReplayServer(sequence, port=0, rate=20.0)
server.start()

# %%
# A session
# ---------
# It receives, pairs images with poses, and inserts, in threads of its own; ``statistics`` says what became of every
# frame. The box is one that lies around the sweep.

import numpy as np

from AIFReconLib.sweep.poses import sweep_poses

centers = sweep_poses(sequence).image_to_reference @ [*(np.array(sequence.frame_size) / 2), 0.0, 1.0]
low, high = centers[:, :3].min(axis=0) - 40.0, centers[:, :3].max(axis=0) + 40.0
grid = VoxelGrid.from_spacing(low, np.ceil(high - low).astype(int).tolist(), 1.0)

client = OpenIGTLinkClient("127.0.0.1", server.port)
trusted = SynchronizerSettings(trust_image_pose=True)
with LiveSession(client, Recipe(method="average"), grid=grid, synchronizer=trusted, frame_limit=40) as session:
    session.start()
    while not session.finished.wait(1.0):
        print(session.statistics.inserted, "frames so far")
    result = session.finish()
server.stop()
print(session.statistics.inserted, "of", session.statistics.frames_received, "frames inserted")

# %%
# What there is
# -------------

picture = result.intensity.plot(mask=result.mask)
picture
