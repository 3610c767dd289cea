"""Starts the soak test, ``python Testing/soak``; with the word ``hostile`` behind it, peers that mean no good."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

if __name__ == "__main__":
    from soak import client, hostile

    raise SystemExit(hostile.main(sys.argv[2:]) if sys.argv[1:2] == ["hostile"] else client.main(sys.argv[1:]))
