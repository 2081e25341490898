# SPDX-License-Identifier: MIT
"""What attacks on the program found: each ends at once, in exit 2 or as it should, and touches nothing."""

import os
import signal
import time

import h5py
import numpy as np

import run_fabseq
from run_fabseq import BAD_INPUT, PROGRAM, STOPPED, FabseqTest, Process, distinct
from small_parts import direct_2d, plate_2d, write_voxels


class HostileInputTest(FabseqTest):
    def assert_refused(self, config, *arguments, words, ranks=2, output=None):
        path = config if isinstance(config, str) else self.write_config(config)
        before = self.tree()
        begin = time.monotonic()
        run = self.run_program(ranks, "-config", path, *arguments, output=output, timeout=60)
        self.assertLess(time.monotonic() - begin, 30)
        self.assertEqual(run.status, BAD_INPUT, str(run))
        messages = [line for line in run.messages() if not line.startswith("warning: ")]
        self.assertEqual(len(messages), 1, str(run))
        for word in words:
            self.assertIn(word, messages[0])
        self.assertEqual(self.tree(), before, "a refused run has touched files")

    def finished_run(self, config, *arguments):
        run = self.run_config(1, config, "-max_iterations", 1, *arguments)
        self.assert_done(run)
        return run


class FilesTest(HostileInputTest):
    def test_pipes_and_devices(self):
        pipe = os.path.join(self.directory, "pipe")
        os.mkfifo(pipe)
        voxels = plate_2d()
        sequence = plate_2d()
        sequence["objective"], sequence["constraints"] = sequence["objective"][:1], []
        for name in distinct(pipe, "/dev/zero"):
            self.assert_refused(name, words=["-config", "is no regular file"])
            voxels["part"] = {"voxels": {"file": name}}
            self.assert_refused(voxels, words=["/part/voxels/file", "is no regular file"])
            self.assert_refused(plate_2d(), "-design", name, words=["-design", "is no regular file"])
            self.assert_refused(sequence, "-task", "simulate", "-sequence", name, words=["/sequence/file", "is no regular file"])

    def test_a_design_that_cannot_be_read_costs_no_run(self):
        finished = self.finished_run(plate_2d())
        design = os.path.join(self.directory, "design.h5")
        write_voxels(design, np.ones((3, 3)), dataset="design")
        for bad in (design, "nothing.h5"):
            for coarse in distinct((), ("-coarse_iterations", 1)):
                self.assert_refused(plate_2d(), "-overwrite", "-design", bad, *coarse, words=["-design"],
                                    output=finished.output)

    def test_a_signal_while_input_is_read(self):
        config = plate_2d()
        config["domain"]["elements"] = [400, 300]
        config["part"]["sampling"] = 16
        output = os.path.join(self.directory, "early")
        path = self.write_config(config)
        with Process([PROGRAM, "-config", path, "-output", output], self.directory) as process:
            status = f"/proc/{process.process.pid}/status"
            while not self.listens_for_term(status):
                time.sleep(0.001)
            process.process.send_signal(signal.SIGTERM)
            ended, _, errors = process.wait(60)
        self.assertEqual(ended, STOPPED, errors)
        self.assertIn("fabseq: stopped by signal TERM", errors)
        self.assertFalse(os.path.exists(output))

    @staticmethod
    def listens_for_term(status):
        with open(status, encoding="ascii") as file:
            caught = next(line for line in file if line.startswith("SigCgt"))
        return int(caught.split()[1], 16) >> (signal.SIGTERM - 1) & 1

    def test_a_run_that_another_begins_from_is_not_replaced(self):
        finished = self.finished_run(plate_2d(), "-coarse_iterations", 1)
        for arguments, key in ((("-design", "result.h5"), "-design"), (("-design", "coarse/refined.h5"), "-design"),
                               (("-task", "evaluate", "-design", "checkpoint/slot_0.h5"), "-design"),
                               (("-task", "sensitivity", "-sequence", "result.h5"), "/sequence/file")):
            *words, name = arguments
            self.assert_refused(plate_2d(), "-overwrite", *words, finished.path(name), words=[key, name, "-output"],
                                output=finished.output, ranks=1)

    def test_times_that_descend(self):
        finished = self.finished_run(direct_2d())
        with h5py.File(finished.path("result.h5"), "r+") as file:
            file["time_points"][...] = file["time_points"][...][::-1]
        self.assert_refused(direct_2d(), "-design", finished.path("result.h5"),
                            words=["-design", "'time_points'", "ascending"])


