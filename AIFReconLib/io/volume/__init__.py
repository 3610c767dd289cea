"""Volume files: labels, CTs and results, flipped between LPS in the file and RAS in memory.

May import io/transform/, io/metafile/ and io/disk/.
"""
