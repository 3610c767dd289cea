"""Transform files as Slicer saves them, text and HDF5.

May import io/metafile/ and io/disk/.
"""
