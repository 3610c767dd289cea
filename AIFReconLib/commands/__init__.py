"""The command line: `parser`, and one file a command, in which `add_to` declares the arguments and `run` does the work.

May import everything; nothing imports it. What commands share is in `terminal`.
"""
