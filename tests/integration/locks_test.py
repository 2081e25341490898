# SPDX-License-Identifier: MIT
"""Two runs in one directory, on file systems that lack locks: the second is refused while the first is alive,
and told where that cannot be known."""

import os
import signal

import run_fabseq
from run_fabseq import BAD_INPUT, PROGRAM, STOPPED, FabseqTest, Process, Result, distinct
from small_parts import plate_2d

LONG = ("-elements", "60,36", "-max_iterations", "100000", "-checkpoint_every", "1")


@run_fabseq.only_release  # into which a library can be preloaded
class LocksTest(FabseqTest):
    def setUp(self):
        super().setUp()
        self.library = run_fabseq.build_preload(self.directory, "no_locks")

    def start(self, lacking, output, *arguments, ranks=2):
        command = ["mpirun", "-np", str(ranks), "-x", f"LD_PRELOAD={self.library}", PROGRAM, "-config",
                   self.write_config(plate_2d()), "-output", output, *LONG, *arguments]
        return Process(command, self.directory, {"NO_LOCKS": lacking})

    def second_run(self, lacking, output):
        """A run that goes on in the directory for one iteration, if it may."""
        done = len(Result([], 0, "", "", output).history())
        with open(os.path.join(output, "stop"), "w", encoding="utf-8") as file:
            file.write(str(done + 1))
        with self.start(lacking, output, "-restart", "auto") as process:
            return Result(process.command, *process.wait(120), output)

    def refused(self, lacking, output):
        with self.start(lacking, output, "-restart", "auto") as process:
            run = Result(process.command, *process.wait(60), output)
        self.assertEqual(run.status, BAD_INPUT, str(run))
        (message,) = [line for line in run.messages() if not line.startswith("warning: ")]
        self.assertIn("in use by a run (host ", message)
        return message

    def kill(self, process):
        for rank in process.ranks():
            os.kill(rank, signal.SIGKILL)
        process.wait(60)

    def move_elsewhere(self, output):
        """Makes the mark that of a process on another machine, in the file that is there."""
        with open(os.path.join(output, "lock"), "r+", encoding="utf-8") as file:
            words = file.read().splitlines()[1].split()
            file.seek(0)
            file.truncate()
            file.write("host elsewhere, since 2026-11-30 09:26:53 UTC, process 4711\n"
                       f"elsewhere 4711 no-such-boot {words[3]} {words[4]}\n")

    def test_a_second_run_beside_the_first(self):
        for lacking in distinct("flock", "all"):
            with self.subTest(lacking=lacking):
                output = os.path.join(self.directory, lacking)
                with self.start(lacking, output) as process:
                    self.wait_for_history(process, output)
                    holders = [f"process {rank})" for rank in process.ranks()]
                    message = self.refused(lacking, output)
                    self.assertTrue(any(holder in message for holder in holders), message)
                    self.assertIsNone(process.process.poll(), "the first run has ended")
                    self.kill(process)
                self.assertTrue(os.path.exists(os.path.join(output, "lock")))
                run = self.second_run(lacking, output)
                self.assertEqual(run.status, STOPPED, str(run))
                self.assertNotIn("is taken over", run.stderr)
                self.assertFalse(os.path.exists(os.path.join(output, "lock")))
                iterations = [line["iteration"] for line in run.history()]
                self.assertEqual(iterations, list(range(1, len(iterations) + 1)))

    def test_a_run_on_another_machine(self):
        output = os.path.join(self.directory, "run")
        with self.start("all", output) as process:
            self.wait_for_history(process, output)
            self.move_elsewhere(output)
            self.assertIn("(host elsewhere, since 2026-11-30 09:26:53 UTC, process 4711)", self.refused("all", output))
            self.kill(process)
        for lacking, reason in (("all", "no sign of life for 10 s"), ("none", "on another machine")):
            run = self.second_run(lacking, output)
            self.assertEqual(run.status, STOPPED, str(run))
            warnings = [line for line in run.messages() if "is taken over" in line]
            self.assertEqual(len(warnings), 1, str(run))
            for words in ("host elsewhere, since ", "process 4711", reason, "make sure that it has ended"):
                self.assertIn(words, warnings[0])
            with open(os.path.join(output, "lock"), "w", encoding="utf-8") as file:
                file.write("host elsewhere, since 2026-11-30 09:26:53 UTC, process 4711\nelsewhere 4711 no-such-boot - -\n")


if __name__ == "__main__":
    run_fabseq.main()
