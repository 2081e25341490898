# SPDX-License-Identifier: MIT
"""Disks that are full, read-only or gone under a run: it ends with one line, and goes on from its last good
checkpoint."""

import os
import shutil
import subprocess

import run_fabseq
from run_fabseq import OUTPUT_FAILURE, STOPPED, distinct
from stop_case import StopTest


class LostDiskTest(StopTest):
    def setUp(self):
        super().setUp()
        self.disk = self.small_disk("2m")

    def mount(self, *arguments):
        return subprocess.run(["mount", *arguments, self.disk], capture_output=True, text=True, check=False)

    def assert_lost(self, process, output, *words):
        run = self.finish(process, output)
        self.assertEqual(run.status, OUTPUT_FAILURE, str(run))
        messages = [line for line in run.messages() if not line.startswith("warning: ")]
        self.assertEqual(len(messages), 1, str(run))
        for word in words:
            self.assertRegex(messages[0], word)
        return run

    def check_goes_on_from_the_last_good_one(self, ranks, output):
        with open(os.path.join(output, "stop"), "w", encoding="utf-8"):
            pass
        with self.start(ranks, output, "-checkpoint_every", 2, "-restart", "auto") as process:
            run = self.finish(process, output)
        self.assertEqual(run.status, STOPPED, str(run))
        self.assertGreater(int(run.stdout.split("continues after iteration ")[1].split()[0]), 0)
        self.assertNotIn("warning", run.stderr)

    def test_full(self):
        for ranks in distinct(3, 1):
            with self.subTest(ranks=ranks):
                output = os.path.join(self.disk, f"run_{ranks}")
                with self.start(ranks, output, "-checkpoint_every", 2) as process:
                    self.wait_for_lines(process, output, 5)
                    filler = os.path.join(self.disk, "filler")
                    with open(filler, "wb", buffering=0) as file:
                        try:
                            while file.write(bytes(4096)) == 4096:
                                pass
                        except OSError:
                            pass
                    self.assert_lost(process, output, r"(history\.jsonl|slot_[01]\.h5|newest)", "No space left on device")
                os.remove(filler)
                self.check_goes_on_from_the_last_good_one(ranks, output)

    def test_read_only(self):
        for ranks in distinct(3, 1):
            with self.subTest(ranks=ranks):
                output = os.path.join(self.disk, f"run_{ranks}")
                with self.start(ranks, output, "-checkpoint_every", 2) as process:
                    self.wait_for_lines(process, output, 5)
                    for _ in range(1000):  # busy while one of the run's files is open for writing
                        if self.mount("-o", "remount,ro").returncode == 0:
                            break
                    else:
                        self.fail("the disk cannot be made read-only")
                    self.assert_lost(process, output, "Read-only file system", r"(history\.jsonl|slot_[01]\.h5|newest)")
                self.assertEqual(self.mount("-o", "remount,rw").returncode, 0)
                self.check_goes_on_from_the_last_good_one(ranks, output)

    def test_vanished(self):
        for ranks in distinct(3, 1):
            with self.subTest(ranks=ranks):
                output = os.path.join(self.disk, f"run_{ranks}")
                with self.start(ranks, output, "-checkpoint_every", 2) as process:
                    self.wait_for_lines(process, output, 5)
                    os.rename(output, output + "_moved")
                    self.assert_lost(process, output, "No such file or directory", f"run_{ranks}/")
                self.assertFalse(os.path.exists(output))
                os.rename(output + "_moved", output)
                self.check_goes_on_from_the_last_good_one(ranks, output)
                shutil.rmtree(output)


if __name__ == "__main__":
    run_fabseq.main()
