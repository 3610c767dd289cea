"""Self tests of the library's work beside the main thread."""

import os
import sys
import threading
import unittest


class AIFReconBackgroundTest(unittest.TestCase):
    """What the caller's progress function hears, and where."""

    def setUp(self):
        # As it is loaded now, for other tests reload the module
        from AIFReconScene.background import inBackground

        self.inBackground = inBackground

    def test_the_caller_hears_what_the_work_reports_on_its_own_thread(self):
        heard, both = [], threading.Event()

        def progress(fraction, message):
            heard.append((threading.get_ident(), fraction, str(message)))
            if fraction == 0.5:
                both.set()

        def work(progress):
            progress(0.5, "half")
            self.assertTrue(both.wait(60.0))
            progress(1.0, "all")
            return threading.get_ident()

        worker = self.inBackground(work, progress)
        self.assertNotEqual(worker, threading.get_ident())
        self.assertEqual({thread for thread, *_rest in heard}, {threading.get_ident()})
        self.assertIn((threading.get_ident(), 0.5, "half"), heard)
        self.assertEqual(heard[-1][1:], (1.0, "all"))

    def test_a_cancel_ends_the_work_at_its_next_report(self):
        from AIFReconLib.errors import OperationCanceled
        from AIFReconLib.progress import report

        ended = []

        def work(progress):
            try:
                while True:
                    report(progress, 0.2, "counting")
            finally:
                ended.append(True)

        with self.assertRaises(OperationCanceled):
            self.inBackground(work, lambda fraction, message: False)
        self.assertEqual(ended, [True])

    def test_work_that_was_canceled_after_its_last_report_counts_as_canceled(self):
        from AIFReconLib.errors import OperationCanceled

        asked = threading.Event()

        def progress(fraction, message):
            asked.set()
            return False

        with self.assertRaises(OperationCanceled):
            self.inBackground(lambda _progress: asked.wait(60.0), progress)

    @unittest.skipUnless(sys.platform == "linux", "threads have a priority of their own on Linux alone")
    def test_windows_have_the_cores_before_the_work(self):
        from AIFReconLib.machine.threads import NICE

        def priority(_progress=None):
            return os.getpriority(os.PRIO_PROCESS, threading.get_native_id())

        before = priority()
        self.assertGreaterEqual(self.inBackground(priority, lambda fraction, message: True), NICE)
        self.assertEqual(priority(), before)

    def test_work_that_nobody_watches_stays_on_the_caller_s_thread(self):
        self.assertEqual(self.inBackground(lambda progress: (progress, threading.get_ident())), (None, threading.get_ident()))
