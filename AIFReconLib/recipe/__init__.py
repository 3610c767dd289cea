"""All that can be asked of a reconstruction, said once: every door takes names, ranges, units and words from here.

May import compounding/methods/, errors, message and what stands below them.
"""
