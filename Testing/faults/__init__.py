"""Faults made on purpose, and what becomes of the files: `make faults`. docs/reliability.md has the results."""
