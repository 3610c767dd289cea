"""Recordings as Plus and Slicer save them, read frame by frame and written.

May import the rooms of io/ but foreign/.
"""
