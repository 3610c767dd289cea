"""Judging a sweep and its reconstruction in words: diagnosis, tracking report, time offset, summary.

May import compounding/ and below; prints nothing.
"""
