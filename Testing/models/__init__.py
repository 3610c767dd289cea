"""A small network that tells bone in a frame: what it learns from, how it is trained, and what it is worth."""
