"""A recording in memory: frames with their transforms and times, where each frame lies, what is configured, edits.

May import imaging/, holes/ and below; knows nothing of files.
"""
