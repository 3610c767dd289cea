"""OpenIGTLink on the wire: connection, framing, codec, and the messages that come of it.

The lowest room of live/: it knows no frames.
"""
