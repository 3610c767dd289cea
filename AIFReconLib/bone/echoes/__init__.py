"""Points of bone with their beams: found in frames by a rule, gathered over a sweep, and laid together to a surface."""
