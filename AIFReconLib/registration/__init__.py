"""Where a CT belongs on a sweep, from the bone that the sweep itself shows: checked, refined, found, and one motion per vertebra.

May import resolve, bone/, imaging/, sweep/ and geometry/.
"""
