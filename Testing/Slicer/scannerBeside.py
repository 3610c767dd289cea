"""What `measureInSlicer.py` needs beside the application: a scanner.

    PythonSlicer scannerBeside.py FOLDER PID

Simulates a patient into FOLDER, in images of 640 x 480; says the port and serves the sweep over OpenIGTLink, again and again, 30 frames a
second. In FOLDER it keeps `frames.json` (of each frame: its checksum and some bright points in mm of Reference) and `sent.txt` (number of
a frame, and when it was sent, in the time of `time.monotonic`), until process PID has gone.
"""

import json
import os
import pathlib
import sys
import time
import zlib

import numpy as np

SIZE, RATE, FRAMES = (480, 640), 30.0, 240
POINTS, BRIGHT = 5, 60
"""Of each frame, and their least gray value."""


def main(folder: pathlib.Path, application: int) -> None:
    """Simulate and serve until the application has gone."""
    from AIFReconLib import read_sequence, write_sequence
    from AIFReconLib.live.replay.server import ReplayServer
    from AIFReconLib.sweep.frames import TrackedSequence
    from AIFReconLib.sweep.poses import sweep_poses
    from AIFReconLib.workflows.simulate import write_simulated_patient

    files = write_simulated_patient(folder, path="single-angle", frames=FRAMES)
    sweep = read_sequence(files.sequence, config=files.configuration)
    images = np.zeros((len(sweep), *SIZE), np.uint8)
    rows, columns = sweep.images[0].shape
    images[:, :rows, :columns] = np.asarray(sweep.images)
    write_sequence(TrackedSequence(images, sweep.records), files.sequence)
    sweep = read_sequence(files.sequence, config=files.configuration)
    poses = sweep_poses(sweep).image_to_reference
    told = [{"checksum": zlib.crc32(image.tobytes()), "points": bright(image, pose)} for image, pose in zip(images, poses)]
    (folder / "frames.json").write_text(json.dumps(told), "utf-8")
    server = ReplayServer(sweep, port=0, rate=RATE, loop=True)
    messages = server.frames.messages
    with open(folder / "sent.txt", "w", encoding="utf-8", buffering=1) as sent:

        def noted(index: int, timestamp: float, version: int) -> bytes:
            made = messages(index, timestamp, version)
            sent.write(f"{index} {time.monotonic():.4f}\n")
            return made

        vars(server.frames)["messages"] = noted
        with server:
            print(server.port, flush=True)
            while os.getppid() == application:
                time.sleep(1.0)


def bright(image: np.ndarray, pose: np.ndarray) -> list:
    """Places of some bright pixels, mm."""
    rows, columns = np.nonzero(image > BRIGHT)
    chosen = np.linspace(0, len(rows) - 1, min(POINTS, len(rows))).astype(int)
    pixels = np.stack([columns[chosen], rows[chosen], 0 * chosen, 1 + 0 * chosen], axis=1)
    return (pixels @ pose.T)[:, :3].tolist()


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]), int(sys.argv[2]))
