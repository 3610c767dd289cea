<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="en_US" sourcelanguage="en_US">
<context>
    <name>AIFRecon</name>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source> m/s</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source> mm</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source> px</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source> s</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFRecon.py"/>
        <source>AIFRecon: Angle-weighted Ultrasound Reconstruction</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Added to the time stamps of the images, as Plus's LocalTimeOffsetSec: negative where images come late, positive where poses do. Counts when a recording is loaded.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Advanced: bone map</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Advanced: holes and outputs</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Advanced: image and probe</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Advanced: method</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Advanced: reading the file</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>All files (*)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Alpha:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Also output how many pixels met in each voxel</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Also output the best cosine of incidence of each voxel</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Also output the sum of weights of each voxel</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Also output which voxels are measured, filled or empty</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Also output:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Also write every frame, tracked or not, to this sequence file. Leave empty to record nothing.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Apex column</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Apex row</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Apex:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Apply</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Back to the reconstruction</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Begin to receive and reconstruct</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Best cosine</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Beta:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Bone gain:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Bone:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Box to reconstruct; it may be rotated</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Box:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Brightest value an image can hold</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Brightest value:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>CT and bone</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>CT:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Choose a recording first</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Clip rectangle, first column</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Clip rectangle, first row</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Clip rectangle, height</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Clip rectangle, width</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Clip rectangle:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Column of the virtual apex, where the beams of a sector probe meet</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFRecon.py"/>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Compare methods</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Configuration:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Copy</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Copy the report as text</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Create a new volume</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Darkest pixel:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Direction:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Display</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Distance between voxels</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Draw the outlines of the frames of the sweep in the 3D view</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Draw the sector of the probe and some of its beams on the current frame: beams that do not run along the image show a wrong apex</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Each pixel enters its nearest voxel, or spreads linearly over the eight around it (average, latest and maximum only)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Empty the volume and go on</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Empty voxels are filled up to this distance from a measured one</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>End the scan and keep its volume</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Engine:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Every N-th frame:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Fan angles:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Fan radii:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Fan, first angle</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Fan, larger radius</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Fan, last angle</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Fan, smaller radius</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Frame outlines</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Hits</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Hole filling:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Hole limit:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>How empty voxels within the limit are filled: nearest measured value; or as Plus does it, mean of the nearest cube, gaussian average, or sticks that bridge gaps. Automatic: as configured, else nearest.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>How holes are filled, and what else is kept</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>How pixels that meet in a voxel are combined</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>How the file stores its pixels: MF, MN, UF or UN as Plus calls them. Automatic: as the file says. Counts when a recording is loaded.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>How the map of expected bone is made</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>How the reconstruction is shown</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>How well the sweep was tracked: frames used and skipped, gaps, jumps, speed, and coverage of the volume</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Image device:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Image node:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Image of the scene that something else keeps up to date, such as OpenIGTLinkIF or the replay of a sweep</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Images (*.png *.tif *.bmp *.jpg)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Images:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Importance mask:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>In 3D:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Insert nothing until pressed again</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Interpolation:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Like volume:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Live</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Load a recording</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFRecon.py"/>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Load recording</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFRecon.py"/>
        <source>Loaded {name}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Longest gap:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Look for bone in the sweep</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Map width:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Mask</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Method</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Method:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Name of the image that the server sends</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Name or address of the OpenIGTLink server</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>None</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>None (no weighting by incidence)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Only this fan about the apex is ultrasound: its angles, from straight down toward the right</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Only this fan about the apex is ultrasound: its first angle, from straight down toward the right</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Only this fan about the apex is ultrasound: its larger radius; 0 leaves the fan to the configuration and the images</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Only this fan about the apex is ultrasound: its last angle, from straight down toward the right</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Only this fan about the apex is ultrasound: its radii</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Only this fan about the apex is ultrasound: its smaller radius</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Only this rectangle of the image is ultrasound: first column and row, width and height</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Only this rectangle of the image is ultrasound: its first column</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Only this rectangle of the image is ultrasound: its first row</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Only this rectangle of the image is ultrasound: its height; 0 leaves it to the configuration and the images</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Only this rectangle of the image is ultrasound: its width; 0 leaves it to the configuration and the images</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Opacity of the reconstruction over the CT in the slice views</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Opacity over CT:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Other volumes to output beside the intensities</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Output volume:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Pause</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Pixels darker than this gray level do not enter</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Plus configuration (*.xml)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Plus configuration with the calibration (PlusDeviceSet .xml). Leave empty if the recording holds every transform.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Port of the OpenIGTLink server; Plus uses 18944</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Port of the server</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Probe and beams</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Probe:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Read a recording with its poses, their statuses and the orientation of its images</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Reconstruct in the box around what was scanned so far</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Reconstruct while scanning</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Reconstruct with each method and show the results side by side</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFRecon.py"/>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Reconstruction</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Reconstruction region</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFRecon.py"/>
        <source>Reconstructs a volume of the spine from tracked ultrasound frames, weighting every beam by its angle of incidence to the bone that a registered CT shows. Research software, not a medical device.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Reconstructs the sweep with each method, shows the results in linked slice views side by side, and measures how well each shows bone.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Record to:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Recording:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Region:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Registered CT, shown beneath the reconstruction. Its transform places it; it is never changed.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Reset</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Row of the virtual apex; negative above the image</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Scanner's speed:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Score</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Segments that are bone</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Segments:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Select a sweep first</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Select or load a sweep</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Sequence browser with the ultrasound images and the transforms that place them</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Server:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Shape of the beams: recognized in the images or taken from the configuration, or set by hand</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Show the output volume over the CT in the usual slice views again</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Show the reconstruction in the 3D view</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Smoothing of the bone map</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Source:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Spacing:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Speed of sound that the scanner assumes; matters with the true one alone</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Speed of sound:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Start</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Stop</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Stored pixels:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Sweep</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFRecon.py"/>
        <source>The method is that of Jiang, Xu, Moghekar, Kazanzides and Boctor: Insonification Angle-based Ultrasound Volume Reconstruction for Spine Intervention.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFRecon.py"/>
        <source>The methods could not be compared.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>The only one</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>The parameters of the methods</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFRecon.py"/>
        <source>The recording could not be loaded.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>The tracked ultrasound frames that are reconstructed</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFRecon.py"/>
        <source>The volume could not be reconstructed.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Time offset:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Tracked frames recorded by Plus: a sequence metafile (.mha, .mhd) or NRRD file</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Tracked sequences (*.mha *.mhd *.nrrd)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Tracked sequences (*.mhd *.mha *.nrrd)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Tracked sweep:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Tracking report</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>True speed of sound, where it is not the scanner's: pixels move along their beams</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Type of the reconstructed voxels</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Unit of the smoothing: voxels of the segmentation (the paper: 10), or millimeters</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Unit of the width</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Use every N-th frame</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Use the scanned box</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Volume</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Volume rendering</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Volume that takes the result</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Volume whose voxels are reconstructed, for example the CT</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Voxel type:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Weight floor:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Weight of each pixel in an average: an 8-bit gray image as large as the frames, 0 does not count. Leave empty for none.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>What computes the volume; every engine gives the same voxels</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>What the file does not say, or says wrongly. Counts when the recording is loaded.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>What the images show, where it is not recognized or configured as it should be</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Where bone faces: gradient of the probability map (the paper), or of the smoothed bone surface</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Where bone is expected</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Where live images come from</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Where no bone is selected: take for bone what is bright with darkness behind it in the sweep itself</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Where the CT shows bone: a segmentation, a labelmap, or a volume of bone probability from 0 to 1. Its transform places it.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Where to reconstruct, and what takes the result</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Where to reconstruct: around the whole sweep, within a box, or on the voxels of a volume</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Which sequence of the sweep holds the ultrasound images. Leave open where there is only one.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>With a time offset, poses farther apart than this are not interpolated between. Counts when a recording is loaded.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>Without a CT:</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>aif methods: how much well-insonified bone is brightened</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>aif-compensated, weighted: smallest cosine of incidence that is compensated (0.1: beams up to 84.3 degrees)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>as configured</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>auto</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>by the type of the images</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>no correction</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>not started</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>off</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>the only one there is</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>weighted: how much bone that a frame shows and the map expects is brightened</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/Resources/UI/AIFRecon.ui"/>
        <source>weighted: weight of a pixel that shows no bone, against 1 of one that does</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>AIFReconGui.dependentWidgets</name>
    <message>
        <location filename="../../AIFRecon/AIFReconGui/dependentWidgets.py"/>
        <source>Read the recording into a sweep that can be replayed</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconGui/dependentWidgets.py"/>
        <source>Reconstruct the volume</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconGui/dependentWidgets.py"/>
        <source>Reconstruct with each method and show them side by side</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>AIFReconGui.livePanel</name>
    <message>
        <location filename="../../AIFRecon/AIFReconGui/livePanel.py"/>
        <source>Begin to receive and reconstruct</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconGui/livePanel.py"/>
        <source>Canceled: the volume is as it was shown last.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconGui/livePanel.py"/>
        <source>Failed: nothing is inserted</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconGui/livePanel.py"/>
        <source>Live reconstruction</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconGui/livePanel.py"/>
        <source>Paused</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconGui/livePanel.py"/>
        <source>Recorded to {path}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconGui/livePanel.py"/>
        <source>Scan once quickly, then use the box</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconGui/livePanel.py"/>
        <source>Stop the live scan first.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconGui/livePanel.py"/>
        <source>The box cannot be used yet.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconGui/livePanel.py"/>
        <source>The live reconstruction could not be ended as it should.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconGui/livePanel.py"/>
        <source>The live reconstruction could not be started.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconGui/livePanel.py"/>
        <source>latency {latency:.0f} ms</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconGui/livePanel.py"/>
        <source>no latency yet</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconGui/livePanel.py"/>
        <source>not started</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconGui/livePanel.py"/>
        <source>stopped</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconGui/livePanel.py"/>
        <source>{inserted} of {received} frames inserted</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconGui/livePanel.py"/>
        <source>{rate:.0f} frames/s, {latency}; {connection}</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>AIFReconGui.longWork</name>
    <message>
        <location filename="../../AIFRecon/AIFReconGui/longWork.py"/>
        <source>Canceled. Nothing was changed.</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>AIFReconGui.packages</name>
    <message>
        <location filename="../../AIFRecon/AIFReconGui/packages.py"/>
        <source>Live reconstruction needs the Python package pyigtl. Install it now?</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>AIFReconGui.reportPanel</name>
    <message>
        <location filename="../../AIFRecon/AIFReconGui/reportPanel.py"/>
        <source>Select a tracked sweep, or load a recording.</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>AIFReconGui.sampleData</name>
    <message>
        <location filename="../../AIFRecon/AIFReconGui/sampleData.py"/>
        <source>Lumbar phantom</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconGui/sampleData.py"/>
        <source>The lumbar phantom could not be made.</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>AIFReconLib</name>
    <message>
        <location filename="../../AIFReconLib/poses.py"/>
        <source>1 frame ({numbers})</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/importing.py"/>
        <source>A calibration holds the size of a pixel already. Leave out --spacing and --image-origin-px, or --calibration.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/region.py"/>
        <source>A fan stands about the apex of a sector probe, which is not known. Give --apex-px COLUMN ROW.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/region.py"/>
        <source>A fan takes both --fan-angles-deg A B and --fan-radius-px R0 R1; got one of them.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/decoding.py"/>
        <source>A live stream needs the Python package pyigtl, which is not installed: pip install pyigtl</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/framing.py"/>
        <source>A message ({message}) declares {size} bytes, more than the limit of {limit}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/framing.py"/>
        <source>A message ({message}) has a wrong checksum</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/study.py"/>
        <source>A process of the study was ended from outside, for memory most likely, after {done} of {count} patients. Run it again with fewer --jobs; it goes on where it stopped.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/compounding/reconstructor.py"/>
        <source>A sector's speed of sound is corrected for by the slower numpy engine. The voxels are the same.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/memory.py"/>
        <source>A spacing of {spacing:g} mm would fit.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/compounding/reconstructor.py"/>
        <source>A speed of sound needs the direction of the beams. Give --probe linear, or --probe sector with --apex-px COLUMN ROW.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/memory.py"/>
        <source>A volume of {size} voxels ({spacing} mm) needs {needed} of memory, and {usable} can be used. {advice}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/nrrd_header.py"/>
        <source>ASCII data are not supported</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/sequenceNodes.py"/>
        <source>Added the sweep</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/sequenceNodes.py"/>
        <source>Adding transforms</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/compounding/splat_engine.py"/>
        <source>An importance mask weights an average, and does not fit {wish}. Leave it out, or choose method average.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/pose_rows.py"/>
        <source>Angles that are named by axis cannot be turned in the order {euler_order}, which has an axis twice. Give the angles without names, in the order of the turns (--columns with e0 e1 e2).</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>Area</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>Bias of peak</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metaimage_header.py"/>
        <source>BinaryData must be True: ASCII data are not supported. Write the file again as binary.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/sweep_bone.py"/>
        <source>Bone is looked for along the beams, whose directions are not known. Give --probe linear, or --probe sector with --apex-px COLUMN ROW.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>Bone surface that the numbers of this group are of.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/framing.py"/>
        <source>Bytes arrived that are no OpenIGTLink message</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>CNR</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/progress.py"/>
        <source>Canceled in this step: {step}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/figures.py"/>
        <source>Cannot draw a figure: matplotlib is not installed. Install it with: pip install matplotlib</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/recording.py"/>
        <source>Cannot record to {path}: {left} is there, from a recording that was not finished. Keep {file} and its .raw file under another name, or choose one.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metaimage_pair.py"/>
        <source>Cannot write {path}: a data file with a percent sign in its name would be read as a pattern of names. Choose another name.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/atomic.py"/>
        <source>Cannot write {path}: it is a device or a pipe. Give the name of a regular file.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/atomic.py"/>
        <source>Cannot write {path}: it is a folder. Give the name of a file.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/atomic.py"/>
        <source>Cannot write {path}: it is write-protected. Remove the protection, or choose another name.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/atomic.py"/>
        <source>Cannot write {path}: its files must lie in one folder, but one of them is a link. Remove the link.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/sequence_writer.py"/>
        <location filename="../../AIFReconLib/io/transform_files.py"/>
        <location filename="../../AIFReconLib/io/volume_files.py"/>
        <source>Cannot write {path}: its suffix must be one of {suffixes}. Choose another name.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/volume_files.py"/>
        <source>Cannot write {path}: the file came out incomplete. Check that the disk is not full.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/atomic.py"/>
        <source>Cannot write {path}: the file did not come about. Try again, or choose another folder.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/atomic.py"/>
        <source>Cannot write {path}: the folder {folder} does not exist. Create it, or choose another path.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/volume_files.py"/>
        <source>Cannot write {path}: volume files cannot hold {kind}. Convert the volume to another type.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/transform_files.py"/>
        <location filename="../../AIFReconLib/io/volume_files.py"/>
        <source>Cannot write {path}: {cause}. Check that the disk is not full, or choose another path.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/atomic.py"/>
        <source>Cannot write {path}: {problem}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/poses.py"/>
        <source>Choose another frame to reconstruct in with --reference, one of: {frames}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/sequence_edits.py"/>
        <source>Columns {x} to {last_x} and rows {y} to {last_y} were cut out. A configuration's clip rectangle, fan and transducer center are about the whole image: subtract {x} and {y} from them.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/offset_estimate.py"/>
        <source>Comparing images and poses</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/openigtlink.py"/>
        <source>Connected to {host}, port {port}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>Contrast</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>Contrast over the standard deviation of the tissue before the bone (Smith 1983). Speckle alone gives about 1.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>Coverage</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/dicom_images.py"/>
        <source>DICOM files</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>Detectability</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>Distance of peak</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/benchmark.py"/>
        <source>Done</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metaimage_header.py"/>
        <source>ElementDataFile must be LOCAL or one file; got {text!r}. Lists of files are not supported: write it again as one file.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile_volumes.py"/>
        <source>ElementSpacing must be positive; got {spacing}. Correct the header.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metaimage_header.py"/>
        <source>ElementType must be one of {kinds}; got {kind!r}. Convert the file to one of them.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/dicom_images.py"/>
        <location filename="../../AIFReconLib/io/pictures.py"/>
        <source>Export it again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/dicom_images.py"/>
        <source>Export it uncompressed, or install pylibjpeg[all].</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/hole_kinds.py"/>
        <location filename="../../AIFReconLib/holes.py"/>
        <source>Filled holes</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/hole_kinds.py"/>
        <location filename="../../AIFReconLib/holes.py"/>
        <source>Filling holes</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/visibility.py"/>
        <source>Finding the bone surface</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/visibility.py"/>
        <source>Followed the beams</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/visibility.py"/>
        <source>Following the beams</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/openigtlink.py"/>
        <source>For {seconds:.1f} s {seen}. Waiting; check {host}, and the network.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/visibility.py"/>
        <source>Found the bone surface</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/poses.py"/>
        <source>Give the calibration (for example {name}) with --config PlusDeviceSet.xml.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/poses.py"/>
        <source>Give the missing link with --config PlusDeviceSet.xml.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/benchmark.py"/>
        <source>Holes and bone</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/connection.py"/>
        <source>Host {host!r} cannot be found ({reason}). Check its name, or give its IP address.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/replay.py"/>
        <source>Host {host!r} cannot be found. Give 127.0.0.1, 0.0.0.0 or an address of this machine.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/openigtlink.py"/>
        <source>Host {host!r} was not found in {seconds:g} s. Check its name, or give its IP address.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/beams.py"/>
        <source>Input apex of a sector probe must be a column and a row; got {apex!r}. Give --apex-px COLUMN ROW.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/region.py"/>
        <source>Input clip rectangle must be X Y W H with W, H not negative; got {origin} {size}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/sequence_edits.py"/>
        <source>Input crop must lie within the image of {columns} x {rows} pixels; got X {x}, Y {y}, W {width}, H {height}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/simulation/phased_array.py"/>
        <source>Input depth must be 20 mm or more, apex_offset 0.5 or more; got {depth!r}, {apex_offset!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/bone.py"/>
        <source>Input direction must be {directions}; got {direction!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/surface.py"/>
        <source>Input distance to bone must change its sign somewhere; got no surface. Was the right volume chosen?</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/simulation/scan.py"/>
        <source>Input dropout must be 0 to below 1; got {dropout!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/compounding/engines.py"/>
        <source>Input engine must be auto or numpy where numba is not installed; got 'numba'. Install it: {command}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/compounding/engines.py"/>
        <source>Input engine must be auto or numpy: {reason}. Reinstall it: {command} --force-reinstall.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/pose_rows.py"/>
        <source>Input euler_order must be three axes, as xyz (fixed axes) or ZYX (axes that turn along); got {order!r}. See the tracker's manual.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/sequence_edits.py"/>
        <source>Input every must be 1 or more; got {every}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/region.py"/>
        <source>Input fan angles must differ and lie between -90 and 90 degrees; got {angles}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/region.py"/>
        <source>Input fan must have a finite apex and a positive pixel size; got {apex}, {pixel_size}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/region.py"/>
        <source>Input fan radii must be two rising, not negative numbers; got {radii}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/sequence_writer.py"/>
        <source>Input field name must be one line without = : # or a backslash, not empty; got {name!r}. Rename the field.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/sequence_writer.py"/>
        <source>Input field name must not be a key of the file format; got {name!r}. Rename the field.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/sequence_fields.py"/>
        <source>Input field {name!r} of frame {number} must have a name, and not that of a time, status or transform. Set those in the record.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/sequence_writer.py"/>
        <source>Input field {name} must have a value of one short line of text; got {value!r}. Change the value.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/simulation/phased_array.py"/>
        <source>Input field_of_view_deg must be 20 to 120; got {angle!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/pose_interpolation.py"/>
        <source>Input fraction must be from 0 to 1; got {fraction!r}. Poses are not extrapolated.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/simulation/scan.py"/>
        <source>Input frames must be 1 or more; got {frames!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/simulation/scan.py"/>
        <source>Input frames must be 2 or more; got {frames!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/simulation/scan.py"/>
        <source>Input frames must be at least one per pair of tilts ({count}); got {frames!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/sequence_edits.py"/>
        <source>Input frames must be two numbers from 0 to {largest}, rising; got {first} {last}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/volume.py"/>
        <source>Input grid must have at most {maximum} voxels; got {columns} x {rows} x {slices}. Choose a larger spacing.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/volume.py"/>
        <source>Input grid must have its axes at right angles; got a sheared one. Resample the volume first.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/volume.py"/>
        <source>Input grid size must be 3 positive whole numbers of voxels; got {size!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/sequence_fields.py"/>
        <source>Input header field {name!r} must not have the name of a transform or of a frame's field. Set it where it belongs.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/replay.py"/>
        <source>Input header_version must be 1 or 2; got {header_version!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/configured.py"/>
        <source>Input hole_limit must be above 0 mm to fill holes by {holes}; got 0. Give --hole-limit MM.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/openigtlink.py"/>
        <source>Input host must be a host name or an IP address; got {host!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/sequence_writer.py"/>
        <source>Input image of frame {index} must have shape {shape}; got {found}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/visibility.py"/>
        <source>Input image_to_reference must be finite; got frames without a pose. Leave those out.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/visibility.py"/>
        <source>Input image_to_reference must have shape (frames, 4, 4); got {shape}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/compounding/image_kind.py"/>
        <source>Input images must all be alike; got {shape} {kind} in frame {number} after {first_shape} {first_type}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/imported_images.py"/>
        <source>Input images must be at least one file. Name pictures, a folder, a video or a .npy file.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/compounding/image_kind.py"/>
        <source>Input images must be gray, rows x columns of numbers; got {shape} {kind} in frame {number}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/sequence_writer.py"/>
        <source>Input images must be whole numbers of 8 to 64 bits, float32 or float64; got {kind}. Convert them.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/sequence_writer.py"/>
        <source>Input images must have shape (frames, rows, columns), none of them 0; got {shape}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/compounding/splat_engine.py"/>
        <source>Input importance mask must be as large as the images, {columns} x {rows}; got {got}. Make it anew.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/compounding/splat_engine.py"/>
        <source>Input interpolation must be nearest for {wish}; got 'linear'. Leave it out, or choose method {methods}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/simulation/anatomy.py"/>
        <source>Input irregularity must be 0 to 2; got {irregularity!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/hole_kinds.py"/>
        <source>Input kind of hole filling must be one of {kinds}; got {kind!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/surface.py"/>
        <source>Input labels must have voxels above 0 and voxels of 0; got only one kind. Was the right segmentation chosen?</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/bone.py"/>
        <source>Input labels must have voxels above 0; got none. Was the right segmentation chosen?</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/bone.py"/>
        <source>Input labels must leave voxels that are not bone; got bone everywhere. Was the right segmentation chosen?</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/openigtlink.py"/>
        <source>Input limits and times of a client must be positive, and retry_delays must not be empty.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/simulation/phased_array.py"/>
        <source>Input lines, samples, columns and rows must each be 16 or more.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/time_offset.py"/>
        <source>Input longest_gap must be above 0 s; got {longest_gap!r}. Give it in seconds.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/metrics.py"/>
        <source>Input mask must have the voxels of the volume; got others. Give the mask of this reconstruction.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/transforms.py"/>
        <source>Input matrix must be invertible; got a singular matrix.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/hole_kinds.py"/>
        <source>Input number of sticks must be at least 1; got {sticks!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/orientation.py"/>
        <source>Input orientation must be MF, MN, UF or UN; got {code!r}. Say which way the stored pixels run.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/simulation/scan.py"/>
        <source>Input orientation must be transverse or sagittal; got {orientation!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/connection.py"/>
        <source>Input port must be a whole number from {lowest} to 65535; got {port!r}. Plus listens on 18944.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/pose_interpolation.py"/>
        <source>Input pose must hold finite numbers; got NaN or infinity.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/extent.py"/>
        <source>Input poses must be at least one; got none.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/pose_interpolation.py"/>
        <source>Input poses must both be mirrored, or neither; got one of each. Check the transforms.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/bone.py"/>
        <source>Input probability must be 0 to 1; got values up to {largest:g}. Divide it by its largest possible value, or give labels with --bone-labels.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/beams.py"/>
        <source>Input probe must be linear or sector; got {kind!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/pose_rows.py"/>
        <source>Input quaternion_order must be xyzw or wxyz; got {quaternion_order!r}. See the tracker's manual.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/replay_frames.py"/>
        <source>Input rate must be above 0 and at most {highest:g} frames/s; got {rate!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/importing.py"/>
        <source>Input rate must be above 0 frames per second; got {rate!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/hole_kinds.py"/>
        <source>Input ratio of known voxels must be 0 to 1; got {known_ratio!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/sequence_edits.py"/>
        <source>Input rename {old}={new} must be two transforms (AToB=CToD) or two frames (A=B).</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/sequence_edits.py"/>
        <source>Input rename {old}={new} must give names that are free; there would be two of {twice}. Choose another name.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/sequence_edits.py"/>
        <source>Input rename {old}={new} must name a frame of the recording; it has {frames}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/sequence_edits.py"/>
        <source>Input rename {old}={new} must name a transform of the recording; it has {there}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/bone.py"/>
        <source>Input sigma must be positive; got {sigma}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/hole_kinds.py"/>
        <source>Input size of hole filling must be 1 to {largest} voxels; got {size!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/simulation/anatomy.py"/>
        <source>Input spacing must be 0.2 to 3 mm; got {spacing!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/settings.py"/>
        <source>Input spacing must be one number or three (x y z); got {count}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/gridNodes.py"/>
        <source>Input spacing must be positive mm; got {spacing!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/importing.py"/>
        <source>Input spacing must be two numbers above 0, in mm per pixel; got {spacing!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/simulation/anatomy.py"/>
        <source>Input spinous_length must leave 5 mm under the skin; got {spinous_length:g} with skin_to_lamina {skin_to_lamina:g}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/hole_kinds.py"/>
        <source>Input standard deviation of hole filling must be above 0 voxels; got {stdev!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/inputs.py"/>
        <source>Input sweep must be a sequence browser; got none. Load a recording or select a sweep.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/threads.py"/>
        <source>Input threads must be at least 1; got {threads!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/simulation/scan.py"/>
        <source>Input tilts must be within 60 degrees; got {in_plane!r}, {elevational!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/pose_interpolation.py"/>
        <source>Input time must lie within the samples ({span}); got {time:.3f} s. Poses are not extrapolated.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/time_offset.py"/>
        <source>Input time_offset must be within {limit:g} s; got {time_offset!r}. Give it in seconds.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/simulation/scan.py"/>
        <source>Input tracking errors must be finite and not negative; got {errors}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/transform_graph.py"/>
        <source>Input transform name must be FromToTo, with one 'To' before an upper-case letter or a digit (as in ProbeToTracker); got {text!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/sequence_fields.py"/>
        <source>Input transform {name} must be named FromToTo, with one 'To' before an upper-case letter or a digit. Rename its frames.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/sequence_fields.py"/>
        <source>Input transform {name} must have shape (4, 4); got {shape}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/pose_rows.py"/>
        <source>Input units must be deg or rad, and mm, cm or m; got {angle_unit!r} and {length_unit!r}. See the tracker's manual.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/simulation/anatomy.py"/>
        <source>Input vertebrae must be 2, 3 or 4; got {vertebrae!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/volume.py"/>
        <source>Input volume array must have shape (k, j, i); got {shape}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/sliceDisplay.py"/>
        <source>Input volumes must be 1 to {most}; got {count}. Choose which to compare.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/settings.py"/>
        <source>Input {name} must be True or False; got {value!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/settings.py"/>
        <source>Input {name} must be a finite number; got {value!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/settings.py"/>
        <source>Input {name} must be a whole number; got {value!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/settings.py"/>
        <source>Input {name} must be at least {minimum:g}{unit}; got {value!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/settings.py"/>
        <source>Input {name} must be at most {maximum:g}{unit}; got {value!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/synchronizer.py"/>
        <source>Input {name} must be from {least:g} to 60 s; got {value!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/transforms.py"/>
        <source>Input {name} must be invertible; got a singular matrix.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/settings.py"/>
        <source>Input {name} must be one of {choices}; got {value!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/simulation/anatomy.py"/>
        <source>Input {name} must be {low:g} to {high:g}; got {value!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/transforms.py"/>
        <source>Input {name} must have 0 0 0 1 as its last row; got {row}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/transforms.py"/>
        <source>Input {name} must have 16 numbers (4 rows of 4); got shape {shape}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/transforms.py"/>
        <source>Input {name} must have 16 numbers (4 rows of 4); got {values!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/transforms.py"/>
        <source>Input {name} must hold finite numbers; got NaN or infinity.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/transforms.py"/>
        <source>Input {name} must hold numbers of at most {limit:g}; got {largest:g}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/sequence_fields.py"/>
        <source>Input {name} of frame {number} must be a finite number; got {time!r}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metaimage_header.py"/>
        <source>Kinds must have {dimensions} words, one for each of NDims; got {kinds!r}. Correct the header.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/sequenceNodes.py"/>
        <source>Loading frames</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/sweep_bone.py"/>
        <source>Looked for bone in the sweep</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/reconstruction.py"/>
        <source>Looking at the sweep</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/sweep_bone.py"/>
        <source>Looking for bone in the sweep</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/bone.py"/>
        <source>Made the bone map</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/bone.py"/>
        <source>Making the bone map</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/threeDViews.py"/>
        <source>Making the surface of bone</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>Mean distance of the peak from the true surface, where covered.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>Mean in shadow</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>Mean over standard deviation in {block:g} mm cubes of soft tissue, {away:g} mm and more from bone; median of the cubes (Burckhardt 1978). Averaging raises it.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>Mean response of bone (brightest value within {near:g} mm of the surface) less the mean of the tissue {before}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/metricsTable.py"/>
        <source>Measured</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/metricsTable.py"/>
        <source>Measuring {name}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>Median full width at half maximum along the normal (Leotta and Martin 1999), over the covered surface only: read it together with coverage.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/compounding/reconstructor.py"/>
        <source>Method {method}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/compounding/reconstructor.py"/>
        <source>Method {method} needs the direction of the beams. Give --probe linear, or --probe sector with --apex-px COLUMN ROW.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/session.py"/>
        <source>Method {method} needs to know where bone is. Give labels or a bone probability, or choose method average.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/importing.py"/>
        <source>No pose names one of the images: poses name {pose}, images are {image}. Use the same names.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/memory.py"/>
        <source>No spacing would fit: free some memory.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/transform_graph.py"/>
        <source>No transform leads from {source} to {target}. Known transforms: {known}. {source} is connected to {near_source}, {target} to {near_target}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>Noise and clutter where no beam could reach, {away:g} mm and more from the surface.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/scouting.py"/>
        <source>Not one tracked frame was seen yet. Check that the probe and the reference are visible, then scan.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metaimage_header.py"/>
        <source>ObjectType must be Image; got {kind!r}. Give an image file.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/volumeNodes.py"/>
        <source>Output must be a scalar volume; got the labelmap {node!r}. Choose or create another one.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/volumeNodes.py"/>
        <source>Output must be another volume than the inputs; got {node!r}. Choose or create another one.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/simulation/anatomy.py"/>
        <source>Phantom made</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/pictures.py"/>
        <source>Pictures</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/bone.py"/>
        <source>Placed the bone map</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/bone.py"/>
        <source>Placing the bone map</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/replay.py"/>
        <source>Port {port} is in use by another program, perhaps a PlusServer. Stop it, or choose another port (0 takes any free one).</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/replay.py"/>
        <source>Port {port} needs special rights. Choose one above 1023; Plus uses {plus_port}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/replay.py"/>
        <source>Port {port} on {host} cannot be served ({reason}). Choose another port.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/importing.py"/>
        <source>Pose {number} must be a rotation and a translation; it is {reason}. Check the columns, and whether the matrices are written row by row (else give --column-major).</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/time_offset.py"/>
        <source>Poses are those of {seconds:g} s after each image's time stamp</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/time_offset.py"/>
        <source>Poses are those of {seconds:g} s before each image's time stamp</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/reconstruction.py"/>
        <source>Preparing the volume</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>Probability that bone outshines an equally wide window of the tissue before it (Hanley and McNeil 1982). 0.5 is chance.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/benchmark.py"/>
        <source>Reading files</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/benchmark.py"/>
        <source>Real recordings</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/reconstruction.py"/>
        <source>Recognized in the images: {probe}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/reconstruction.py"/>
        <source>Reconstructed</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/benchmark.py"/>
        <location filename="../../AIFReconLib/reconstruction.py"/>
        <source>Reconstructing</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/recording.py"/>
        <source>Recording stopped: {cause} No frame was recorded.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/recording.py"/>
        <source>Recording stopped: {cause} {count} frames are kept in {path}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/numpy_images.py"/>
        <source>Save the array again with numpy.save.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/simulation/anatomy.py"/>
        <source>Shaping vertebra {name}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>Share of the surface with a peak within {near:g} mm that exceeds the tissue before it by {by:g} standard deviations. At interspinous borders: interspinous visibility (Xu 2022).</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/comparison.py"/>
        <source>Showing the volumes</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/simulation/anatomy.py"/>
        <source>Simulating the CT</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/simulation/scan.py"/>
        <source>Simulating ultrasound frames</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/tracking_report.py"/>
        <source>Skipped: {frames}: {reason}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/slicer_sequences.py"/>
        <source>Slicer's index of the frames is not a time ({unit}); frames are taken in the order of the file.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>Speckle SNR</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>Spread in shadow</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>Standard deviation there.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/simulation/scan.py"/>
        <source>Sweep simulated</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/importing.py"/>
        <source>The calibration must lead from {image_frame} to {first} or {second}; got {calibration}. Name it, as in --calibration {image_frame}To{first}=FILE.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/openigtlink.py"/>
        <source>The client was stopped.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/region.py"/>
        <source>The clip rectangle and fan leave no pixel of a {columns} x {rows} image. Check them against the image.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/configured.py"/>
        <source>The configuration's Interpolation=LINEAR is not used: it is for methods {methods}, and this is {method}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/configured.py"/>
        <source>The configuration's importance mask is not used: it is for an average, and the method is {method}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/openigtlink.py"/>
        <source>The connection was lost ({reason})</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/compounding/reconstructor.py"/>
        <source>The cosine of incidence</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/liveReconstruction.py"/>
        <source>The image that is kept up to date must be chosen; got none. Select it as Live image.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/importing.py"/>
        <source>The matrices of {name} hold the size of a pixel already. Leave out --spacing and --image-origin-px.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/pose_rows.py"/>
        <source>The order of the Euler angles is not known. Give --euler-order with the axes in the order in which the turns are applied: xyz about fixed axes, ZYX about the axes that turn along.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/pose_rows.py"/>
        <source>The order of the quaternion's numbers is not known. Give --quaternion-order xyzw or wxyz.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/tracking_report.py"/>
        <source>The pose jumps faster than a probe can move ({where}): was a marker seen wrongly, or its place changed?</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/pose_rows.py"/>
        <source>The poses must be 4x4 matrices (m00 to m33), or x y z with qx qy qz qw, or with rx ry rz; known columns: {there}. Name the columns with --columns, - for those that are not used.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/importing.py"/>
        <source>The poses must be of the time of the images; poses {poses}, images {images}. Make both start at 0.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/importing.py"/>
        <source>The poses must hold at least one that is valid; all {count} are missing. Export them again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/importing.py"/>
        <source>The poses name an image each, but the images are all in one file. Leave out that column (--columns, with -).</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/importing.py"/>
        <source>The poses of {name} are rigid, so they take millimeters, and the size of a pixel is not known. Give --spacing X Y in mm.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/detection.py"/>
        <source>The probe cannot be told from the images: {why}. Give --probe linear, or --probe sector with --apex-px COLUMN ROW; a configuration with ScanConversion serves too.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/poses.py"/>
        <source>The recording has no transforms at all: was a tracker connected? Slicer saves transforms as sequences of their own; give them with --transform-sequence NAME=FILE.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>The same with its sign; positive: toward the probe.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/openigtlink.py"/>
        <source>The server closed the connection</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/importing.py"/>
        <source>The size of a pixel alone does not say where the image lies in {frame}. Give --calibration FILE; or both --spacing and --image-origin-px, if the axes of the image are those of {frame}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/extent.py"/>
        <source>The sweep spans {spans} mm, which no scan does. Are its poses in mm and in the right frame?</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/sequence_files.py"/>
        <source>The volume nodes of this Slicer sequence have a geometry of their own, which the transforms of Image now include.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/importing.py"/>
        <source>There must be as many poses as images; got {poses} poses for {images} images. Leave out what is too much, name the image of each pose in a column 'image', or give times on both.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>Thickness</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/transform_graph.py"/>
        <source>Transform {name} cannot be set: it leads from a frame to itself. Remove it.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/transform_graph.py"/>
        <source>Transform {name} cannot be set: its inverse {inverse} is given already. Remove one of the two.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/transforms.py"/>
        <source>Transform {node!r} must be linear; got a warping one, which cannot place an image or a grid. Harden it onto the node that it moves, or replace it by a linear transform.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/sweepPoses.py"/>
        <source>Transform {transform!r} must be replayed by {browser!r}, as the images are; it is replayed by {other!r}. Add its sequence to the browser of the images (Sequences module, Synchronized nodes).</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/transform_graph.py"/>
        <source>Two paths lead from {source} to {target}: {one}; and {other}. Remove one of them, or take the recorded one with --image-to-reference {source}To{target}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/importing.py"/>
        <source>Two poses name the image {name} (poses {first} and {number}). Remove one of them.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/orientation.py"/>
        <source>UltrasoundImageOrientation must be MF, MN, UF or UN; got {code!r}. Correct the header: a wrong code mirrors the anatomy.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/orientation.py"/>
        <source>UltrasoundImageOrientation must be MF, MN, UF or UN; got {code!r}: whoever wrote the file did not know it. Look which side of the images is marked and say it with aifrecon convert --orientation: a wrong code mirrors the anatomy.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/orientation.py"/>
        <source>UltrasoundImageType must be {kinds}; got {kind!r}. Export B-mode frames from Plus.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/simulation/anatomy.py"/>
        <source>Vertebrae shaped</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/video_images.py"/>
        <source>Videos</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/compounding/reconstructor.py"/>
        <source>Warning: the bone map does not overlap the volume, so incidence weights nothing. Check the registration of the CT (--bone-transform).</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/compounding/image_kind.py"/>
        <source>Warning: weighted judges brightness against the full gray scale, which {kind} images do not tell. Give their brightest value with --intensity-maximum.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/compounding/image_kind.py"/>
        <source>Warning: {kind} images are written as uint8: values above 255 are cut off. Use --output-type float32.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/compounding/engines.py"/>
        <source>Warning: {reason}; the slower numpy engine was used. The voxels are the same.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/sequenceReader.py"/>
        <source>Will be skipped: {frames}: {reason}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/sequence_writer.py"/>
        <source>Writing {file}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/xml_attributes.py"/>
        <source>a finite number</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/framing.py"/>
        <source>a header ({have} of {whole} bytes)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/detection.py"/>
        <source>a linear probe, columns {left} to {right}, rows {top} to {bottom}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/atomic.py"/>
        <source>a part of its path is a file, not a folder. Choose another path.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/detection.py"/>
        <source>a sector probe, apex at column {column:.1f}, row {row:.1f}, {first:.1f} to {last:.1f} degrees</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/framing.py"/>
        <source>a {message} ({have} of {whole} bytes)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/framing.py"/>
        <source>an {message} ({have} of {whole} bytes)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/payload.py"/>
        <source>are corrupt ({problem})</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/file_images.py"/>
        <location filename="../../AIFReconLib/io/interleaved_images.py"/>
        <location filename="../../AIFReconLib/io/metafile.py"/>
        <location filename="../../AIFReconLib/io/metafile_volumes.py"/>
        <location filename="../../AIFReconLib/io/payload.py"/>
        <source>are cut short</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/nifti_payload.py"/>
        <source>are cut short: the header promises {needed} bytes, there are {length}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/payload.py"/>
        <source>are followed by bytes that do not belong to them</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/nifti_payload.py"/>
        <source>are missing, and part of the header too</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/nifti_payload.py"/>
        <source>are not in this file: it is the header of a pair, or an old Analyze file</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/nifti_payload.py"/>
        <source>are not those of a NIfTI file: it does not begin with 348 or 540</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/nifti_payload.py"/>
        <source>are of a type that is not read: {kind}, of {bits} bits</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/imported_images.py"/>
        <source>array</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/memory.py"/>
        <source>at most {memory}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/transform_sequences.py"/>
        <source>by time</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/nifti_payload.py"/>
        <source>cannot be told from the header: dimensions {count} {sizes}, {bits} bits, offset {offset}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/plus_reconstruction.py"/>
        <source>cannot be used. {problem}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/plus_config.py"/>
        <source>cannot be used. {problem} Repeat the calibration, or correct it.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/openigtlink.py"/>
        <location filename="../../AIFReconLib/live/sources.py"/>
        <source>connected</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/openigtlink.py"/>
        <source>connecting</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <location filename="../../AIFReconLib/tracking_report.py"/>
        <source>coverage</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/nrrd_header.py"/>
        <source>data file must be one file; got {text!r}. Lists of files are not supported: write it again as one file.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile.py"/>
        <source>data file {file} cannot be read ({reason}). Put it back beside the header.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile.py"/>
        <source>data file {file} has changed since it was opened. Read the file again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile.py"/>
        <source>data file {file} is missing. Put it beside the header.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>detectability</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/nrrd_header.py"/>
        <source>encoding must be raw or gzip; got {encoding!r}: {reason}. Write the file again with one of these.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/nrrd_header.py"/>
        <source>endian must be little or big; got {endian!r}. Correct the header.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/connection.py"/>
        <source>error {code}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/transform_sequences.py"/>
        <source>frame by frame, for lack of times</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/tracking_report.py"/>
        <source>frame to frame</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/file_images.py"/>
        <source>frame {number} cannot be read ({reason}). Copy the file again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/sequence_fields.py"/>
        <source>frame {number} has {name} twice, as {first} and {second}. Remove one of them from the header.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/sequence_fields.py"/>
        <source>frame {number}, </source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/tracking_report.py"/>
        <source>frames used</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/tracking_report.py"/>
        <source>frames {before} to {after}: {distance:.1f} mm in {seconds:.2f} s</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/payload.py"/>
        <source>go on behind the last frame or slice: the size in the header is wrong</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile.py"/>
        <source>go on behind their end</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/calibration_files.py"/>
        <location filename="../../AIFReconLib/io/transform_sequences.py"/>
        <source>got {count}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/transform_text.py"/>
        <source>has a line that is none of an ITK transform file: {line!r}. Save the transform from Slicer again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/plus_reconstruction.py"/>
        <source>has no effect with OutputExtent, which gives the box in voxels</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/plus_reconstruction.py"/>
        <source>has no effect without CompoundingMode=IMPORTANCE_MASK: all pixels count alike</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/plus_reconstruction.py"/>
        <source>has no effect without FanAnglesDeg, the widest angles to look within</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/plus_reconstruction.py"/>
        <source>has no effect: VolumeReconstruction has no such attribute. Check how it is spelled</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/plus_reconstruction.py"/>
        <source>has no effect: voxels are those of NONE, in double precision</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/transform_text.py"/>
        <source>has {key} that must be numbers; {problem}. Save the transform from Slicer again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/insertion.py"/>
        <source>image of another size or type</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/sweepPoses.py"/>
        <location filename="../../AIFReconLib/compounding/reconstructor.py"/>
        <location filename="../../AIFReconLib/poses.py"/>
        <source>image pose {problem}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/encoding.py"/>
        <source>images must have 1 to {limit} columns and rows; got {columns} x {rows}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>interspinous</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/transform_hdf5.py"/>
        <source>is damaged, or in a layout of HDF5 that is not read here. Save it from Slicer again, or as .tfm.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/plus_reconstruction.py"/>
        <source>is missing, and OutputExtent counts voxels. Add it to the element.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/plus_config.py"/>
        <source>is missing, and OutputImageSizePixel too. Add one of them.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/xml_attributes.py"/>
        <source>is missing. Add it to the element.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/transform_parts.py"/>
        <source>is missing: the file holds none. Save the transform from Slicer again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/plus_reconstruction.py"/>
        <source>is not honored without OutputExtent: the volume is the box around the sweep</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/plus_reconstruction.py"/>
        <source>is not honored: it has no HoleFillingElement. Give --hole-limit to fill empty voxels</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/video_images.py"/>
        <source>it ends after frame {number}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/video_images.py"/>
        <source>it ends within frame {number}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile_volumes.py"/>
        <source>it has a place but no space directions, so which way it lies is not known. Save the volume from Slicer again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/poses.py"/>
        <source>it has no frames</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/video_images.py"/>
        <source>it holds no frames</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/orientation.py"/>
        <source>it holds radio-frequency data (type {kind}, orientation {code}), which are not images. Export B-mode frames from Plus.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/atomic.py"/>
        <source>it is a folder. Give the name of a file.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile_volumes.py"/>
        <source>it must be a 3D volume; got {axes} axes in space. If it is a sequence of frames, give it as a sequence.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile_volumes.py"/>
        <source>it must be one 3D volume; got axes of the kinds {kinds}. Export one 3D volume.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/file_images.py"/>
        <source>its axes must be columns, rows and time; got the kinds {kinds}. Export the sequence from Plus or Slicer.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile.py"/>
        <source>its data file must lie beside it and be given by its bare name; got {file!r}. Move it there and correct the header.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/atomic.py"/>
        <source>its folder does not exist. Create the folder, or choose another path.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/interleaved_images.py"/>
        <source>its frames cannot be sorted ({reason}). Free some space on the disk.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/interleaved_images.py"/>
        <source>its frames must be 2D images of 1, 3 or 4 channels; got {shape} of {channels}. Save the sequence from a newer Slicer.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/file_images.py"/>
        <source>its images are 3D ({columns} x {rows} x {depth}), which is not supported: frames must be 2D. If this is a recording of 2D frames, the last of its kinds must be list; if it is a volume, give it as one.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/atomic.py"/>
        <source>its name is too long. Choose a shorter one.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/detection.py"/>
        <source>its outline is neither a rectangle nor a sector</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/detection.py"/>
        <source>its outline is not that of a sector</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/detection.py"/>
        <source>its sides do not enclose it</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/detection.py"/>
        <source>its sides do not spread downward</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/interleaved_images.py"/>
        <source>its sorted copy cannot be read ({reason}). Read the file again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/pose_history.py"/>
        <source>jumps</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/nrrd_header.py"/>
        <source>kinds must have {dimensions} words, one for each dimension; got {kinds!r}. Correct the header.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/session.py"/>
        <source>left out by --skip</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/pose_files.py"/>
        <source>line {line} (frame {number})</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/pose_files.py"/>
        <source>lines {first} to {last} (frame {number})</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/tracking_report.py"/>
        <source>longest gap</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/plus_reconstruction.py"/>
        <source>means 1, every frame: it must be at least that</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/compounding/splat_engine.py"/>
        <source>method {method}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/transform_parts.py"/>
        <source>must be 3D; got {dimensions} dimensions. Give a 3D transform.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/plus_reconstruction.py"/>
        <source>must be a file of this computer; got {name!r}. Copy it beside the configuration.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/plus_reconstruction.py"/>
        <source>must be first and last voxel along x, y and z, rising; got {got!r}. Correct it.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/transform_parts.py"/>
        <source>must be linear; got {kind}. Give a rigid or affine registration.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/xml_attributes.py"/>
        <source>must be of 32 bits; got {text!r}. Correct it.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/transform_parts.py"/>
        <source>must be of a kind of ITK, as AffineTransform_double_3_3; got {kind!r}. Save the transform from Slicer again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/transform_parts.py"/>
        <source>must be one, or several in a composite; got {count}. Save one of them.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/xml_attributes.py"/>
        <source>must be positive; got {numbers}. Correct it.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/xml_attributes.py"/>
        <source>must be whole; got {text!r}. Correct it.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/xml_attributes.py"/>
        <source>must be {choices}; got {text!r}. Correct it.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/xml_attributes.py"/>
        <source>must be {numbers}; got {text!r}. Correct it.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/xml_attributes.py"/>
        <source>must be {numbers}; {problem}. Correct it.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/plus_config.py"/>
        <source>must differ from From. Correct it.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/pose_rows.py"/>
        <source>must have 0 0 0 1 as its last row; got {row}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/pose_rows.py"/>
        <source>must have 0 0 0 1 as its last row; got {row}. They seem to be written column by column: give --column-major.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/pose_rows.py"/>
        <source>must have a quaternion of length 1; got {length:.4g}. Check which columns hold it.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/compounding/reconstructor.py"/>
        <source>no image</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/sequenceReader.py"/>
        <location filename="../../AIFRecon/AIFReconScene/sweepPoses.py"/>
        <location filename="../../AIFReconLib/poses.py"/>
        <source>no image ({status})</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/session_statistics.py"/>
        <source>no images</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/nrrd_header.py"/>
        <source>no other encoding is supported</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/compounding/reconstructor.py"/>
        <source>no pixel in the image is a finite number</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/compounding/reconstructor.py"/>
        <source>no pose</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/pose_interpolation.py"/>
        <source>no samples</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/imported_images.py"/>
        <source>no suffix</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/placement.py"/>
        <source>no transform leads from {source} to {target}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/slicer_sequences.py"/>
        <source>no unit</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/boneNodes.py"/>
        <location filename="../../AIFReconLib/io/calibration_files.py"/>
        <location filename="../../AIFReconLib/io/pose_rows.py"/>
        <location filename="../../AIFReconLib/io/transform_sequences.py"/>
        <location filename="../../AIFReconLib/sequence_edits.py"/>
        <location filename="../../AIFReconLib/tracking_report.py"/>
        <location filename="../../AIFReconLib/transform_graph.py"/>
        <source>none</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/connection.py"/>
        <source>not a host name</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/transforms.py"/>
        <source>not a pose (last row is not 0 0 0 1)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/transforms.py"/>
        <source>not a pose (numbers too large)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/transforms.py"/>
        <source>not finite</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/insertion.py"/>
        <source>not inserted after an error</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/transforms.py"/>
        <source>not rigid (mirrored)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/transforms.py"/>
        <source>not rigid (scaled or sheared)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/transform_graph.py"/>
        <source>nothing</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/openigtlink.py"/>
        <source>nothing arrived</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/openigtlink.py"/>
        <source>nothing arrived in the middle of {message}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/compounding/reconstructor.py"/>
        <source>nothing bright enough in the image</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/compounding/engines.py"/>
        <source>numba is installed but does not work ({kind}: {cause})</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>oblique CNR</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>oblique coverage</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/transform_parts.py"/>
        <source>of kind {kind} has numbers that ITK does not take. Save the transform from Slicer again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/transform_parts.py"/>
        <source>of kind {kind} must have {count} finite parameters and {fixed} fixed ones; got {parameters} and {others}. Save the transform from Slicer again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>off by mm</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/calibration_files.py"/>
        <source>one transform from {frame}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/openigtlink.py"/>
        <source>only bytes that are no message arrive</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/session_statistics.py"/>
        <source>other reasons</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/compounding/reconstructor.py"/>
        <source>outside the volume</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/session.py"/>
        <source>paused</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/encoding.py"/>
        <source>pixels must be integers of up to 32 bits or floats of 32 or 64; got {kind}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/file_images.py"/>
        <source>pixels must have 1 channel, or 3 or 4 (color); got {channels}. Convert the images to gray.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/tracking_report.py"/>
        <source>pose jumps</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/pose_files.py"/>
        <source>pose {number}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/tracking_report.py"/>
        <source>probe speed</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconGui/packages.py"/>
        <source>pyigtl is not installed, and live reconstruction needs it.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconGui/packages.py"/>
        <source>pyigtl was not installed, and live reconstruction needs it: {why}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/scouting.py"/>
        <source>seen while scouting</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>shadow</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/transforms.py"/>
        <source>sheared (image axes are not at right angles)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/transforms.py"/>
        <source>singular (a pixel has no size)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/insertion.py"/>
        <source>skipped to keep up</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/summary.py"/>
        <source>skipped: {frames}: {reason}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile_volumes.py"/>
        <source>space directions must be a vector for each axis in space, none for others; got {text!r}. Save the volume from Slicer again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/slicer_sequences.py"/>
        <source>space directions must be three vectors in left-posterior-superior; got {directions!r} in space {space!r}. Save the sequence from Slicer again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/slicer_sequences.py"/>
        <source>space directions or space origin cannot be used: {problem}. Save the sequence from Slicer again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile_volumes.py"/>
        <source>space must be left-posterior-superior, right-anterior-superior or left-anterior-superior; got {space!r}. Save the volume from Slicer again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile_volumes.py"/>
        <source>spacings must be positive; got {text!r}. Correct the header.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>speckle SNR</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/pose_history.py"/>
        <source>stale</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/plus_config.py"/>
        <source>states the relation that {other} states already. Remove one of the two.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/openigtlink.py"/>
        <location filename="../../AIFReconLib/live/sources.py"/>
        <source>stopped</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/compounding/splat_engine.py"/>
        <source>the cosine of incidence</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/atomic.py"/>
        <source>the disk does not answer. Choose a folder on another disk.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/recording.py"/>
        <source>the disk is full</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/atomic.py"/>
        <source>the disk is full. Free some space, or choose a folder on another disk.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/atomic.py"/>
        <source>the disk is read-only. Choose another folder.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/atomic.py"/>
        <source>the disk quota is used up. Free some space, or choose a folder on another disk.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/atomic.py"/>
        <source>the file would be larger than the system allows. Choose a larger spacing, or another disk.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/nrrd_header.py"/>
        <source>the header ends without the empty line before the data: the file is cut short. Copy it again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metaimage_header.py"/>
        <source>the header ends without {key}: the file is cut short or is no MetaImage. Copy it again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile.py"/>
        <source>the header has no {key}. It is damaged, or this is not an image file.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile.py"/>
        <source>the header is longer than {maximum} bytes. Give a MetaImage or NRRD file.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/atomic.py"/>
        <source>the network disk does not answer. Connect it again, or choose a folder on another disk.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/openigtlink.py"/>
        <source>the network failed</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile.py"/>
        <source>the pixel data are cut short: {size_key} {size} needs {needed} bytes, there are {there} ({complete} of {total} frames or slices). Copy the file again, or correct {size_key}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile.py"/>
        <location filename="../../AIFReconLib/io/metafile_volumes.py"/>
        <location filename="../../AIFReconLib/io/payload.py"/>
        <source>the pixel data cannot be read ({reason}). Copy the file again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/file_images.py"/>
        <source>the pixel data {problem}, in frame {number}. Copy the file again, or record it again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile_volumes.py"/>
        <location filename="../../AIFReconLib/io/payload.py"/>
        <source>the pixel data {problem}. Copy or write the file again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/interleaved_images.py"/>
        <source>the pixel data {problem}. Copy the file again, or save it from Slicer again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile.py"/>
        <source>the pixel data {what}: CompressedDataSize is {stored} bytes, there are {there}. Copy the file again, or write it again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile.py"/>
        <source>there are {excess} bytes more than {size_key} {size} needs ({needed}). Correct {size_key}, or write the file again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/atomic.py"/>
        <source>there is no permission to write there. Choose another folder, or close programs that hold the file open.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/detection.py"/>
        <source>they are lit from side to side, with no black surround that would show an outline</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>thickness mm</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metaimage_header.py"/>
        <source>this is not a MetaImage header: a line is not 'Key = value'. Give a MetaImage or NRRD file.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile.py"/>
        <source>this is not a text header. Give a MetaImage or NRRD file.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/nrrd_header.py"/>
        <source>this is not an NRRD file: it does not begin with NRRD0001 to NRRD0005. Give a MetaImage or NRRD file.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/nrrd_header.py"/>
        <source>this is not an NRRD header: a line is neither 'field: value' nor 'key:=value'. Copy the file again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/atomic.py"/>
        <source>too many files are open. Close other programs.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/atomic.py"/>
        <source>too many files are open. Raise the limit on open files (ulimit -n).</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/session_statistics.py"/>
        <source>tracked</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/plus_config.py"/>
        <location filename="../../AIFReconLib/transform_graph.py"/>
        <source>transform {name}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/placement.py"/>
        <source>two ways lead from {source} to {target}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/nrrd_header.py"/>
        <source>type must be a whole-number or floating-point type; got {kind!r}. Convert the file.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/imported_images.py"/>
        <source>video</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/openigtlink.py"/>
        <source>waiting to reconnect</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/imported_images.py"/>
        <source>{columns} x {rows} pixels, {kind}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/openigtlink.py"/>
        <source>{count} bytes that belong to no message were skipped; the stream is in order again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/xml_attributes.py"/>
        <source>{count} finite numbers</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/poses.py"/>
        <source>{count} frames ({numbers})</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/message_queue.py"/>
        <source>{count} messages were left out, the oldest first: they arrive faster than they are worked on.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/study.py"/>
        <source>{done} of {count} patients done</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/summary.py"/>
        <source>{done}, in {seconds:.1f} s</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/openigtlink.py"/>
        <source>{ended} in the middle of {message}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/transform_sequences.py"/>
        <location filename="../../AIFReconLib/pose_interpolation.py"/>
        <source>{first:.3f} to {last:.3f} s</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/quantities.py"/>
        <source>{first:g} to {last:g} mm before it</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/file_images.py"/>
        <source>{frames} frames of {columns} x {rows} pixels are beyond the limits ({maximum} frames, {maximum_bytes} bytes in each). The size in the header is wrong, or the recording must be split.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/interleaved_images.py"/>
        <source>{frames} frames of {columns} x {rows} pixels are beyond the limits. The size in the header is wrong.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/connection.py"/>
        <source>{host} cannot be reached. Check the network, and that the machine is on.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/connection.py"/>
        <source>{host} does not answer on port {port} within {timeout:g} s. Check that the machine is on, that it is on this network, and that its firewall admits the port.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/connection.py"/>
        <source>{host} has no server on port {port}. Start the server there (PlusServer), and check the port in its configuration.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/replay.py"/>
        <source>{host} is no address of this machine. Give 127.0.0.1, 0.0.0.0 or one of its addresses.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/connection.py"/>
        <source>{host}, port {port}, cannot be connected to ({reason}). Check host and port.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/slicer_sequences.py"/>
        <source>{key} belongs to frame {number}, but there are only {count} frames. Save the sequence from Slicer again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/sequence_fields.py"/>
        <source>{key} belongs to frame {number}, but there are only {frames} frames (0 to {last}). Correct DimSize.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile.py"/>
        <source>{key} is given twice, as {first!r} and as {second!r}. Remove one of the two lines from the header.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile.py"/>
        <source>{key} must be 0 where pixels are compressed or follow the header; got {text!r}. Write the file again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile_volumes.py"/>
        <source>{key} must be 3 numbers, as (1,0,0); got {text!r}. Correct the header.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metaimage_header.py"/>
        <source>{key} must be True or False; got {text!r}. Correct the header.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile.py"/>
        <source>{key} must be a whole number from {lowest} to {highest}; got {text!r}. Such files are not supported.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/slicer_sequences.py"/>
        <source>{key} must be finite times. Save the sequence from Slicer again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile.py"/>
        <source>{key} must be positive; got {text!r}. The file holds no image: record or export it again, or, if it is Slicer's sequence of a transform, give it with the images as --transform-sequence NAME=FILE.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/slicer_sequences.py"/>
        <source>{key} must be times; {problem}. Save the sequence from Slicer again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile_volumes.py"/>
        <source>{key} must be {count} finite numbers; got {text!r}. Correct the header.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile.py"/>
        <source>{key} must be {count} whole numbers; got {text!r}. The header is damaged.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/slicer_sequences.py"/>
        <source>{key} must have one value per frame ({frames}); got {count}. Save the sequence from Slicer again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/decoding.py"/>
        <source>{kind} message of {device!r}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/framing.py"/>
        <source>{kind} of {device}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/summary.py"/>
        <source>{measured}, {share:.1f}% filled</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/tracking_report.py"/>
        <source>{median:.1f} mm/s in the median, {most:.1f} mm/s at most</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/tracking_report.py"/>
        <source>{median:.2f} mm in the median, {most:.2f} mm at most</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/decoding.py"/>
        <source>{message} cannot be understood ({reason}); it is left out.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/decoding.py"/>
        <source>{message} holds {columns} x {rows} x {slices} pixels</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/decoding.py"/>
        <source>{message} holds {count} bytes, not {expected} for each tool. It is left out.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/decoding.py"/>
        <source>{message} holds {count} tools, more than {limit}. It is left out.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/configured.py"/>
        <source>{method} with cosines</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/summary.py"/>
        <source>{method}: {used} of {frames} frames into {size} voxels of {spacing} mm</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/session_statistics.py"/>
        <source>{name} comes too rarely</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/sweepStatus.py"/>
        <source>{name} is being recorded. Stop the recording to reconstruct it.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/poses.py"/>
        <source>{name} is in the recording and in the configuration; the recording's is used.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/importing.py"/>
        <source>{name} places the image itself, so there is no calibration to apply. Leave out --calibration.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/transform_sequences.py"/>
        <source>{name} was paired from {file} {how}: {good} of {count} frames.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/sweepImages.py"/>
        <source>{name}: item {number} has no pixels. Remove it from the sequence.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/sweepImages.py"/>
        <source>{name}: item {number} must be a 2D image; got {size} voxels. Choose a sequence of tracked 2D frames.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/sweepImages.py"/>
        <source>{name}: item {number} must have 1 channel, or 3 or 4 (color); got {channels}. Convert the images to gray.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/sequenceReader.py"/>
        <location filename="../../AIFReconLib/poses.py"/>
        <source>{name}: no frame can be placed ({reasons}). Check the tracking of this recording.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/sweepImages.py"/>
        <source>{name}: none of its {count} items holds an image. Choose the sequence of the images.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/nodeSource.py"/>
        <source>{node} must hold gray images of one slice; got {columns} x {rows} x {slices} pixels of {channels} values.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/boneNodes.py"/>
        <location filename="../../AIFRecon/AIFReconScene/gridNodes.py"/>
        <source>{node}: it has no voxels. Choose a volume that is loaded.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/boneNodes.py"/>
        <source>{node}: its segments cannot be made into voxels. Convert them to binary labelmaps in Slicer.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/boneNodes.py"/>
        <source>{node}: segments must be one or more of those there are ({names}); got {chosen}. Choose the bone.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/boneNodes.py"/>
        <source>{node}: the chosen segments are empty. Choose the segments that hold bone.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/gridNodes.py"/>
        <source>{node}: the region must be a box; got {size} mm. Place it or enlarge it.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/boneNodes.py"/>
        <source>{node}: voxels must have 1 value; got {channels}. Choose a scalar volume.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/dicom_images.py"/>
        <location filename="../../AIFReconLib/io/numpy_images.py"/>
        <location filename="../../AIFReconLib/io/video_images.py"/>
        <source>{path}, frame {number}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/dicom_images.py"/>
        <source>{path}, frame {number}: its pixels cannot be decoded</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/pictures.py"/>
        <source>{path}, page {page}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/dicom_images.py"/>
        <source>{path}: NumberOfFrames must be at most {maximum}; got {count}. Export it again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/volume_files.py"/>
        <source>{path}: SimpleITK cannot read it: {cause}. Export the volume again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/xml_tree.py"/>
        <source>{path}: a DOCTYPE declaration is not allowed in a configuration. Remove it.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/calibration_files.py"/>
        <source>{path}: a calibration must be 16 numbers, row by row; {wrong}. Give those, a Plus configuration (.xml) or a Slicer transform (.tfm).</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/importance_mask.py"/>
        <source>{path}: an importance mask must be an 8-bit gray image; got {found}. Convert it.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/importance_mask.py"/>
        <source>{path}: an importance mask must be one of {suffixes}. Save it as a PNG image.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/importance_mask.py"/>
        <source>{path}: an importance mask must have at most {maximum} pixels; got {size}. Give one as large as the ultrasound images.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/importance_mask.py"/>
        <source>{path}: an importance mask must have pixels above 0; got none. Draw what counts in white.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/xml_tree.py"/>
        <source>{path}: elements are nested more than {maximum} deep. Give a Plus configuration file.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/transform_sequences.py"/>
        <source>{path}: frame {frame}, Timestamp must be a number of seconds; got {text!r}. Save the transform sequence again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/transform_sequences.py"/>
        <source>{path}: frame {frame}, {field} must be 16 numbers; {wrong}. Save the transform sequence again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/numpy_images.py"/>
        <source>{path}: frame {number} cannot be read ({cause}). Copy the file again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/imported_images.py"/>
        <source>{path}: images must all be pictures, DICOM files, one video or one .npy array ({known}); got {suffixes}. Give files of one kind.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/video_images.py"/>
        <source>{path}: it cannot be decoded as a video ({cause}). Export it again, or its frames as pictures.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/dicom_images.py"/>
        <source>{path}: it cannot be read as DICOM</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/pictures.py"/>
        <source>{path}: it cannot be read as a picture</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/importance_mask.py"/>
        <source>{path}: it cannot be read as an importance mask: it is damaged or no PNG image. Save it again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/importance_mask.py"/>
        <source>{path}: it cannot be read as an importance mask: {cause}. Give a PNG image.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/pose_files.py"/>
        <source>{path}: it holds no poses. Give a file with one pose per frame.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/transform_sequences.py"/>
        <source>{path}: it holds no transforms per frame (no Seq_Frame fields). Give a sequence of transforms.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/evaluation/study.py"/>
        <source>{path}: it is no result of the study ({problem}). Delete it, and run the study again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/volume_files.py"/>
        <source>{path}: it must be a 3D volume; got {dimensions} dimensions. Export one 3D volume.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/pose_files.py"/>
        <source>{path}: it must hold a list of poses, or an object with one under {names}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/pose_files.py"/>
        <source>{path}: it must hold a list of poses; got {kind}. Export it again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/transform_sequences.py"/>
        <source>{path}: it must hold the transform {name}; got {there}. Name one of these, or give another file.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/calibration_files.py"/>
        <source>{path}: it must hold {wanted}; got {there}. Name one, as in --calibration ImageToProbe=FILE.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/itk_paths.py"/>
        <source>{path}: its name, or that of a folder, is not text in UTF-8. Rename it.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/volume_files.py"/>
        <source>{path}: its place in space cannot be used. {problem}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/plus_config.py"/>
        <source>{path}: its root element must be PlusConfiguration; got {found}. Give a Plus configuration file.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/transform_sequences.py"/>
        <source>{path}: its suffix must be .mha, .mhd or .nrrd. Save the transform sequence from Slicer as .seq.mha.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/volume_files.py"/>
        <source>{path}: its suffix must be one of {suffixes}. Export the volume in one of these formats.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile.py"/>
        <source>{path}: its suffix must be one of {suffixes}. Give a MetaImage or NRRD file; aifrecon import makes one of pictures, DICOM or video.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/transform_files.py"/>
        <source>{path}: its suffix must be one of {suffixes}. Save the transform from Slicer as one.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/xml_tree.py"/>
        <source>{path}: its text encoding is not supported ({problem}). Save it as UTF-8.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/volume_files.py"/>
        <source>{path}: its voxels must be real numbers; got complex ones. Export the magnitude.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/volume_files.py"/>
        <source>{path}: its voxels must be single labels; got {count} numbers each ({kind}). Export a label volume.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/volume_files.py"/>
        <source>{path}: its voxels must be single numbers; got {count} each ({kind}). Export a scalar volume.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile_volumes.py"/>
        <source>{path}: its voxels need {needed:.1f} GB of memory, and {available:.1f} GB are free. Resample it, or free some memory.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/volume_files.py"/>
        <source>{path}: labels must be whole numbers; got fractions or NaN. If these are bone probabilities, give them as --bone-probability.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/volume_files.py"/>
        <source>{path}: labels must not be negative; got {least}. If this is a CT, segment its bone first.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/pose_files.py"/>
        <source>{path}: line {line} (frame {number}) must have {expected} columns; got {found}. Export it again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/pose_files.py"/>
        <source>{path}: line {line} (frame {number}), column {name} must be a number; got {value!r}. Export it again, with decimal points.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/pose_files.py"/>
        <source>{path}: lines of four numbers must come in fours, one matrix each; got {count} lines. Export it again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/transform_sequences.py"/>
        <source>{path}: no pose of {name} (times {span}) fits the images ({first:.3f} to {last:.3f} s). Give the transform sequence that was recorded together with the images.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/browserItems.py"/>
        <source>{path}: none of its sequences holds images. Choose the browser of a tracked sweep.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/numpy_images.py"/>
        <source>{path}: numpy cannot read it</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/browserItems.py"/>
        <source>{path}: sequence {node!r} is not one of this browser's. Choose one of: {names}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/browserItems.py"/>
        <source>{path}: several of its sequences hold images. Choose one of: {names}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/numpy_images.py"/>
        <source>{path}: the array must have shape (frames, rows, columns) or (frames, rows, columns, 3); got {shape}. Transpose it.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/calibration_files.py"/>
        <source>{path}: the calibration cannot be used. {problem} Repeat the calibration, or correct it.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/small_files.py"/>
        <source>{path}: the file cannot be copied to be read ({reason}). Copy it to another disk, or free some space for temporary files.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/importance_mask.py"/>
        <location filename="../../AIFReconLib/io/metafile.py"/>
        <location filename="../../AIFReconLib/io/nifti_payload.py"/>
        <location filename="../../AIFReconLib/io/small_files.py"/>
        <location filename="../../AIFReconLib/io/transform_sequences.py"/>
        <source>{path}: the file cannot be read ({reason}). Check its permissions.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile.py"/>
        <source>{path}: the file cannot be read ({reason}). Check the path.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/small_files.py"/>
        <source>{path}: the file changed while it was read. Read it again when it is complete.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/numpy_images.py"/>
        <location filename="../../AIFReconLib/io/pictures.py"/>
        <source>{path}: the file has changed since it was opened. Import it again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/xml_tree.py"/>
        <source>{path}: the file is larger than {maximum} bytes. Give a Plus configuration file.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/calibration_files.py"/>
        <source>{path}: the file is longer than {maximum} bytes. A calibration is 16 numbers.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/transform_files.py"/>
        <source>{path}: the transform cannot be used. {problem} Save the transform from Slicer again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/transform_files.py"/>
        <source>{path}: the transform must be linear, and the file is longer than {maximum} bytes. Give a rigid or affine registration.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/transform_files.py"/>
        <source>{path}: the transform {problem}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/nifti_payload.py"/>
        <source>{path}: the voxels {problem}. Copy or export the file again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/imported_images.py"/>
        <source>{path}: there are no images in this folder. Give a folder of pictures or DICOM files.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/video_images.py"/>
        <source>{path}: there is no ffmpeg program ({cause}). Install it: pip install imageio-ffmpeg.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile.py"/>
        <source>{path}: there is no such file. Check the path.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/importance_mask.py"/>
        <source>{path}: there is no such file. Name an 8-bit gray image as importance mask.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/transform_sequences.py"/>
        <source>{path}: there must be as many samples of {name} as images, or times on both; got {samples} for {images} images. Give the transform sequence that was recorded together with the images.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/imported_images.py"/>
        <source>{path}: there must be one {what}; got {count} files. Import them one by one.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/dicom_images.py"/>
        <source>{path}: this DICOM file holds no image. Give the images of the sweep.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile.py"/>
        <source>{path}: this is a folder. Give the name of a file.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/numpy_images.py"/>
        <source>{path}: this is an archive of arrays. Save the one of the images with numpy.save.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/pose_files.py"/>
        <source>{path}: this is not JSON ({cause}). Export it again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile.py"/>
        <source>{path}: this is not a regular file. Give the name of a file.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/pose_files.py"/>
        <source>{path}: this is not a text file (UTF-8). Export the poses again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/pose_files.py"/>
        <source>{path}: this is not a text file of poses. Give .csv, .txt or .json.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/transform_files.py"/>
        <source>{path}: this is not an ITK transform file. Save the transform from Slicer as .tfm or .h5.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/xml_tree.py"/>
        <source>{path}: this is not well-formed XML ({problem}). Correct it, or give a Plus configuration file.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/browserItems.py"/>
        <source>{path}: this sequence browser has no items. Record or load a sweep first.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/pose_files.py"/>
        <source>{path}: {count} columns without names can be many things. Name them, as in --columns "time x y z qw qx qy qz", or give --quaternion-order or --euler-order, if translation comes first.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/transform_sequences.py"/>
        <source>{path}: {field} must belong to a frame below {maximum}. The header is damaged.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/plus_config.py"/>
        <source>{path}: {place} is missing, and CompoundingMode=IMPORTANCE_MASK needs it. Add it, or give an importance mask.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/pose_files.py"/>
        <source>{path}: {place} must be a number; got {value}. Export it again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/pose_files.py"/>
        <source>{path}: {place} must be {expected} numbers; got {found}. Export it again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/pose_files.py"/>
        <source>{path}: {place} must have the keys {expected}; got {found}. Export it again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/pose_files.py"/>
        <source>{path}: {place} must hold {expected} as the first; got {found}. Export it again.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/transform_sequences.py"/>
        <source>{problem} Give --transform-sequence NAME=FILE, e.g. ImageToReference=Transform.seq.mha.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/recording.py"/>
        <source>{problem} The recording is kept in {header} and its .raw file, and can be read there.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/session.py"/>
        <source>{problem} The recording is kept in {path} and its .raw file.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/openigtlink.py"/>
        <source>{problem}. It is left out; looking for the next message.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/imported_images.py"/>
        <source>{purpose} cannot be read without the Python package {package}. Install it: pip install {package}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/openigtlink.py"/>
        <source>{reason} Connecting again in {seconds:g} s.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/atomic.py"/>
        <source>{reason}. Choose another path.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/tracking_report.py"/>
        <source>{seconds:.2f} s, after frame {number}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/replay_frames.py"/>
        <source>{sequence} cannot be sent over OpenIGTLink: {problem}. Convert the recording.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/replay_frames.py"/>
        <source>{sequence} has no frames to replay. Choose another recording.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/replay_frames.py"/>
        <source>{sequence} has no recorded times to follow. Give the rate to replay it at (--rate).</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/poses.py"/>
        <source>{sequence}: Image and reference must be two frames; got {frame} for both.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/time_offset.py"/>
        <source>{sequence}: a time offset needs a time stamp for every frame, and they must differ. Leave out --time-offset, or record the sweep with time stamps.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/sequence_edits.py"/>
        <source>{sequence}: cropping moves the first pixel, so the calibration must move along, and the recording has none of {image_frame}. Give it with --config PlusDeviceSet.xml or --calibration FILE.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/sequenceNodes.py"/>
        <source>{sequence}: image {number} must have shape (rows, columns); got {shape}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/sequenceNodes.py"/>
        <source>{sequence}: it has no frames. Choose another recording.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/sequence_edits.py"/>
        <source>{sequence}: its {transform} includes the calibration that it was recorded with, which is not in the file. Give that too, with --wrong-calibration FILE.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/reconstruction.py"/>
        <source>{sequence}: no frame falls into the volume ({reasons}). Check its box (--grid-like, or the configuration's OutputOrigin and OutputExtent) and --reference.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/sweep_bone.py"/>
        <source>{sequence}: no frame shows bone, a bright echo with darkness behind it. Give --bone-labels, or no bone.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/reconstruction.py"/>
        <source>{sequence}: none of every {skip}th frames can be placed. Use a smaller --skip.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/summary.py"/>
        <source>{share:.1f}% of the voxels measured</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/time_offset.py"/>
        <source>{shift}; 1 frame has no pose then.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/time_offset.py"/>
        <source>{shift}; {count} frames have no pose then.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/metafile.py"/>
        <source>{size_key} {size} needs {needed} bytes, more than {there} compressed bytes can hold. Copy the file again, or correct {size_key}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/session_statistics.py"/>
        <source>{tools} not visible</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/poses.py"/>
        <source>{transform} not recorded</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/poses.py"/>
        <source>{transform} singular</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/sequenceReader.py"/>
        <source>{usable} of {frames} frames can be placed.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/tracking_report.py"/>
        <source>{used} of {frames}</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/decoding.py"/>
        <source>{what} of {channels} channels: there must be 1, or 3 or 4 (color). It is left out; send gray images.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/decoding.py"/>
        <source>{what}: frames must be 2D, of one slice. It is left out; send the 2D image of the scanner.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/live/decoding.py"/>
        <source>{what}: it is empty, and left out.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/sequence_fields.py"/>
        <source>{where} must be 16 numbers; got {count}. Correct the header, or remove the entry.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/sequence_fields.py"/>
        <source>{where} must be 16 numbers; {problem}. Correct the header, or set its status to INVALID.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/imported_images.py"/>
        <source>{where}: a frame must be an image of gray levels or colors; got shape {shape}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/imported_images.py"/>
        <source>{where}: every frame must have {expected} as the first; got {found}. Export all frames alike.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/imported_images.py"/>
        <source>{where}: pixels must be whole numbers or floats; got {kind}. Convert the images.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/imported_images.py"/>
        <source>{where}: {count} frames of {bytes} bytes are beyond the limits. Split the recording.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/sequence_fields.py"/>
        <source>{where}{name} is given twice, as {other} and as {second}. Remove one of them from the header.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/sequence_fields.py"/>
        <source>{where}{name} must be a number of seconds; got {text!r}. Correct the header, or remove the entry.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/compounding/reconstructor.py"/>
        <source>{wish} needs to know where bone is. Give labels or a bone probability, or choose method average.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFReconLib/io/text_values.py"/>
        <source>{word!r} is not a number</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>AIFReconScene.contradictions</name>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/contradictions.py"/>
        <source>An importance mask does not go with every method: leave the mask out to compare them.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/contradictions.py"/>
        <source>An importance mask weights an average: choose method average, or no mask.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/contradictions.py"/>
        <source>Bone is looked for at the depths that the images show: leave the speed of sound off, or select bone of the CT.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/contradictions.py"/>
        <source>Holes are filled up to the hole limit: set it above 0 mm, or set “Hole filling” to automatic.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/contradictions.py"/>
        <source>Linear interpolation does not go with every method: choose nearest to compare them.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/contradictions.py"/>
        <source>Linear interpolation does not go with {wish}: choose nearest, or another method.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/contradictions.py"/>
        <source>The fan's second angle and radius must be larger than the first. Correct them, or set the last radius to 0.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/contradictions.py"/>
        <source>The speed of sound must be off, or {low:g} to {high:g} m/s; it is {speed:g}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/contradictions.py"/>
        <source>There is no file {path}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/contradictions.py"/>
        <source>the best cosine</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>AIFReconScene.panelWords</name>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/panelWords.py"/>
        <source>Apex</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/panelWords.py"/>
        <source>Bone</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/panelWords.py"/>
        <source>Brightest value</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/panelWords.py"/>
        <source>Clip rectangle</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/panelWords.py"/>
        <source>Configuration</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/panelWords.py"/>
        <source>Every N-th frame</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/panelWords.py"/>
        <source>Fan angles</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/panelWords.py"/>
        <source>Fan radii</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/panelWords.py"/>
        <source>Hole limit</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/panelWords.py"/>
        <source>Importance mask</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/panelWords.py"/>
        <source>Its transforms lead to {frames}: put the one that leads farthest under a transform to the world, named for both.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/panelWords.py"/>
        <source>Longest gap</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/panelWords.py"/>
        <source>Look for bone in the sweep</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/panelWords.py"/>
        <source>Probe</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/panelWords.py"/>
        <source>Region</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/panelWords.py"/>
        <source>Spacing</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/panelWords.py"/>
        <source>Speed of sound</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/panelWords.py"/>
        <source>Stored pixels</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/panelWords.py"/>
        <source>The recording has no transforms at all: was a tracker connected? Slicer saves transforms as sequences of their own: load them too, and put the images under them.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/panelWords.py"/>
        <source>Time offset</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/panelWords.py"/>
        <source>Two paths lead from {source} to {target}: {one}; and {other}. Remove one of them.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/panelWords.py"/>
        <source>UltrasoundImageOrientation must be MF, MN, UF or UN; got {code!r}: whoever wrote the file did not know it. Look which side of the images is marked and choose it as “Stored pixels”: a wrong code mirrors the anatomy.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/panelWords.py"/>
        <source>Voxel type</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/panelWords.py"/>
        <source>the transform of the CT</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/panelWords.py"/>
        <source>{key} must be positive; got {text!r}. The file holds no image: record or export it again, or, if it is Slicer's sequence of a transform, load it with Slicer's own Add Data.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/panelWords.py"/>
        <source>{path}: labels must be whole numbers; got fractions or NaN. If these are bone probabilities, choose them as a scalar volume.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/panelWords.py"/>
        <source>{sequence}: no frame falls into the volume ({reasons}). Check the region, and the transforms of the sweep.</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>AIFReconScene.parameters</name>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/parameters.py"/>
        <source>Around the whole sweep</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/parameters.py"/>
        <source>Image in the scene</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/parameters.py"/>
        <source>Linear</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/parameters.py"/>
        <source>On the voxels of a volume</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/parameters.py"/>
        <source>OpenIGTLink server (Plus)</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/parameters.py"/>
        <source>Sector, with this apex</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/parameters.py"/>
        <source>Within a box</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/parameters.py"/>
        <source>automatic</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/parameters.py"/>
        <source>mm</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/parameters.py"/>
        <source>voxels</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>AIFReconScene.readiness</name>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/readiness.py"/>
        <source>Bone is looked for in the sweep itself: what is bright with darkness behind it. The docs say how well that works.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/readiness.py"/>
        <source>Choose a recording first.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/readiness.py"/>
        <source>Enter the name or address of the server.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/readiness.py"/>
        <source>Every label above 0 is bone.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/readiness.py"/>
        <source>Select a tracked sweep, or load a recording.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/readiness.py"/>
        <source>Select bone: the methods differ in what they make of it.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/readiness.py"/>
        <source>Select or draw the box to reconstruct, or choose another region.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/readiness.py"/>
        <source>Select the image node that is kept up to date.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/readiness.py"/>
        <source>Select the volume whose voxels are wanted, or choose another region.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/readiness.py"/>
        <source>Taken for the probability of bone, from 0 to 1.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/readiness.py"/>
        <source>The best cosine</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/readiness.py"/>
        <source>The output would overwrite {name}: select another output volume, or a new one.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/readiness.py"/>
        <source>The sweep cannot be reconstructed: see under Sweep.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/readiness.py"/>
        <source>There is no file {path}.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/readiness.py"/>
        <source>Without bone the sweep is averaged: nothing says at which angle a beam meets it.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/readiness.py"/>
        <source>{method} needs bone: select a segmentation, a labelmap or a bone probability, or another method.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/readiness.py"/>
        <source>{name} has no size: select a sweep or a CT for it to lie around, or draw it.</source>
        <translation type="unfinished"></translation>
    </message>
    <message>
        <location filename="../../AIFRecon/AIFReconScene/readiness.py"/>
        <source>{name} holds no bone: segment the CT, or select another.</source>
        <translation type="unfinished"></translation>
    </message>
</context>
<context>
    <name>qSlicerAbstractCoreModule</name>
    <message>
        <location filename="../../AIFRecon/AIFRecon.py"/>
        <source>Ultrasound</source>
        <translation type="unfinished"></translation>
    </message>
</context>
</TS>
