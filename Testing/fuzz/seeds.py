"""Good inputs, small, made by code: what the damage starts from."""

from __future__ import annotations

import gzip
import io
import struct
import tempfile
import zlib
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

IDENTITY = "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"
POSES = [f"0 -0.1 0 {n} 0.1 0 0 -5.5 0 0 0.1 {3 * n} 0 0 0 1" for n in range(3)]
PIXELS = bytes(range(24)) * 3


def _fields() -> list[tuple[str, str]]:
    """What Plus writes of three frames."""
    entries = []
    for n, pose in enumerate(POSES):
        prefix = f"Seq_Frame{n:04d}_"
        entries += [
            (f"{prefix}ImageToReferenceTransform", pose),
            (f"{prefix}ImageToReferenceTransformStatus", "OK" if n else "OUT_OF_VIEW"),
            (f"{prefix}Timestamp", f"{10 + 0.1 * n:.3f}"),
            (f"{prefix}ImageStatus", "OK"),
        ]
    return entries


def metaimage(payload: bytes = PIXELS, /, **changes: str | None) -> bytes:
    """A sequence of three images of 6 x 4 pixels; `changes` replaces entries, None removes one."""
    header = {
        "ObjectType": "Image",
        "NDims": "3",
        "BinaryData": "True",
        "BinaryDataByteOrderMSB": "False",
        "CompressedData": "False",
        "DimSize": "6 4 3",
        "Kinds": "domain domain list",
        "ElementSpacing": "1 1 1",
        "Offset": "0 0 0",
        "TransformMatrix": "1 0 0 0 1 0 0 0 1",
        "ElementType": "MET_UCHAR",
        "UltrasoundImageOrientation": "MFA",
        "UltrasoundImageType": "BRIGHTNESS",
        **dict(_fields()),
        **changes,
    }
    header["ElementDataFile"] = header.pop("ElementDataFile", "LOCAL")
    return "".join(f"{key} = {value}\n" for key, value in header.items() if value is not None).encode() + payload


def nrrd(payload: bytes = PIXELS, /, pairs: list[tuple[str, str]] | None = None, **changes: str | None) -> bytes:
    """The same as NRRD; underscores in `changes` stand for spaces."""
    header = {
        "type": "uint8",
        "dimension": "3",
        "space": "left-posterior-superior",
        "sizes": "6 4 3",
        "space_directions": "(1,0,0) (0,1,0) (0,0,1)",
        "kinds": "domain domain list",
        "encoding": "raw",
        "endian": "little",
        "space_origin": "(0,0,0)",
        **changes,
    }
    pairs = [("ultrasound image orientation", "MFA"), *_fields()] if pairs is None else pairs
    lines = [f"{key.replace('_', ' ')}: {value}\n" for key, value in header.items() if value is not None]
    return b"NRRD0005\n" + "".join([*lines, *(f"{key}:={value}\n" for key, value in pairs)]).encode() + b"\n" + payload


def metaimage_sequences() -> list[bytes]:
    """Plus, raw and compressed, color, 16 bit, Slicer."""
    packed = zlib.compress(PIXELS)
    return [
        metaimage(),
        metaimage(packed, CompressedData="True", CompressedDataSize=str(len(packed))),
        metaimage(DimSize="2 4 3", ElementNumberOfChannels="3"),
        metaimage(DimSize="3 4 3", ElementType="MET_USHORT", ElementByteOrderMSB="True", UltrasoundImageOrientation="UNA"),
        metaimage(DimSize="3 2 3", ElementType="MET_FLOAT"),
        metaimage(Kinds=None, RecordingUnfinished="True"),
        metaimage(b"", DimSize="0 0 3", ElementType="MET_UCHAR"),
    ]


def nrrd_sequences() -> list[bytes]:
    """Plus, and Slicer's .seq.nrrd with its index, new and old."""
    index = [("axis 3 index type", "numeric"), ("axis 3 index values", "0 0.1 0.2"), ("axis 3 item 0001 Note", "a")]
    old = [("axis 0 index type", "numeric"), ("axis 0 index values", "0 0.1 0.2")]
    slicer = {"dimension": "4", "sizes": "6 4 1 3", "kinds": "domain domain domain list", "units": '"mm" "mm" "mm" "s"'}
    slicer |= {"space_directions": "(0.5,0,0) (0,1,0) (0,0,1) none", "labels": '"" "" "" "time"'}
    early = slicer | {"sizes": "3 6 4 1", "kinds": "list domain domain domain", "space_directions": "none (1,0,0) (0,1,0) (0,0,1)"}
    early |= {"units": '"s" "mm" "mm" "mm"', "labels": '"time" "" "" ""'}
    return [
        nrrd(),
        nrrd(gzip.compress(PIXELS, mtime=0), encoding="gzip"),
        nrrd(pairs=[*_fields(), *index], **slicer),
        nrrd(gzip.compress(PIXELS, mtime=0), pairs=old, **{**early, "encoding": "gzip"}),
        nrrd(dimension="4", sizes="3 2 4 3", kinds="RGB-color domain domain list", space_directions="none (1,0,0) (0,1,0) none"),
    ]


