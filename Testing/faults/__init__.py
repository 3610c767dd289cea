"""Faults made on purpose, and what becomes of the files: `make faults`. docs/reliability.md has the results.

`children` starts, kills and watches processes, `samples` are the files and commands, `kills`, `changes` and `surroundings` hold the faults,
and `__main__` runs the table of all of them for a given time.
"""
