"""Files in and out; SimpleITK is imported here only.

One room a kind of file: disk/ (safe reading and writing of any), metafile/ (headers and pixels of MetaImage and NRRD), transform/,
volume/, plus/ (configurations), sequence/, foreign/ (recordings of people without Plus). Each may import those named before it, and
sweep/ and below.
"""
