"""Recordings of people without Plus: pictures, DICOM, video, numpy arrays, pose tables and calibrations become sequences.

The highest room of io/; optional packages are imported when first needed.
"""
