"""DICOM files of tests: small, uncompressed, of the attributes that are given."""

from __future__ import annotations

import pydicom as dicom


def write_dicom(path, pixels, **attributes):
    """An uncompressed ultrasound file of one or more gray frames."""
    dataset = dicom.dataset.FileDataset(str(path), {}, preamble=b"\0" * 128)
    dataset.file_meta = dicom.dataset.FileMetaDataset()
    dataset.file_meta.TransferSyntaxUID = dicom.uid.ExplicitVRLittleEndian
    dataset.file_meta.MediaStorageSOPClassUID = dataset.SOPClassUID = "1.2.840.10008.5.1.4.1.1.3.1"
    dataset.file_meta.MediaStorageSOPInstanceUID = dataset.SOPInstanceUID = "1.2.3"
    dataset.Modality, dataset.PhotometricInterpretation, dataset.SamplesPerPixel = "US", "MONOCHROME2", 1
    dataset.Rows, dataset.Columns = pixels.shape[-2:]
    dataset.BitsAllocated = dataset.BitsStored = 8 * pixels.dtype.itemsize
    dataset.HighBit, dataset.PixelRepresentation = 8 * pixels.dtype.itemsize - 1, 0
    if pixels.ndim == 3:
        dataset.NumberOfFrames = len(pixels)  # attributes may say otherwise
    for name, value in attributes.items():
        setattr(dataset, name, value)
    dataset.PixelData = pixels.tobytes() + b"\0" * (pixels.nbytes % 2)
    dataset.save_as(str(path), enforce_file_format=True)
    return path
