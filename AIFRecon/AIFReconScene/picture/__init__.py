"""What a reader makes of a reconstruction: measured or enhanced, bone in 3D, the probe's side up, names of levels, and the page about it.

May import display/, registration/ and below.
"""
