"""A live scan in the scene: its session, its views, an image node as a source.

May import all other rooms.
"""
