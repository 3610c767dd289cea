"""What each command refuses: exit code 2, one line that says what is wrong, and nothing written."""

from __future__ import annotations

import shlex

import numpy as np
import pytest
from dicom_samples import write_dicom
from files import refused, tracked_sequence, write_patient
from late_sweeps import late_sweep, one_way
from made_recordings import acquisition
from sweeps import rigid

from AIFReconLib.geometry.volume import Volume
from AIFReconLib.io.sequence.writer import write_sequence

RECONSTRUCT = "reconstruct sweep.igs.mha --config PlusDeviceSet.xml"
LIVE = "live --port 9 -o out/v.nrrd"
START = "start-calibration --depth 60 40 440 --face-px 320 38 --face-mm 4 0 -118 --right x --down=-z"
OUT = f"{RECONSTRUCT} -o out/v.nrrd"

REFUSED = {
    # ---- words
    "reconstuct sweep.igs.mha": "there is no command reconstuct, perhaps reconstruct is meant",
    "zzz": "there is no command zzz.",
    f"{RECONSTRUCT} --ouput v.nrrd": "there is no option --ouput, perhaps --output is meant",
    f"{RECONSTRUCT} --out v.nrrd": "there is no option --out, perhaps --output or --output-type is meant",
    f"{RECONSTRUCT} -output v.nrrd": "there is no option -output, perhaps --output is meant",
    f"{OUT} --quiet --verbose": "argument --verbose: not allowed with argument -q/--quiet",
    f"{OUT} --quiet=yes": "ignored explicit argument 'yes'",
    f"{OUT} --spacing": "argument --spacing: expected one argument",
    f"{OUT} --spacing 1 2": "--spacing: takes one number or three (x y z), got 2",
    f"{OUT} --spacing 0,5": "--spacing: must be a number such as 0.5, without a unit; got '0,5'",
    f"{OUT} --skip 1.5": "--skip: must be a whole number; got '1.5'",
    f"{OUT} --memory 5B": "such as 1.5GB; got '5B'",
    f"{OUT} --engine nump": "argument --engine: invalid choice: 'nump' (choose from",
    RECONSTRUCT: "the following arguments are required: -o/--output. See aifrecon reconstruct --help.",
    "bone-map labels.nrrd b.nrrd -o out/p.nrrd": "unrecognized arguments: b.nrrd",
    f"{RECONSTRUCT} -o ''": "must be the name of a file",
    **{f"{OUT} {each} ''": "must be the name of a file" for each in ("--bone-model", "--config", "--bone-labels", "--save-settings")},
    # ---- settings
    f"{OUT} --alpha -1": "Input alpha must be at least 0; got -1.0.",
    f"{OUT} --spacing 0": "Input spacing must be at least 0.01 mm; got 0.0.",
    f"{OUT} --hole-limit x": "--hole-limit: must be auto or a number such as 0.5",
    f"{OUT} --method best": "method must be one of average, latest",
    f"{OUT} --method aif": "needs to know where bone is",
    f"{OUT} --clip-px 0 0 -5 4": "clip rectangle must be X Y W H with W, H not negative",
    f"{OUT} --clip-px 100 100 5 5": "The clip rectangle and fan leave no pixel of a 40 x 30 image.",
    f"{OUT} --fan-angles-deg -10 10": "Give both --fan-angles-deg A B and --fan-radius-px R0 R1.",
    f"{OUT} --probe linear --apex-px 1 2": "A linear probe has no apex",
    f"{OUT} --probe sector": "show a linear probe, not a sector",
    f"{OUT} --reference Nowhere": "Nothing says where Image lies in Nowhere.",
    f"{OUT} --image-to-reference Nonsense": "must be FromToTo",
    f"{OUT} --cosine out/c.nrrd": "The cosine of incidence needs to know where bone is.",
    f"{OUT} --spacing 0.1 --memory 0.0001": "would fit",
    f"{OUT} --settings s.json": "s.json: there is no setting alhpa, perhaps alpha is meant.",
    f"{OUT} --settings far.nrrd": "far.nrrd: this volume does not say how it was made. Give one that AIFRecon wrote",
    f"{OUT} --save-settings s.txt": "settings are written as .json or .toml",
    # ---- bone
    f"{OUT} --bone-labels labels.nrrd --bone-above 300": "--bone-above says what is bone in a CT",
    f"{OUT} --bone-from-sweep --labels L3": "--labels chooses among labels, and there are none",
    f"{OUT} --bone-labels labels.nrrd --labels L9": "No label is called 'L9'. There are 1",
    f"{OUT} --bone-labels ct.nrrd": "labels must not be negative; got -10",
    f"{LIVE} --bone-frames said.mha": "--bone-frames belongs to a recorded sweep",
    f"{LIVE} --bone-image Bone --bone-from-sweep": "not allowed with argument --bone-image",
    f"{LIVE} --bone-image Bone --image Bone": "two devices; got 'Bone' for both",
    f"{LIVE} --bone-image Bone --bone-transform T.tfm": "--bone-image needs none",
    "preview missing.nrrd -o v.png --bone-transform t.tfm": "--bone-transform places labels or a CT",
    # ---- files
    f"{OUT} --bone-transform missing.tfm": "--bone-transform places a bone input, and there is none",
    f"{OUT} --bone-labels missing.nrrd": "there is no such file",
    f"{OUT} --grid-like far.nrrd": "no frame falls into the volume",
    f"{RECONSTRUCT} -o out/no/v.nrrd": "does not exist",
    f"{OUT} --hits out/v.nrrd": "another output",
    f"{OUT} --log cases.csv": "Cannot log to cases.csv: it is there and is no log.",
    f"{OUT} --log no/log.txt": "does not exist",
    f"{OUT} --holes stick --hole-limit 0": "hole_limit must be above 0 mm",
    f"{OUT} --importance-mask none.png": "none.png: there is no such file",
    f"{OUT} --pixel-rejection -3": "pixel_rejection must be at least 0",
    f"{OUT} -q --reference Nowhere": "Nothing says where Image lies in Nowhere.",
    "convert way.mha out/s.mha --time-offset auto": "does not go back over the same place",
    f"{OUT} --dicom-study labels.nrrd": "--dicom-study is for an output that ends with .dcm",
    "evaluate far.nrrd --bone labels.nrrd --csv labels.nrrd": "would overwrite an input",
    "evaluate far.nrrd --bone labels.nrrd --csv ct.nrrd": "Choose a name that ends with .csv",
    "info sweep.igs.mha sweep.igs.mha --drawing out/s.svg": "--drawing shows one sequence",
    "preview missing.nrrd -o v.jpg": "a preview is a PNG picture",
    "preview missing.nrrd -o none/v.png": "none",
    "compare far.nrrd ct.nrrd -o v.jpg": "a figure is a PNG, PDF or SVG",
    "simulate --plan deep.json -o out/x": "it is nested too deeply",
    "plan --bone-labels labels.nrrd -o out/p.json --unseen deep.json": "it is nested too deeply",
    "bone-map damaged.obj -o out/p.nrrd": "it cannot be read as a surface model",
    "calibrate sweep.igs.mha --config PlusDeviceSet.xml --bone-labels labels.nrrd -o new.nii": "must end in .xml or .tfm",
    "calibrate sweep.igs.mha --config PlusDeviceSet.xml --bone-labels labels.nrrd -o no/New.xml": "does not exist. Create it",
    "calibrate sweep.igs.mha --bone-labels labels.nrrd -o out/New.xml": "Give it with --config",
    # ---- what one command takes
    "compare far.nrrd ct.nrrd --names one -o out/v.png": "--names must be 2 different names",
    "compare far.nrrd ct.nrrd --window 9 3 -o out/v.png": "--window must be BLACK and WHITE",
    "compare far.nrrd ct.nrrd --at 9 0 0 -o out/v.png": "the cuts do not go through it. It fills",
    "benchmark --rate 0": "--rate: must be a number above 0",
    "benchmark --size 0 480": "--size must be 16 to",
    "benchmark --frames 1": "at least 2 --frames",
    f"{START} -o p.xml --right z": "two different axes",
    f"{START} -o p.xml --right 0,0,0": "right must be an axis of the marker",
    f"{START} -o p.xml --depth 60 440 40": "--depth must be mm, the row where they begin",
    f"{START} -o p.xml --depth 0 4 40": "a size above 0 mm",
    f"{START} -o p.xml --face-mm nan 0 0": "finite",
    f"{START} -o p.xml --tool 'my probe'": "--tool must be letters",
    f"{START} -o p.tfm": "ends with .xml",
    "evaluate one.csv far.nrrd": "hold numbers of many cases",
    "evaluate one.csv": "hold one case",
    "batch cases.csv -o out --workers 0": "a whole number of 1 or more",
    "batch cases.csv -o out --memory -1": "must be a positive size such as 1.5GB",
    "batch cases.csv -o results --memory 0.5": "must be at least 0.75 GB",
    "batch cases.csv -o out --scheduler tcp://h:1 --workers 2": "a cluster has its own",
    "batch cases.csv -o out --method nowhere:mine": "there is no module nowhere",
    **{
        f"convert sweep.igs.mha out/s.mha {options}": said
        for options, said in {
            "--frames 2 9": "frames must be two numbers from 0 to 5, rising; got 2 9",
            "--every 0": "every must be 1 or more; got 0",
            "--crop 0 0 10 10": "cropping moves the first pixel",
            "--crop 35 0 10 10": "within the image of 40 x 30 pixels; got X 35, Y 0, W 10, H 10",
            "--rename Probe": "rename: must be A=B",
            "--rename Robe=Needle": "must name a frame of the recording; it has Probe, Reference, Tracker",
            "--rename RobeToTracker=NeedleToTracker": "a transform of the recording; it has ProbeToTracker, ReferenceToTracker",
            "--rename ProbeToTracker=Needle": "two transforms",
            "--rename Probe=Reference": "there would be two of ReferenceToTracker",
            "--orientation FM": "orientation must be MF, MN, UF or UN; got 'FM'",
            "--wrong-calibration x.xml": "Say with --calibration",
            "--calibration missing.txt": "no such file",
            "--transform-sequence t.seq.mha": "must be NAME=FILE",
            "--transform-sequence Transform=t.seq.mha": "one 'To' before an upper-case letter",
        }.items()
    },
}
"""Words of a command line, and what is said of them."""


