"""Whether a calibration can be trusted, and a better one, from the bone that a sweep itself shows of a CT; or one from an N-wire phantom.

May import registration/, bone/, resolve, imaging/, sweep/ and geometry/.
"""
