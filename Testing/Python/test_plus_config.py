"""What is taken from a Plus configuration, and what is said about one that cannot be used."""

from __future__ import annotations

import numpy as np
import pytest

from AIFReconLib.beams import ProbeGeometry
from AIFReconLib.errors import ConfigurationError
from AIFReconLib.io.plus_config import PlusConfiguration, read_plus_configuration
from AIFReconLib.region import ClipRectangle, Fan, ImageRegion
from AIFReconLib.transform_graph import TransformName, TransformStatus

MATRIX = "0.1 0 0 5  0 0.2 0 -6.5  0 0 0.1 7  0 0 0 1"


@pytest.fixture
def read(tmp_path):
    """Reads a configuration with the given content of its root element."""

    def read_content(content: str) -> PlusConfiguration:
        path = tmp_path / "plus.xml"
        path.write_text(f"<PlusConfiguration version='2.9'>{content}</PlusConfiguration>", encoding="utf-8")
        return read_plus_configuration(path)

    return read_content


@pytest.fixture
def refusal(read):
    """What is said about a configuration with the given content."""

    def read_content(content: str) -> str:
        with pytest.raises(ConfigurationError) as caught:
            read(content)
        message = str(caught.value)
        assert "plus.xml: " in message
        assert "\n" not in message
        return message

    return read_content


def transform(attributes: str = "", matrix: str = MATRIX, source: str = "Image", target: str = "Probe") -> str:
    return f'<CoordinateDefinitions><Transform From="{source}" To="{target}" Matrix="{matrix}" {attributes}/></CoordinateDefinitions>'


def reconstruction(attributes: str, children: str = "") -> str:
    return f"<VolumeReconstruction {attributes}>{children}</VolumeReconstruction>"


# Transforms


def test_transforms_are_read_row_by_row(read):
    ((name, sample),) = read(transform()).transforms.items()
    assert name == TransformName("Image", "Probe")
    assert sample.status is TransformStatus.OK
    np.testing.assert_array_equal(sample.matrix, [[0.1, 0, 0, 5], [0, 0.2, 0, -6.5], [0, 0, 0.1, 7], [0, 0, 0, 1]])


def test_the_status_of_a_transform_is_honored(read):
    sample = read(transform('Status="INVALID"', matrix="0 " * 16)).transforms[TransformName("Image", "Probe")]
    assert sample.status is TransformStatus.INVALID


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (transform(matrix="1 2 3"), "Transform ImageToProbe@Matrix must be 16 finite numbers; got '1 2 3'"),
        (transform(matrix=MATRIX.replace("7", "seven")), "Matrix must be 16 finite numbers; 'seven' is not a number"),
        (transform(matrix=MATRIX.replace("7", "nan")), "Matrix must be 16 finite numbers"),
        (transform(matrix="1 0 0 0  0 0 0 0  0 0 1 0  0 0 0 1"), "singular"),
        (transform(matrix="1 0 0 0  0 1 0 0  0 0 1 0  0 0 1 1"), "last row"),
        (transform(source=""), "Transform[1]@From is missing"),
        (transform(target="Image"), "must differ from From"),
        ('<CoordinateDefinitions><Transform From="Image" To="Probe"/></CoordinateDefinitions>', "ImageToProbe@Matrix is missing"),
        (transform() + transform(), "states the relation that ImageToProbe states"),
        (transform() + transform(source="Probe", target="Image"), "states the relation that ImageToProbe states"),
    ],
)
def test_a_transform_that_cannot_be_used_is_named(refusal, content, expected):
    assert expected in refusal(content)


# Volume reconstruction


def test_an_empty_configuration_asks_for_nothing(read):
    configuration = read("")
    assert configuration.transforms == {}
    assert (configuration.spacing, configuration.origin, configuration.extent, configuration.method) == (None, None, None, None)
    assert (configuration.region, configuration.probe, configuration.scan_region) == (ImageRegion(), None, None)
    assert (configuration.image_frame, configuration.reference_frame) == (None, None)
    assert (configuration.hole_filling, configuration.skip, configuration.warnings) == (False, 1, ())


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


@pytest.mark.parametrize(
    ("attributes", "method"),
    [
        ('CompoundingMode="MEAN"', "average"),
        ('CompoundingMode="latest"', "latest"),
        ('CompoundingMode="MAXIMUM" Compounding="On"', "maximum"),
        ('CompoundingMode="IMPORTANCE_MASK"', None),
        ('Compounding="On"', "average"),
        ('Compounding="Off"', "latest"),
        ('Compounding="On" Calculation="MAXIMUM"', "maximum"),
        ('Calculation="WEIGHTED_AVERAGE"', "average"),
        ("", None),
    ],
)
def test_the_compounding_mode_becomes_a_method(read, attributes, method):
    assert read(reconstruction(attributes)).method == method


@pytest.mark.parametrize(("word", "expected"), [("ON", True), ("off", False), ("On", True)])
def test_hole_filling_is_on_or_off(read, word, expected):
    assert read(reconstruction(f'FillHoles="{word}"')).hole_filling is expected


