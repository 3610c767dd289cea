"""The parts of the panel that are more than a widget of the .ui file: both tabs, lights, report, guidance, the picture.

May import fields/ and the files beside this room.
"""