def volumes(suffix: str) -> list[bytes]:
    """Volumes, label volumes and segmentations with layers, of one file format."""
    if suffix == ".mha":
        packed = zlib.compress(PIXELS)
        left_out = ("Kinds", "UltrasoundImageOrientation", "UltrasoundImageType", *(key for key, _ in _fields()))
        plain: dict[str, str | None] = dict.fromkeys(left_out)
        return [
            metaimage(**plain),
            metaimage(packed, **plain, CompressedData="True", CompressedDataSize=str(len(packed))),
            metaimage(**plain | {"DimSize": "3 4 3", "ElementType": "MET_SHORT", "ElementSpacing": "0.5 1 2", "Offset": "-10 20 3e1"}),
            metaimage(**plain | {"DimSize": "2 4 3", "ElementNumberOfChannels": "3", "AnatomicalOrientation": "RAI"}),
        ]
    kinds = {"kinds": "domain domain domain"}
    packed = gzip.compress(PIXELS, mtime=0)
    layers = {"dimension": "4", "sizes": "2 3 4 3", "kinds": "list domain domain domain"}
    layers |= {"space_directions": "none (1,0,0) (0,1,0) (0,0,1)"}
    segments = [("Segment0_ID", "a"), ("Segment0_Layer", "0"), ("Segment1_ID", "b"), ("Segment1_Layer", "1")]
    return [
        nrrd(pairs=[], **kinds),
        nrrd(packed, pairs=[], **kinds | {"encoding": "gzip", "space": "right-anterior-superior"}),
        nrrd(pairs=[], **kinds | {"type": "short", "sizes": "3 4 3", "space_directions": "(0,0.5,0) (0,0,1) (2,0,0)"}),
        nrrd(pairs=[], space=None, space_directions=None, space_origin=None, kinds=None, spacings="0.5 1 2"),
        nrrd(packed, pairs=segments, **layers | {"encoding": "gzip"}),
    ]


def nifti() -> list[bytes]:
    """NIfTI-1 and NIfTI-2 of 4 x 3 x 2 voxels, placed by a matrix and by a quaternion."""
    first = bytearray(352 + 24)
    struct.pack_into("<i", first, 0, 348)
    struct.pack_into("<8h", first, 40, 3, 4, 3, 2, 1, 1, 1, 1)
    struct.pack_into("<hh", first, 70, 2, 8)
    struct.pack_into("<8f", first, 76, 1, 0.5, 0.5, 2, 1, 0, 0, 0)
    struct.pack_into("<f", first, 108, 352)
    struct.pack_into("<ffB", first, 112, 1, 0, 0)
    first[123] = 2
    struct.pack_into("<hh", first, 252, 0, 1)
    struct.pack_into("<12f", first, 280, 0.5, 0, 0, -3, 0, 0.5, 0, 4, 0, 0, 2, 1)
    first[344:348] = b"n+1\0"
    first[352:] = bytes(range(24))
    by_quaternion = bytearray(first)
    struct.pack_into("<hh", by_quaternion, 252, 1, 0)
    struct.pack_into("<6f", by_quaternion, 256, 0, 0, 0.7071, 1, 2, 3)
    second = bytearray(544 + 24)
    struct.pack_into("<i", second, 0, 540)
    second[4:12] = b"n+2\0\r\n\x1a\n"
    struct.pack_into("<hh", second, 12, 2, 8)
    struct.pack_into("<8q", second, 16, 3, 4, 3, 2, 1, 1, 1, 1)
    struct.pack_into("<8d", second, 104, 1, 0.5, 0.5, 2, 1, 0, 0, 0)
    struct.pack_into("<q", second, 168, 544)
    struct.pack_into("<d", second, 176, 1)
    struct.pack_into("<ii", second, 344, 0, 1)
    struct.pack_into("<12d", second, 400, 0.5, 0, 0, -3, 0, 0.5, 0, 4, 0, 0, 2, 1)
    second[544:] = bytes(range(24))
    shorts = bytearray(first[:352] + bytes(48))
    struct.pack_into("<hh", shorts, 70, 4, 16)
    return [bytes(first), bytes(by_quaternion), bytes(second), bytes(shorts)]


