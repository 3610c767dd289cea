"""Recordings and images of other programs that are known by their names and not read: what each is, and the way that there is."""

from __future__ import annotations

from pathlib import Path

from ....errors import SequenceFormatError

_PICTURES_AND_TABLE = "Export its frames as pictures and its poses as a table, and import these"

UNREAD = (
    ((".sw", ".sxi"), "a recording of Stradwin", f"{_PICTURES_AND_TABLE}: the .sw file holds the positions as text"),
    ((".mitk",), "a scene of MITK", "Save its images as .nrrd and its navigation data as CSV in MITK, and import these"),
    (
        (".mkv",),
        "a video that Plus or SlicerIGSIO may have tracked",
        "EditSequenceFile of Plus writes it as .igs.mha",
    ),
    (
        (".imf", ".iws"),
        "a recording of ImFusion",
        "Export images as MetaImage and tracking as CSV there, and import these",
    ),
    ((".mnc",), "an image of MINC, as IBIS records them", f"{_PICTURES_AND_TABLE}: mnc2nii, then one picture a frame"),
    ((".mat",), "a file of MATLAB", "Read it with scipy.io.loadmat, and write images and image_to_reference with numpy.savez"),
    ((".h5", ".hdf5"), "a file of HDF5", "Read it with h5py, and write images and image_to_reference with numpy.savez"),
    (
        (".b8", ".b32", ".bpr", ".rf"),
        "a recording of an Ultrasonix scanner",
        "Convert it to pictures, and import these with the poses",
    ),
    ((".tvd",), "a recording of a Telemed scanner", "Export it as a video, and import that with the poses"),
    ((".lzo", ".tar"), "raw data of a Clarius scanner", "Export B-mode as DICOM or a video, and import that with the poses"),
    ((".vol",), "a 3D volume of a Kretz scanner", "Record 2D frames with their poses"),
    ((".mrml",), "a scene of Slicer in many files", "Save it in Slicer as a bundle (.mrb)"),
)
"""Suffixes, what they are, and what to do."""


def refuse_unread(path: Path) -> None:
    """Return if a file has none of these names.

    Raises SequenceFormatError otherwise.
    """
    for suffixes, what, way in UNREAD:
        if path.suffix.lower() in suffixes:
            raise SequenceFormatError(f"{path}: this is {what}, which is not read as it is. {way}.")
