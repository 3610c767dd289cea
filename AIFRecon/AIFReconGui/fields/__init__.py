"""Widgets of the panel that keep a choice and a parameter alike where Slicer has no connector for them: lists, files, the bone's source.

May import AIFReconScene and its neighbors beside this folder.
"""
