"""kill -9 of what writes, and what becomes of the files: `make faults`. docs/reliability.md has the results.

`children` starts, kills and watches processes, `samples` are the files and commands, `kills` are the faults, `ledger` counts what came of
them, and `__main__` runs them all for a given time.
"""