OVERWRITES = {
    f"{RECONSTRUCT} -o sweep.igs.mha": "the sweep",
    "convert sweep.igs.mha same.igs.mha": "the same file by another name",
    "reconstruct scan.mhd -o frames.mhd": "the data of a header",
    "reconstruct sweep.igs.mha --config Masked.xml -o out/v.nrrd --preview mask.png": "the mask that a configuration names",
    "import pictures --poses cases.csv --transform ImageToTracker -o out/s.mha --drawing pictures/1.png": "an image of a folder",
    "convert acquired/US-Acq_1_20260101T120000_Probe.fts acquired/US-Acq_1_20260101T120000_Probe_2.mhd": "a frame of a recording",
    "preview 0.dcm --ct 1.dcm -o 3.dcm": "a slice of a CT of which another is named",
}
"""Outputs that are read, also where they are not named."""


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A patient's files, others that cannot be used, and an empty folder for what comes of it."""
    here = tmp_path_factory.mktemp("refused")
    write_patient(here)
    for name in ("out", "pictures"):
        (here / name).mkdir()
    Volume(np.zeros((4, 4, 4), np.uint8), rigid(translation=(900, 0, 0))).write(here / "far.nrrd")
    Volume(np.full((4, 4, 4), -10, np.int16), np.eye(4)).write(here / "ct.nrrd")
    write_sequence(tracked_sequence(), here / "scan.mhd")
    write_sequence(late_sweep(one_way), here / "way.mha")
    (here / "scan.zraw").rename(here / "frames.zraw")
    (here / "same.igs.mha").hardlink_to(here / "sweep.igs.mha")
    acquisition(here / "acquired")
    masks = f'<VolumeReconstruction CompoundingMode="IMPORTANCE_MASK" ImportanceMaskFilename="{here / "mask.png"}" '
    for name, text in {
        "deep.json": "[" * 100_000 + "]" * 100_000,
        "damaged.obj": "v 0 0 0\nv 10 0 0\nv 0 10 0\nf 1 2 99999999999999999999999\n",
        "s.json": '{"alhpa": 1}',
        "one.csv": "volume,reachability,bone_cnr\naverage.nrrd,sweep,0.5\n",
        "cases.csv": "case,sweeps,config,spacing,preview\nP1,sweep.igs.mha,PlusDeviceSet.xml,1,no\n",
        "scan.mhd": (here / "scan.mhd").read_text().replace("scan.zraw", "frames.zraw"),
        "Masked.xml": (here / "PlusDeviceSet.xml").read_text("utf-8").replace("<VolumeReconstruction ", masks),
        "mask.png": "mask",
        "pictures/1.png": "image",
    }.items():
        (here / name).write_text(text, "utf-8")
    of_ct = {"Modality": "CT", "SeriesInstanceUID": "1.2.3", "PixelSpacing": [1, 1], "ImageOrientationPatient": [1, 0, 0, 0, 1, 0]}
    for number in range(4):
        place = {"SOPInstanceUID": f"1.2.3.{number}", "ImagePositionPatient": [0, 0, number]}
        write_dicom(here / f"{number}.dcm", np.zeros((8, 8), np.int16), **of_ct, **place)
    return here


@pytest.mark.parametrize("words", [*REFUSED, *OVERWRITES])
def test_what_cannot_be_is_refused_in_one_line_and_nothing_is_written(words, made, monkeypatch, capsys):
    monkeypatch.chdir(made)
    before = {path: path.read_bytes() for path in made.rglob("*") if path.is_file()}
    assert REFUSED.get(words, "would overwrite an input") in refused(shlex.split(words), capsys, made / "out")
    assert {path: path.read_bytes() for path in made.rglob("*") if path.is_file()} == before


@pytest.mark.parametrize(
    ("matrix", "reason"),
    [(np.full((4, 4), np.nan), "not finite"), (np.diag([1.0, 1.3, 1, 1]), "not rigid"), (np.diag([-1.0, 1, 1, 1]), "mirrored")],
)
def test_poses_that_cannot_be_are_refused_when_there_are_no_others(matrix, reason, tmp_path, results, capsys):
    patient = write_patient(tmp_path, tracked_sequence(matrices=dict.fromkeys(range(6), matrix)))
    assert reason in refused([*patient.reconstruct, "--output", results / "v.nrrd"], capsys, results)