class OptionsTest(HostileInputTest):
    def test_directories(self):
        for words in (("-output", ""), ("-output=folder",), ("-Output", "folder")):
            self.assert_refused(plate_2d(), *words, words=["-output"], output="")

    def test_misspelt_settings(self):
        self.assert_refused(plate_2d(), "-Set", "layers.count=3", words=["-Set", '"-set"'])

    def test_values_that_petsc_refuses(self):
        for option, value in (("-elasticity_ksp_type", "nonsense"), ("-elasticity_ksp_max_it", "many"),
                              ("-heat_pc_type", "nonsense")):
            self.assert_refused(plate_2d(), "-solver_path", "reference", option, value, words=["PETSc"])

    def test_more_ranks_than_elements(self):
        config = plate_2d()
        config["domain"]["elements"] = [2, 1]
        config["part"] = {"box": {"min": [0, 0], "max": [2, 1.2]}}
        self.assert_refused(config, "-layer_groups", "auto", words=["ranks"], ranks=4)


class MagnitudesTest(HostileInputTest):
    def test_what_would_underflow(self):
        config = plate_2d()
        config["domain"]["size"] = [2e-60, 1.2e-60]
        self.assert_refused(config, words=["/domain/size/0", "2e-60", "1e-40"])
        self.assert_refused(plate_2d(), "-set", "material.inherent_strain=[1e-200,0,0]",
                            words=["/material/inherent_strain", "1e-200"])
        self.assert_refused(plate_2d(), "-set", "material.young=1e300", words=["/material/young", "1e+300"])


class LockTest(HostileInputTest):
    LONG = ("-max_iterations", "100000", "-elements", "60,36")

    def start(self, output, *arguments):
        path = self.write_config(plate_2d())
        process = Process(["mpirun", "-np", "2", PROGRAM, "-config", path, "-output", output, *self.LONG, *arguments],
                          self.directory)
        return process

    def test_a_second_run(self):
        output = os.path.join(self.directory, "one")
        with self.start(output, "-checkpoint_every", "1") as process:
            self.wait_for_history(process, output)
            holders = [f"process {rank})" for rank in process.ranks()]
            for arguments in (("-overwrite",), ("-restart", "auto")):
                run = self.run_config(2, plate_2d(), *self.LONG, *arguments, output=output, timeout=60)
                self.assertEqual(run.status, BAD_INPUT, str(run))
                (message,) = [line for line in run.messages() if not line.startswith("warning: ")]
                self.assertIn("in use by a run (host ", message)
                self.assertTrue(any(holder in message for holder in holders), message)
            self.assertIsNone(process.process.poll(), "the first run has ended")
            for rank in process.ranks():
                os.kill(rank, signal.SIGKILL)
            process.wait(60)
        self.assertTrue(os.path.exists(os.path.join(output, "lock")))
        done = len(run_fabseq.Result([], 0, "", "", output).history())
        with open(os.path.join(output, "stop"), "w", encoding="utf-8") as file:
            file.write(str(done + 1))
        with self.start(output, "-restart", "auto") as process:
            self.assertEqual(process.wait(120)[0], run_fabseq.STOPPED)
        self.assertFalse(os.path.exists(os.path.join(output, "lock")))


if __name__ == "__main__":
    run_fabseq.main()
