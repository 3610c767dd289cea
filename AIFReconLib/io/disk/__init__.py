"""Any file: written whole or not at all, read only where it is a regular file, temporary folders that clear themselves.

The lowest room of io/: it knows no format.
"""
