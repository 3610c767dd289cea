"""What is taken from a Plus configuration, and what is said about one that cannot be used."""

from __future__ import annotations

import numpy as np
import pytest
import SimpleITK as sitk
from volume_samples import refusal

from AIFReconLib.errors import ConfigurationError, FileFormatError
from AIFReconLib.holes.filling import HoleFilling
from AIFReconLib.imaging.beams import ProbeGeometry
from AIFReconLib.imaging.region import ClipRectangle, Fan, ImageRegion
from AIFReconLib.io.plus.configuration import read_plus_configuration
from AIFReconLib.io.plus.importance_mask import configured_importance
from AIFReconLib.sweep.configuration import PlusConfiguration

MATRIX = "0.1 0 0 5  0 0.2 0 -6.5  0 0 0.1 7  0 0 0 1"


@pytest.fixture
def read(tmp_path):
    """Reads a configuration with the given content of its root element."""

    def read_content(content: str) -> PlusConfiguration:
        path = tmp_path / "plus.xml"
        path.write_text(f"<PlusConfiguration version='2.9'>{content}</PlusConfiguration>", encoding="utf-8")
        return read_plus_configuration(path)

    return read_content


def transform(attributes: str = "", matrix: str = MATRIX, source: str = "Image", target: str = "Probe") -> str:
    return f'<CoordinateDefinitions><Transform From="{source}" To="{target}" Matrix="{matrix}" {attributes}/></CoordinateDefinitions>'


def reconstruction(attributes: str, children: str = "") -> str:
    return f"<VolumeReconstruction {attributes}>{children}</VolumeReconstruction>"


# Volume reconstruction


def test_an_empty_configuration_asks_for_nothing(read):
    configuration = read("")
    assert {**vars(configuration), "path": None} == vars(PlusConfiguration())
    assert (configuration.grid(), configured_importance(configuration)) == (None, None)


def test_the_output_grid_and_frames_are_read(read):
    configuration = read(
        reconstruction(
            'ImageCoordinateFrame="Image" ReferenceCoordinateFrame="Tracker" OutputSpacing="0.5 0.6 0.7" OutputOrigin="-1 2 3" '
            'OutputExtent="0 9 0 19 0 29" SkipInterval="3"'
        )
    )
    assert (configuration.image_frame, configuration.reference_frame) == ("Image", "Tracker")
    assert (configuration.spacing, configuration.origin) == ((0.5, 0.6, 0.7), (-1, 2, 3))
    assert (configuration.extent, configuration.skip) == ((0, 9, 0, 19, 0, 29), 3)


@pytest.mark.parametrize(
    ("attributes", "region"),
    [
        ('ClipRectangleOrigin="10 20" ClipRectangleSize="30 40"', ImageRegion(clip=ClipRectangle((10, 20), (30, 40)))),
        ('ClipRectangleOrigin="10 20" ClipRectangleSize="0 0"', ImageRegion()),
        *[(f'ClipRectangleSize="{size}"', ImageRegion()) for size in ("-1 -1", "-1 100", "100 -1", "0 5", "-5 0")],
        ('ClipRectangleOrigin="-1 -1" ClipRectangleSize="30 40"', ImageRegion(clip=ClipRectangle((-1, -1), (30, 40)))),
        ('ClipRectangleOrigin="10 20"', ImageRegion()),
        (
            'FanAnglesDeg="-45 30" FanOriginPixel="380 20" FanRadiusStartPixel="120" FanRadiusStopPixel="360"',
            ImageRegion(fan=Fan((380, 20), (-45, 30), (120, 360))),
        ),
        ('FanAngles="-45 30" FanOrigin="380 20" FanDepth="360"', ImageRegion(fan=Fan((380, 20), (-45, 30), (0, 360)))),
        ('FanAnglesDeg="-45 30" FanAngles="-5 5"', ImageRegion(fan=Fan((0, 0), (-45, 30), (0, 500)))),
        ('FanAnglesDeg="0 0" FanOriginPixel="380 20"', ImageRegion()),
    ],
)
def test_clip_and_fan_are_read_in_pixels(read, attributes, region):
    assert read(reconstruction(attributes)).region == region


