"""Live reconstruction for a simulated hour from a server that fails at random: every frame accounted for, nothing that grows.

The `server`, in a process of its own, streams a scan whose images tell their number, and fails. `client` is the side under test and
compares what the two know.
"""

import sys
from pathlib import Path

TESTING = Path(__file__).resolve().parents[1]
for folder in (TESTING.parent, TESTING, TESTING / "Python"):
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))
