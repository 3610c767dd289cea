"""Where a CT belongs on a sweep, from the bone that the sweep itself shows: checked, refined, found, and one motion per vertebra.

May import motion/, resolve, bone/, imaging/, sweep/ and geometry/.
"""
