"""Fuzzing: recordings, the texts that belong to them, and a stream of messages are damaged on purpose; only a clear refusal may come out.

`targets` says what is read and what every input must come to, `damage` how good inputs are damaged, `__main__` shares out the time.
Compiled readers of foreign images and volumes are left to the guard of the command line (decision 0037).
"""
