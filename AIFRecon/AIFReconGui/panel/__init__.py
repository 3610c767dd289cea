"""The parts of the panel that are more than a widget of the .ui file: choosers, fields, the report, the Live section.

May import the files beside this room.
"""