METHODS = {
    'CompoundingMode="MEAN"': "average",
    'CompoundingMode="latest"': "latest",
    'CompoundingMode="MAXIMUM" Compounding="On"': "maximum",
    'CompoundingMode="IMPORTANCE_MASK"': "average",
    'Compounding="On"': "average",
    'Compounding="Off"': "latest",
    'Compounding="On" Calculation="MAXIMUM"': "maximum",
    'Calculation="WEIGHTED_AVERAGE"': "average",
    "": None,
}


def test_the_compounding_mode_becomes_a_method(read):
    assert {attributes: read(reconstruction(attributes)).method for attributes in METHODS} == METHODS


STICK = '<HoleFillingElement Type="STICK" StickLengthLimit="9" NumberOfSticksToUse="2"/>'
GAUSSIAN = '<HoleFillingElement Type="gaussian" Size="5" Stdev="0.6" MinimumKnownVoxelsRatio="0.1"/>'
CUBE = '<HoleFillingElement Type="NEAREST_NEIGHBOR" Size="7" MinimumKnownVoxelsRatio="0.02"/>'
BY_HITS = '<HoleFillingElement Type="GAUSSIAN_ACCUMULATION" Size="9" Stdev="1.5" MinimumKnownVoxelsRatio="0"/>'
INVERSE = '<HoleFillingElement Type="DISTANCE_WEIGHT_INVERSE" Size="3" MinimumKnownVoxelsRatio="0.3"/>'


FILLED = {
    STICK: (HoleFilling("stick", 9, sticks=2),),
    GAUSSIAN: (HoleFilling("gaussian", 5, 0.6, 0.1),),
    BY_HITS: (HoleFilling("gaussian by hits", 9, 1.5),),
    INVERSE: (HoleFilling("inverse distance", 3, known_ratio=0.3),),
    CUBE + STICK: (HoleFilling("cube", 7, known_ratio=0.02), HoleFilling("stick", 9, sticks=2)),
}


@pytest.mark.parametrize(("elements", "holes"), FILLED.items())
def test_hole_filling_elements_are_read_in_their_order(read, elements, holes):
    configuration = read(reconstruction('FillHoles="ON"', f"<HoleFilling>{elements}</HoleFilling>"))
    assert configuration.holes == holes
    assert configuration.warnings == ()


MASKS = {
    'ImportanceMaskFilename="mask.png"': None,
    "": "plus.xml: VolumeReconstruction@ImportanceMaskFilename is missing",
    'ImportanceMaskFilename="other.png"': "other.png: there is no such file",
    'ImportanceMaskFilename="plus.xml"': "plus.xml: an importance mask must be one of .png",
    'ImportanceMaskFilename="black.png"': "black.png: an importance mask must have pixels above 0",
    'ImportanceMaskFilename="color.png"': "color.png: an importance mask must be an 8-bit gray image; got 2 x 2 vector",
}


@pytest.mark.parametrize(("attributes", "expected"), MASKS.items())
def test_an_importance_mask_stands_beside_the_configuration_or_is_named(read, tmp_path, attributes, expected):
    weights = np.array([[0, 51], [102, 255]], np.uint8)
    sitk.WriteImage(sitk.GetImageFromArray(weights), str(tmp_path / "mask.png"))
    sitk.WriteImage(sitk.GetImageFromArray(0 * weights), str(tmp_path / "black.png"))
    sitk.WriteImage(sitk.GetImageFromArray(np.zeros((2, 2, 3), np.uint8), isVector=True), str(tmp_path / "color.png"))
    configuration = read(reconstruction(f'CompoundingMode="IMPORTANCE_MASK" {attributes}'))
    if expected is None:
        np.testing.assert_allclose(configured_importance(configuration), weights / 255)
        return
    with pytest.raises(FileFormatError) as caught:
        configured_importance(configuration)
    assert expected in str(caught.value)


