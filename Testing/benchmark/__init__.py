"""Measures speed for those who change the code: `make bench`, or ``python Testing/benchmark``; a live session with ``live``."""
