"""Straight lines from the skin to a target that meet no bone that a volume shows, how far they keep from it, and what of them was not seen.

May import evaluation/ (pictures), provenance/, compounding/, bone/ (distance to a CT's bone) and everything below them.
"""
