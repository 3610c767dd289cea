"""Echoes of bone: found in frames, gathered over a sweep, and laid together to a surface."""
