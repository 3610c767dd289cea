"""Where a volume comes from: the settings that repeat it, in its header and in files of their own.

May import compounding/, resolve, io/ and what stands below them.
"""
