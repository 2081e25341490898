# SPDX-License-Identifier: MIT
"""-task check says which cores the ranks have and how busy these are; `auto` layer groups count cores."""

import contextlib
import os
import re
import subprocess
import sys
from unittest import mock

import run_fabseq
from run_fabseq import FabseqTest
from small_parts import hook_3d

LINE = r"(?m)^machine: (\d+) cores? \((\d+) threads?\) for (\d+) ranks?, (\d+) % busy$"


def made_up(machine):
    """hwloc sees it, described in its own words, within a with statement."""
    return mock.patch.dict(os.environ, HWLOC_SYNTHETIC=machine, HWLOC_COMPONENTS="synthetic,-gl")


@contextlib.contextmanager
def all_cores_busy():
    processes = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(os.cpu_count())]
    try:
        yield
    finally:
        for process in processes:
            process.kill()
            process.wait()


class MachineTest(FabseqTest):
    def check(self, ranks, *arguments):
        """Cores, threads, ranks and percent busy; the whole result."""
        run = self.run_config(ranks, hook_3d(), "-task", "check", *arguments, output="")
        self.assert_done(run)
        found = re.findall(LINE, run.stdout)
        self.assertEqual(len(found), 1, str(run))
        return [int(word) for word in found[0]], run

    def test_this_machine(self):
        for ranks in run_fabseq.distinct(1, 2):
            (cores, threads, own, busy), run = self.check(ranks)
            self.assertEqual((threads, own), (len(os.sched_getaffinity(0)), ranks))
            self.assertIn(cores, range(1, threads + 1))
            self.assertLessEqual(busy, 100)
            self.assertEqual("share" in run.stderr, ranks > cores, str(run))

    @run_fabseq.only_release
    def test_more_ranks_than_cores(self):
        with made_up("core:1 pu:8"):
            found, run = self.check(2)
            self.assertEqual(found[0], 1)
            self.assertEqual(run.stderr.count("warning: machine: 2 ranks share 1 core: more ranks than cores gain nothing\n"), 1)
            self.assertRegex(run.stdout, r"(?m)^layer groups: .* \(auto\): [01]\.\d times as fast as .*; 0\.5 cores a rank$")
            self.assertNotIn("share", self.check(1)[1].stderr)
        with made_up("core:64 pu:1"):
            self.assertNotIn("cores a rank", self.check(2)[1].stdout)

    @run_fabseq.only_release
    def test_busy_cores(self):
        with all_cores_busy():
            found, run = self.check(1)
        self.assertGreater(found[3], 50, str(run))


if __name__ == "__main__":
    run_fabseq.main()