BOX = 'RecomputeOutputSpacing="TRUE" OutputSpacing="1 1 1" OutputExtent="0 1 0 1 0 1"'
NOT_HONORED = [
    ('ImportanceMaskFilename="mask.png"', "ImportanceMaskFilename=mask.png has no effect without CompoundingMode=IMPORTANCE_MASK"),
    ('EnableFanAnglesAutoDetect="TRUE"', "EnableFanAnglesAutoDetect=TRUE has no effect without FanAnglesDeg"),
    ('Optimization="PARTIAL"', "Optimization=PARTIAL has no effect"),
    ('SkipInterval="0"', "SkipInterval=0 means 1, every frame"),
    ('SomethingNew="3"', "SomethingNew=3 has no effect: VolumeReconstruction has no such attribute"),
    (BOX, "RecomputeOutputSpacing=TRUE has no effect with OutputExtent"),
    ('OutputOrigin="1 2 3"', "OutputOrigin=1 2 3 is not honored without OutputExtent"),
    ('FillHoles="ON"', "FillHoles=ON is not honored: it has no HoleFillingElement"),
]


@pytest.mark.parametrize(("attributes", "named"), NOT_HONORED)
def test_what_is_not_honored_is_said(read, attributes, named):
    (warning,) = read(reconstruction(attributes)).warnings
    assert named in warning


def holes(element: str) -> str:
    return reconstruction('FillHoles="ON"', f"<HoleFilling>{element}</HoleFilling>")


def scan(attributes: str) -> str:
    return f"<ScanConversion {attributes}/>"


CURVED = 'TransducerGeometry="CURVILINEAR" OutputImageSpacingMmPerPixel="0.2 0.4" RadiusStartMm="10" RadiusStopMm="50" '
CURVED += 'ThetaStartDeg="-30" ThetaStopDeg="35"'
LINEAR = 'TransducerGeometry="LINEAR" OutputImageSpacingMmPerPixel="0.1 0.2"'
OF_SIZE = "HoleFillingElement[1]@StickLengthLimit cannot be used. Input size of hole filling must be 1 to 201"
BAD = [
    (transform(matrix="1 2 3"), "Transform ImageToProbe@Matrix must be 16 finite numbers; got '1 2 3'"),
    (transform(matrix=MATRIX.replace("7", "seven")), "Matrix must be 16 finite numbers; 'seven' is not a number"),
    (transform(matrix="1 0 0 0  0 0 0 0  0 0 1 0  0 0 0 1"), "singular"),
    (transform(source=""), "Transform[1]@From is missing"),
    (transform(target="Image"), "must differ from From"),
    (transform() + transform(source="Probe", target="Image"), "states the relation that ImageToProbe states"),
    (holes("<HoleFillingElement/>"), "HoleFillingElement[1]@Type is missing"),
    (holes('<HoleFillingElement Type="MEDIAN"/>'), "Type must be STICK or NEAREST_NEIGHBOR or GAUSSIAN or GAUSSIAN_ACC"),
    (holes(STICK.replace('"9"', '"0"')), OF_SIZE),
    (holes(STICK.replace('"2"', '"0"')), "number of sticks must be at least 1; got 0"),
    (holes(STICK + GAUSSIAN.replace("0.6", "0")), "HoleFillingElement[2]@Size cannot be used. Input standard deviation"),
    (holes(BY_HITS.replace('Stdev="1.5" ', "")), "HoleFillingElement[1]@Stdev is missing"),
    (holes(GAUSSIAN.replace("0.1", "3")), "ratio of known voxels must be 0 to 1; got 3.0"),
    (reconstruction('OutputSpacing="0.5 0.5"'), "VolumeReconstruction@OutputSpacing must be 3 finite numbers; got '0.5 0.5'"),
    (reconstruction('OutputExtent="0 1 0 1 0 1.5"'), "OutputExtent must be whole"),
    (reconstruction('ClipRectangleOrigin="a b"'), "ClipRectangleOrigin must be 2 finite numbers; 'a' is not a number"),
    (reconstruction('FanAnglesDeg="-95 95"'), "FanAnglesDeg cannot be used"),
    (reconstruction('FanDepth="deep"'), "FanDepth must be a finite number"),
    (reconstruction('CompoundingMode="MEDIAN"'), "CompoundingMode must be MEAN or LATEST or MAXIMUM"),
    (reconstruction('FillHoles="maybe"'), "FillHoles must be ON"),
    (reconstruction('OutputSpacing="1 1 1" OutputExtent="0 9 5 4 0 9"'), "OutputExtent must be first and last voxel along x"),
    (reconstruction('OutputExtent="0 9 0 9 0 9"'), "OutputSpacing is missing, and OutputExtent counts voxels"),
    (reconstruction('Interpolation="CUBIC"'), "Interpolation must be NEAREST_NEIGHBOR or LINEAR"),
    (scan(""), "ScanConversion@TransducerGeometry is missing"),
    (scan('TransducerGeometry="PHASED"'), "TransducerGeometry must be CURVILINEAR or LINEAR"),
    (scan(LINEAR.replace("0.1", "0")), "OutputImageSpacingMmPerPixel must be positive"),
    (scan(LINEAR), "TransducerCenterPixel is missing"),
    (scan(CURVED.replace('"-30"', '"-130"') + ' TransducerCenterPixel="1 1"'), "ThetaStartDeg cannot be used"),
]


