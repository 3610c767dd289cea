"""Live reconstruction for a simulated hour from a server that fails at random: every frame accounted for, nothing that grows.

`stream` is the scan, which the `server`, in a process of its own, sends over a `line` and fails. `client` is the side under test and
compares what the two know. `hostile` are peers that mean no good.
"""

import sys
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
for folder in (REPOSITORY, REPOSITORY / "Testing"):
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))
