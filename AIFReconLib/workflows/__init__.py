"""The jobs that people ask for: each is told here once, and every door (command line, panel, batch, Python) calls it.

A door translates what its user gave and shows what comes back. May import all rooms below; only doors import this one.
"""