@pytest.mark.parametrize(("content", "expected"), BAD)
def test_what_cannot_be_used_is_named(read, tmp_path, content, expected):
    assert expected in refusal(tmp_path / "plus.xml", lambda _: read(content), ConfigurationError)


# Scan conversion


APEXES = {
    'TransducerCenterPixel="300 40"': (300, 15),
    'OutputImageSizePixel="640 480"': (320, 0),
    'OutputImageSizePixel="640 480" TransducerCenterPixel="300 5"': (300, -20),
}


@pytest.mark.parametrize(("place", "apex"), APEXES.items())
def test_a_curvilinear_probe_has_its_apex_above_its_face(read, place, apex):
    configuration = read(f"<ScanConversion {CURVED} {place}/>")
    assert configuration.probe == ProbeGeometry("sector", apex)
    assert configuration.scan_region == ImageRegion(fan=Fan(apex, (-30, 35), (10, 50), (0.2, 0.4)))


def test_a_linear_probe_fills_a_rectangle_below_its_face(read):
    configuration = read(f'<ScanConversion {LINEAR} TransducerCenterPixel="300 10" TransducerWidthMm="40" ImagingDepthMm="60"/>')
    assert configuration.probe == ProbeGeometry("linear")
    assert configuration.scan_region == ImageRegion(clip=ClipRectangle((100, 10), (400, 300)))


# Files


def test_a_real_configuration_is_read(real_data):
    """Those of probes with a fan are read where volumes are compared with Plus's own."""
    linear = read_plus_configuration(real_data("BoneUltrasound_L14_config.xml"))
    assert (linear.probe, linear.method) == (ProbeGeometry("linear"), "average")
    assert linear.scan_region.clip.bounds(820, 616) == (175, 645, 0, 615)


NOT_WELL_FORMED = [b"", b"<PlusConfiguration>", b"hello", b"\x00\x01", b"<a>" * 100_000, b" " * 20_000_000]


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        *((content, "not well-formed") for content in NOT_WELL_FORMED),
        (b"<Other/>", "must be PlusConfiguration; got Other"),
        (b'<?xml version="1.0" encoding="no-such"?><PlusConfiguration/>', "encoding"),
        (b"<a>" * 100_000 + b"</a>" * 100_000, "must be PlusConfiguration; got a"),
    ],
)
def test_a_file_that_is_no_configuration_is_refused(tmp_path, content, expected):
    (tmp_path / "plus.xml").write_bytes(content)
    assert expected in refusal(tmp_path / "plus.xml", read_plus_configuration, ConfigurationError)
