"""The jobs that people ask for, each told once: every door (command line, panel, batch, Python) calls it.

A door translates what its user gave and shows what comes back. May import all rooms below; only doors import
this one.
"""
