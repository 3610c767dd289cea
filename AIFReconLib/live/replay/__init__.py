"""A server that sends a recording as Plus would.

May import live/wire/, io/ and sweep/; the session does not know it.
"""
