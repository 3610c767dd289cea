"""Starts the soak test, ``python Testing/soak``; with a word behind it ``hostile`` peers or the module's ``scene``."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

if __name__ == "__main__":
    from soak import client, hostile, scene

    others = {"hostile": hostile.main, "scene": scene.main}
    word = sys.argv[1] if len(sys.argv) > 1 else ""
    raise SystemExit(others[word](sys.argv[2:]) if word in others else client.main(sys.argv[1:]))
