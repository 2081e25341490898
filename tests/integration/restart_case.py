# SPDX-License-Identifier: MIT
"""Runs that are cut and continued by hand, for the tests of restarts."""

import os

from run_fabseq import BAD_INPUT, STOPPED, FabseqTest


class RestartTest(FabseqTest):
    def half_run(self, ranks, config, done, *arguments, output=None):
        """A run that is stopped when `done` iterations are done."""
        output = output or os.path.join(self.directory, f"half_{self.runs}")
        os.makedirs(output, exist_ok=True)
        with open(os.path.join(output, "stop"), "w", encoding="utf-8") as file:
            file.write(str(done))
        run = self.run_config(ranks, config, *arguments, output=output)
        self.assertEqual(run.status, STOPPED, str(run))
        self.assertFalse(os.path.exists(run.path("stop")), "a request that was fulfilled is still there")
        self.assertEqual(len(run.history()), done)
        return run

    def slots(self, run):
        """Path of the newest slot, and of the other one."""
        with open(run.path("checkpoint/newest"), encoding="utf-8") as file:
            newest = file.read().strip()
        other = "slot_1.h5" if newest == "slot_0.h5" else "slot_0.h5"
        return run.path("checkpoint/" + newest), run.path("checkpoint/" + other)

    def assert_refused(self, run, *words):
        self.assertEqual(run.status, BAD_INPUT, str(run))
        messages = [line for line in run.messages() if not line.startswith("warning: ")]
        self.assertEqual(len(messages), 1, str(run))
        for word in words:
            self.assertIn(word, messages[0])
