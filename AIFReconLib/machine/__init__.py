"""What the computer has and how it is used: memory, threads, reading ahead, compiling.

May import errors, messages, progress and settings only.
"""
