"""Images and transforms that come separately become frames with a pose.

May import live/wire/ and sweep/.
"""
