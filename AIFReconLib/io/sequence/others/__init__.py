"""Recordings that other programs wrote, a file for each kind: what it opens, and the frames that it makes of it.

Part of the room io/sequence; optional packages are imported when first needed.
"""
