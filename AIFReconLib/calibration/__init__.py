"""Whether a calibration can be trusted, and a better one, from the bone that a sweep itself shows of a CT.

May import registration/, bone/, resolve, imaging/, sweep/ and geometry/.
"""
