"""A scan from its first frame to its volume: scouting, insertion, recording, snapshots, statistics.

May import live/pairing/, live/wire/ and the library below live/.
"""
