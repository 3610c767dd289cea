"""Bone from a CT that nobody has segmented: above a threshold that is found in it, without what is as bright and is none.

May import geometry/ and machine/.
"""
