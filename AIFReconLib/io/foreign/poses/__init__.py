"""Tables of poses as trackers, robots and programs write them: which columns they have, of which tool, in which convention.

What a file does not say is asked for, never guessed.
"""
