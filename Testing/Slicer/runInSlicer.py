"""Runs every self test inside a Slicer application and ends it with an exit code.

Slicer --testing --no-splash --additional-module-paths AIFRecon --python-script Testing/Slicer/runInSlicer.py [NAME ...]

Names of files without their suffix, of classes or tests in them, run these alone: AIFReconWorkTest.
"""

import pathlib
import sys
import unittest

import slicer

FOLDER = pathlib.Path(__file__).resolve().parent


def main() -> int:
    """0 when every self test of the module and of this folder passes."""
    sys.path.insert(0, str(FOLDER))
    names = sys.argv[1:] or ["AIFRecon", *sorted(path.stem for path in FOLDER.glob("*Test.py"))]
    result = unittest.TextTestRunner(verbosity=2).run(unittest.defaultTestLoader.loadTestsFromNames(names))
    return 0 if result.wasSuccessful() and result.testsRun else 1


slicer.util.exit(main())