CONFIGURATION = f"""<PlusConfiguration version="2.9">
  <DataCollection><Device Id="V" Type="VirtualVolumeReconstructor"><VolumeReconstruction OutputSpacing="1 1 1"/></Device></DataCollection>
  <CoordinateDefinitions>
    <Transform From="Image" To="Probe" Matrix="{POSES[1]}" Error="0.5" Date="2020" />
    <Transform From="Reference" To="Tracker" Matrix="{IDENTITY}" Status="OK" />
  </CoordinateDefinitions>
  <VolumeReconstruction ReferenceCoordinateFrame="Reference" ImageCoordinateFrame="Image" OutputSpacing="0.5 0.5 0.5"
    OutputOrigin="0 0 0" OutputExtent="0 10 0 20 0 30" ClipRectangleOrigin="1 1" ClipRectangleSize="4 3" FanAnglesDeg="-30 30"
    FanOriginPixel="3 -2" FanRadiusStartPixel="1" FanRadiusStopPixel="9" EnableFanAnglesAutoDetect="TRUE"
    FanAnglesAutoDetectBrightnessThreshold="10" FanAnglesAutoDetectFilterRadiusPixel="2" PixelRejectionThreshold="3" SkipInterval="2"
    Interpolation="LINEAR" CompoundingMode="IMPORTANCE_MASK" ImportanceMaskFilename="mask.png" NumberOfThreads="2" Optimization="FULL"
    FillHoles="ON">
    <HoleFilling><HoleFillingElement Type="STICK" StickLengthLimit="9" NumberOfSticksToUse="1"/>
      <HoleFillingElement Type="GAUSSIAN" Size="5" Stdev="0.7" MinimumKnownVoxelsRatio="0.5"/>
      <HoleFillingElement Type="NEAREST_NEIGHBOR" Size="3" MinimumKnownVoxelsRatio="0.1"/></HoleFilling>
  </VolumeReconstruction>
  <ScanConversion TransducerGeometry="CURVILINEAR" RadiusStartMm="10" RadiusStopMm="60" ThetaStartDeg="-30" ThetaStopDeg="30"
    OutputImageSizePixel="60 40" TransducerCenterPixel="30 0" OutputImageSpacingMmPerPixel="0.2 0.2" TransducerWidthMm="50"
    ImagingDepthMm="60" />
</PlusConfiguration>
"""


def configurations() -> list[bytes]:
    """Every attribute that is read, in one file or in two encodings."""
    linear = CONFIGURATION.replace("CURVILINEAR", "LINEAR").replace("IMPORTANCE_MASK", "MAXIMUM")
    bomb = '<!DOCTYPE a [<!ENTITY b "c"><!ENTITY d "&b;&b;"><!ENTITY e SYSTEM "mask.png">]>' + CONFIGURATION
    return [text.encode() for text in (CONFIGURATION, linear, bomb, '<?xml version="1.0" encoding="utf-16"?>' + linear)]


def pose_tables() -> list[bytes]:
    """Matrices and quaternions, with names and without."""
    quaternions = "time,x,y,z,qx,qy,qz,qw,status,image\n0.1,1,2,3,0,0,0,1,OK,a.png\n0.2,1,2,3,0,0,0.6,0.8,MISSING,b.png\n"
    return [
        "\n".join(POSES).encode(),
        quaternions.encode(),
        b"# time x y z rx ry rz\n0 1 2 3 10 20 30\n0.1 1 2 3 nan nan nan\n",
        b"1 0 0 5\n0 1 0 6\n0 0 1 7\n0 0 0 1\n",
        b"timestamp_ms;" + ";".join(f"m{n}" for n in range(16)).encode() + b"\n5;" + POSES[0].replace(" ", ";").encode() + b";\n",
    ]