@pytest.mark.parametrize(
    ("attributes", "named"),
    [
        ('Interpolation="LINEAR"', "Interpolation=LINEAR"),
        ('CompoundingMode="IMPORTANCE_MASK"', "CompoundingMode=IMPORTANCE_MASK"),
        ('ImportanceMaskFilename="mask.png"', "ImportanceMaskFilename=mask.png"),
        ('PixelRejectionThreshold="10"', "PixelRejectionThreshold=10"),
        ('EnableFanAnglesAutoDetect="TRUE"', "EnableFanAnglesAutoDetect=TRUE"),
    ],
)
def test_what_is_not_honored_is_said(read, attributes, named):
    (warning,) = read(reconstruction(attributes)).warnings
    assert named in warning


@pytest.mark.parametrize("elements", ["", '<HoleFilling><HoleFillingElement Type="STICK"/></HoleFilling>'])
def test_hole_filling_says_which_option_fills(read, elements):
    (warning,) = read(reconstruction('FillHoles="ON"', elements)).warnings
    assert "--hole-limit" in warning


@pytest.mark.parametrize("attribute", ['OutputOrigin="1 2 3"', 'OutputExtent="0 9 0 9 0 9"'])
def test_an_output_box_is_not_honored_and_named(read, attribute):
    (warning,) = read(reconstruction(attribute)).warnings
    assert attribute.split("=")[0] in warning


@pytest.mark.parametrize(
    "attributes", ['Interpolation="NEAREST_NEIGHBOR"', 'Optimization="FULL"', 'NumberOfThreads="4"', 'PixelRejectionThreshold="0"']
)
def test_what_does_not_change_the_volume_is_not_mentioned(read, attributes):
    assert read(reconstruction(attributes)).warnings == ()


@pytest.mark.parametrize(
    ("attributes", "expected"),
    [
        ('OutputSpacing="0.5 0.5"', "VolumeReconstruction@OutputSpacing must be 3 finite numbers; got '0.5 0.5'"),
        ('OutputSpacing="0.5 0.5 0"', "OutputSpacing must be positive"),
        ('OutputSpacing="0.5 0.5 inf"', "OutputSpacing must be 3 finite numbers"),
        ('OutputExtent="0 1 0 1 0 1.5"', "OutputExtent must be whole"),
        ('ClipRectangleOrigin="a b"', "ClipRectangleOrigin must be 2 finite numbers; 'a' is not a number"),
        ('ClipRectangleSize="-5 5"', "ClipRectangleSize cannot be used"),
        ('FanAnglesDeg="-95 95"', "FanAnglesDeg cannot be used"),
        ('FanAnglesDeg="-45 45" FanRadiusStartPixel="600"', "FanAnglesDeg cannot be used"),
        ('FanDepth="deep"', "FanDepth must be a finite number"),
        ('SkipInterval="0"', "SkipInterval must be positive"),
        ('CompoundingMode="MEDIAN"', "CompoundingMode must be MEAN or LATEST or MAXIMUM"),
        ('FillHoles="maybe"', "FillHoles must be ON"),
        ('Interpolation="CUBIC"', "Interpolation must be NEAREST_NEIGHBOR or LINEAR"),
    ],
)
def test_an_attribute_that_cannot_be_used_is_named(refusal, attributes, expected):
    assert expected in refusal(reconstruction(attributes))


def test_the_element_may_stand_in_a_volume_reconstructing_device(read):
    devices = '<DataCollection><Device Id="A" Type="Other"><VolumeReconstruction OutputSpacing="9 9 9"/></Device>'
    devices += '<Device Id="B" Type="VirtualVolumeReconstructor"><VolumeReconstruction OutputSpacing="1 2 3"/></Device></DataCollection>'
    assert read(devices).spacing == (1, 2, 3)


# Scan conversion

CURVED = 'TransducerGeometry="CURVILINEAR" OutputImageSpacingMmPerPixel="0.2 0.4" RadiusStartMm="10" RadiusStopMm="50" '
CURVED += 'ThetaStartDeg="-30" ThetaStopDeg="35"'


@pytest.mark.parametrize(
    ("place", "apex"),
    [
        ('TransducerCenterPixel="300 40"', (300, 15)),
        ('OutputImageSizePixel="640 480"', (320, 0)),
        ('OutputImageSizePixel="640 480" TransducerCenterPixel="300 5"', (300, -20)),
    ],
)
def test_a_curvilinear_probe_has_its_apex_above_its_face(read, place, apex):
    configuration = read(f"<ScanConversion {CURVED} {place}/>")
    assert configuration.probe == ProbeGeometry("sector", apex)
    assert configuration.scan_region == ImageRegion(fan=Fan(apex, (-30, 35), (10, 50), (0.2, 0.4)))


