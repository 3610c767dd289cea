"""The part of the panel about the picture: what the views show of a reconstruction, and the report of it.

May import the files beside this room.
"""
