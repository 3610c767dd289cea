"""Starts the soak test, ``python Testing/soak``."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

if __name__ == "__main__":
    from soak import client

    raise SystemExit(client.main())