def test_the_face_of_a_curvilinear_probe_is_in_its_region_and_the_apex_is_not(read):
    region = read(f'<ScanConversion {CURVED} TransducerCenterPixel="300 40"/>').scan_region
    mask = region.mask(640, 480)
    assert mask[40, 300]
    assert not mask[39, 300]


LINEAR = 'TransducerGeometry="LINEAR" OutputImageSpacingMmPerPixel="0.1 0.2"'


def test_a_linear_probe_fills_a_rectangle_below_its_face(read):
    configuration = read(f'<ScanConversion {LINEAR} TransducerCenterPixel="300 10" TransducerWidthMm="40" ImagingDepthMm="60"/>')
    assert configuration.probe == ProbeGeometry("linear")
    assert configuration.scan_region == ImageRegion(clip=ClipRectangle((100, 10), (400, 300)))


def test_a_linear_probe_without_center_stands_in_the_middle_of_the_top(read):
    configuration = read(f'<ScanConversion {LINEAR} OutputImageSizePixel="640 480" TransducerWidthMm="40" ImagingDepthMm="60"/>')
    assert configuration.scan_region == ImageRegion(clip=ClipRectangle((120, 0), (400, 300)))


def test_a_linear_probe_without_extent_has_no_region(read):
    assert read(f'<ScanConversion {LINEAR} OutputImageSizePixel="640 480"/>').scan_region is None


@pytest.mark.parametrize(
    ("attributes", "expected"),
    [
        ("", "ScanConversion@TransducerGeometry is missing"),
        ('TransducerGeometry="PHASED"', "TransducerGeometry must be CURVILINEAR or LINEAR"),
        ('TransducerGeometry="LINEAR"', "OutputImageSpacingMmPerPixel is missing"),
        ('TransducerGeometry="LINEAR" OutputImageSpacingMmPerPixel="0 1"', "OutputImageSpacingMmPerPixel must be positive"),
        (LINEAR, "TransducerCenterPixel is missing"),
        (CURVED.replace("RadiusStartMm", "Other") + ' TransducerCenterPixel="1 1"', "RadiusStartMm is missing"),
        (CURVED.replace('"-30"', '"-130"') + ' TransducerCenterPixel="1 1"', "ThetaStartDeg cannot be used"),
        (LINEAR + ' TransducerCenterPixel="1 1" TransducerWidthMm="-4" ImagingDepthMm="6"', "TransducerWidthMm must be positive"),
    ],
)
def test_a_scan_conversion_that_cannot_be_used_is_explained(refusal, attributes, expected):
    assert expected in refusal(f"<ScanConversion {attributes}/>")


# Files


def test_a_real_configuration_with_clip_and_fan(real_data):
    configuration = read_plus_configuration(real_data("SonixRP_TRUS_D70mm_NN_LATE.xml"))
    assert configuration.region == ImageRegion(ClipRectangle((192, 16), (420, 580)), Fan((380, 20), (-45, 45), (120, 360)))
    assert (configuration.method, configuration.spacing, configuration.warnings) == ("latest", (0.5, 0.5, 0.5), ())
    assert list(map(str, configuration.transforms)) == ["ImageToProbe", "PhantomToReference"]


def test_a_real_configuration_with_a_linear_probe(real_data):
    configuration = read_plus_configuration(real_data("BoneUltrasound_L14_config.xml"))
    assert configuration.probe == ProbeGeometry("linear")
    assert configuration.scan_region.clip.bounds(820, 616) == (175, 645, 0, 615)
    assert configuration.method == "average"


@pytest.mark.parametrize("name", ["SpinePhantom_NN_MEAN.xml", "SpinePhantom_LN_MAXI.xml"])
def test_the_real_spine_configurations_have_their_calibration(real_data, name):
    assert TransformName("Image", "Probe") in read_plus_configuration(real_data(name)).transforms


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (b"", "not well-formed"),
        (b"<PlusConfiguration>", "not well-formed"),
        (b"hello", "not well-formed"),
        (b"\x00\x01", "not well-formed"),
        (b"<Other/>", "must be PlusConfiguration; got Other"),
        (b"<!DOCTYPE a [<!ENTITY b 'c'>]><PlusConfiguration/>", "DOCTYPE"),
        ('<?xml version="1.0" encoding="UTF-16"?><!DOCTYPE a><PlusConfiguration/>'.encode("utf-16"), "DOCTYPE"),
        (b'<?xml version="1.0" encoding="no-such"?><PlusConfiguration/>', "encoding"),
        (b"<a>" * 100_000, "nested"),
        (b" " * 20_000_000, "larger than"),
    ],
)
def test_a_file_that_is_no_configuration_is_refused(tmp_path, content, expected):
    path = tmp_path / "plus.xml"
    path.write_bytes(content)
    with pytest.raises(ConfigurationError, match=expected) as caught:
        read_plus_configuration(path)
    assert str(caught.value).startswith(f"{path}: ")


def test_a_missing_configuration_is_named(tmp_path):
    with pytest.raises(ConfigurationError, match="no such file"):
        read_plus_configuration(tmp_path / "plus.xml")
