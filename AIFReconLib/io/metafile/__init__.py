"""MetaImage and NRRD: headers, and the pixels behind them, checked before anyone allocates memory for what they promise.

May import io/disk/.
"""
