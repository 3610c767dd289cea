"""The command line: parser, console, signals, and one file a command, in which `add_to` declares the arguments and `run` does the work.

May import everything; nothing imports it.
"""
