"""Live reconstruction for a simulated hour from a server that fails at random: every frame accounted for, nothing that grows.

`stream` is the scan, `faults` are done to it over a `line`, by the `server` in a process of its own, which keeps a `ledger`. `client` is
the side under test. `accounts` compares the two, `growth` looks at memory, threads and files. `scene` does it with the module's nodes.
"""

import sys
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
for folder in (REPOSITORY, REPOSITORY / "Testing"):
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))