def pose_json() -> list[bytes]:
    """Lists of matrices, and objects of every part."""
    return [
        b"[[" + POSES[0].replace(" ", ",").encode() + b"],[[1,0,0,0],[0,1,0,0],[0,0,1,0]]]",
        b'{"frames": [{"time": 0.5, "image": "a.png", "translation": [1, 2, 3], "quaternion": {"x": 0, "y": 0, "z": 0, "w": 1}}, '
        b'{"time": 1e0, "image": "b.png", "translation": [1, 2, null], "quaternion": {"x": 0, "y": 0, "z": 0, "w": 1}}]}',
        b'{"poses": [{"position": {"x": 1, "y": 2, "z": 3}, "euler": [10, 20, 30], "status": "OK", "other": {"a": []}}]}',
    ]


def settings(suffix: str) -> list[bytes]:
    """Every setting that a reconstruction keeps, and what a hand may write."""
    from AIFReconLib.provenance.settings_files import write_settings

    kept = {
        "method": "aif",
        "alpha": 0.1,
        "hole_limit": "auto",
        "skip": 2,
        "engine": "numpy",
        "spacing": [1, 1, 2.5],
        "reference": "Tracker",
        "clip_px": [1, 2, 30, 20.5],
        "probe": "sector",
        "apex_px": [19.5, -30],
        "fan_apex_px": [19, -30],
        "fan_angles_deg": [-20, 25],
        "fan_radius_px": [31, 57.7],
        "fan_pixel_size": [0.4, 0.5],
        "fan_detection": [30, 10],
        "bone_from_sweep": True,
        "grid_size": [7, 8, 9],
        "grid_to_reference": np.diag([0.5, 0.6, 0.7, 1.0]).tolist(),
        "time_offset": -0.1,
        "bone_sigma_mm": 4,
    }
    by_hand = {".json": b'{"hole-limit": 0, "version": "9.0"}', ".toml": b"# ours\nhole-limit = 0\nspacing = [\n1, 1, 2]\n"}
    return [_written(lambda path: write_settings(kept, path), f"settings{suffix}"), by_hand[suffix]]


def calibrations() -> list[bytes]:
    """Sixteen numbers, and a Slicer transform under a name that does not say so."""
    return [POSES[1].encode(), b"[[0.1, 0, 0, 5], [0, 0.2, 0, 6], [0, 0, 0.1, 7], [0, 0, 0, 1]]", *transform_texts()]


def transform_texts() -> list[bytes]:
    """Linear ITK transforms of several kinds, and one that is not linear."""
    head = "#Insight Transform File V1.0\n"

    def one(number: int, kind: str, parameters: str, fixed: str = "0 0 0") -> str:
        return f"#Transform {number}\nTransform: {kind}_double_3_3\nParameters: {parameters}\nFixedParameters: {fixed}\n"

    affine = one(0, "AffineTransform", "0.8 -0.6 0 0.6 0.8 0 0 0 1 5 -6 7")
    grid = one(0, "BSplineTransform", " ".join(["0"] * 24), "2 2 2 0 0 0 1 1 1 1 0 0 0 1 0 0 0 1")
    return [
        (head + affine).encode(),
        (head + one(0, "Euler3DTransform", "0.1 0.2 0.3 1 2 3", "0 0 0 0")).encode(),
        (head + one(0, "VersorRigid3DTransform", "0 0 0.5 1 2 3")).encode(),
        (head + one(0, "TranslationTransform", "1 2 3", "")).encode(),
        (
            head
            + one(0, "CompositeTransform", "", "")
            + affine.replace("#Transform 0", "#Transform 1")
            + one(2, "IdentityTransform", "", "")
        ).encode(),
        (head + grid).encode(),
    ]


