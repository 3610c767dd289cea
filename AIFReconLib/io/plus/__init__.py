"""Configurations of the Plus toolkit, and the importance masks they name.

May import io/metafile/, io/disk/ and what a configuration speaks of: regions, probes, hole filling.
"""