def pictures() -> list[bytes]:
    """PNG, JPEG, TIFF of two pages, BMP, palette, and what only looks like a picture."""
    from PIL import Image

    gray = Image.fromarray(np.arange(48, dtype=np.uint8).reshape(6, 8))
    deep = Image.fromarray((np.arange(48, dtype=np.uint16) * 999).reshape(6, 8))
    made = []
    for picture, options in (
        (gray, {"format": "PNG"}),
        (gray, {"format": "JPEG"}),
        (deep, {"format": "TIFF", "compression": "tiff_adobe_deflate"}),
        (gray, {"format": "TIFF", "save_all": True, "append_images": [gray]}),
        (gray, {"format": "BMP"}),
        (gray.convert("P"), {"format": "PNG"}),
        (gray.convert("RGBA"), {"format": "PNG"}),
    ):
        file = io.BytesIO()
        picture.save(file, **options)
        made.append(file.getvalue())
    return [*made, b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 8 6\n%%EndComments\nshowpage\n"]


def masks(suffix: str) -> list[bytes]:
    """An importance mask, as SimpleITK writes it."""
    import SimpleITK as sitk

    image = sitk.GetImageFromArray(np.arange(48, dtype=np.uint8).reshape(6, 8))
    return [_written(lambda path: sitk.WriteImage(image, str(path)), f"mask{suffix}")]


def dicom() -> list[bytes]:
    """One frame and three, with times, and a region of ultrasound."""
    import pydicom

    def write(path: Path, frames: int) -> None:
        dataset = pydicom.dataset.FileDataset(str(path), {}, preamble=b"\0" * 128)
        dataset.file_meta = pydicom.dataset.FileMetaDataset()
        dataset.file_meta.TransferSyntaxUID = pydicom.uid.ExplicitVRLittleEndian
        dataset.file_meta.MediaStorageSOPClassUID = dataset.SOPClassUID = "1.2.840.10008.5.1.4.1.1.3.1"
        dataset.file_meta.MediaStorageSOPInstanceUID = dataset.SOPInstanceUID = "1.2.3"
        dataset.Modality, dataset.PhotometricInterpretation, dataset.SamplesPerPixel = "US", "MONOCHROME2", 1
        dataset.Rows, dataset.Columns, dataset.InstanceNumber = 4, 6, 7
        dataset.BitsAllocated = dataset.BitsStored = 8
        dataset.HighBit, dataset.PixelRepresentation, dataset.PixelSpacing = 7, 0, [0.5, 0.25]
        if frames > 1:
            dataset.NumberOfFrames, dataset.FrameTimeVector = frames, [0, *[40.0] * (frames - 1)]
            region = pydicom.dataset.Dataset()
            region.PhysicalUnitsXDirection = region.PhysicalUnitsYDirection = 3
            region.PhysicalDeltaX = region.PhysicalDeltaY = 0.02
            dataset.SequenceOfUltrasoundRegions = [region]
        dataset.PixelData = bytes(range(24)) * frames
        dataset.save_as(str(path), enforce_file_format=True)

    return [_written(partial(write, frames=frames), "frame.dcm") for frames in (1, 3)]


def arrays() -> list[bytes]:
    """Numpy arrays; one of objects, which hold a pickle."""
    made = [
        np.arange(72, dtype=np.uint8).reshape(3, 4, 6),
        np.zeros((2, 3, 4, 3), ">f4"),
        np.array([{"a": 1}] * 8, object).reshape(2, 2, 2),
    ]
    return [_written(partial(np.save, arr=images, allow_pickle=True), "images.npy") for images in made]


def stream_bodies() -> list[bytes]:
    """OpenIGTLink messages whole: images, transforms, tracking data, statuses, of both header versions."""
    import pyigtl

    def packed(message, version: int, metadata: dict[str, str]) -> bytes:
        message.header_version, message.metadata = version, metadata
        return bytes(message.pack())

    pose = np.array(POSES[1].split(), float).reshape(4, 4)
    image = np.arange(24, dtype=np.uint8).reshape(1, 4, 6)
    made = []
    for version in (1, 2):
        notes = {"TransformStatus": "OK", "ProbeToTrackerIndex": "0"} if version == 2 else {}
        for voxels in (image, image.astype("i2"), np.zeros((1, 2, 3, 3), np.uint8)):
            message = pyigtl.ImageMessage(voxels, ijk_to_world_matrix=pose, timestamp=100.5, device_name="Image_Reference")
            made.append(packed(message, version, notes))
        made.append(packed(pyigtl.TransformMessage(pose, timestamp=100.5, device_name="ProbeToTracker"), version, notes))
    tool = struct.pack(">20sBB12f", b"ProbeToTracker", 1, 0, *range(12))
    status = struct.pack(">Hq20s", 1, 0, b"OK") + b"fine\0"
    made += [_message(kind, body) for kind, body in ((b"TDATA", tool * 2), (b"STATUS", status))]
    return made


def _message(kind: bytes, body: bytes) -> bytes:
    return with_checksum(struct.pack(">H12s20sQQQ", 1, kind, b"Tracker", 100 << 32, len(body), 0) + body)


def with_checksum(message: bytes) -> bytes:
    """A message whose size and checksum are those of the body that it has."""
    from AIFReconLib.live.wire.crc64 import crc64

    if len(message) < 58:
        return message
    body = message[58:]
    return message[:42] + struct.pack(">QQ", len(body), crc64(body)) + body


def _written(write: Callable[[Path], object], name: str) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        write(path)
        return path.read_bytes()
