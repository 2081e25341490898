# SPDX-License-Identifier: MIT
"""Runs that are ended from outside: signals, time limits, the file stop, kills. Nothing is lost but the work
since the last checkpoint, and nothing hangs."""

import contextlib
import os
import shutil
import signal

import run_fabseq
from compare_runs import history_text
from run_fabseq import OUTPUT_FAILURE, PROGRAM, SANITIZED, STOPPED, Process, Result, distinct
from small_parts import plate_2d
from stop_case import LONG, PATIENCE, StopTest


class SignalTest(StopTest):
    def stop_by(self, number, ranks, *arguments, output="run", environment=None):
        output = os.path.join(self.directory, output)
        with self.start(ranks, output, *arguments, environment=environment) as process:
            self.wait_for_lines(process, output, 3)
            process.process.send_signal(number)
            return self.finish(process, output)

    def test_user_signals(self):
        for number, name, ranks in distinct((signal.SIGUSR1, "USR1", 2), (signal.SIGUSR2, "USR2", 1)):
            with self.subTest(name=name):
                run = self.stop_by(number, ranks, output=name)
                self.assertEqual(run.status, STOPPED, str(run))
                own = [line for line in run.messages() if not line.startswith("mpirun: Forwarding")]
                self.assertEqual(own, [f"fabseq: stopped by signal {name}"])
                self.assertEqual(run.json("summary.json")["reason"], f"stopped by signal {name}")
                self.check_goes_on(ranks, run.output)

    def test_on_the_reference_path(self):
        arguments = ("-solver_path", "reference", "-reference_method", "gamg", "-elements", "40,24")
        run = self.stop_by(signal.SIGUSR1, 2, *arguments, "-checkpoint_every", 0)
        self.assertEqual(run.status, STOPPED, str(run))
        self.check_goes_on(2, run.output, *arguments)

    def test_end_by_the_launcher(self):
        """The checkpoint is what is promised: mpirun has a status of its own. For TERM and for INT it waits
        for so many seconds, passes TERM on, and kills after as many again. In the meantime it reads nothing
        of what the ranks print: they must not wait for that. The two wait side by side."""
        with contextlib.ExitStack() as stack:
            started = []
            for number in (signal.SIGTERM, signal.SIGINT):
                output = os.path.join(self.directory, f"end_{number}")
                process = stack.enter_context(self.start(2, output, environment={"OMPI_MCA_odls_base_sigkill_timeout": "5"}))
                self.wait_for_lines(process, output, 3)
                process.process.send_signal(number)
                started.append((process, output))
            runs = [self.finish(process, output) for process, output in started]
        for run in runs:
            with self.subTest(output=run.output):
                self.assertEqual(run.json("summary.json")["reason"], "stopped by signal TERM")
                self.check_goes_on(2, run.output)

    def test_without_mpirun(self):
        path, output = self.write_config(plate_2d()), os.path.join(self.directory, "alone")
        for number, name in ((signal.SIGTERM, "TERM"), (signal.SIGINT, "INT"), (signal.SIGHUP, "HUP")):
            command = [PROGRAM, "-config", path, "-output", output, *LONG, "-restart", "auto"]
            with Process(command, self.directory) as process:
                before = len(Result([], 0, "", "", output).history()) if os.path.exists(output) else 0
                self.wait_for_lines(process, output, before + 3)
                process.process.send_signal(number)
                run = self.finish(process, output)
            self.assertEqual(run.status, STOPPED, str(run))
            self.assertIn(f"fabseq: stopped by signal {name}", run.stderr)

    def run_in_shell(self, text, output):
        """A run without mpirun in a shell's line, which has {run} for it, and what the run left."""
        run = f"{PROGRAM} -config {self.write_config(plate_2d())} -output {output} {' '.join(LONG)}"
        command = ["bash", "-c", text.format(run=run)]
        return Result(command, *run_fabseq.run_command(command, self.directory, PATIENCE), output)

    def test_limit_of_cpu_time(self):
        """Of a queue, which warns a second before, and of `ulimit -t`, which alone would kill."""
        for limit in distinct("-St 2", "-t 3"):
            with self.subTest(limit=limit):
                output = os.path.join(self.directory, "limit" + limit.split()[-1])
                run = self.run_in_shell(f"ulimit {limit}; exec {{run}}", output)
                self.assertEqual(run.status, STOPPED, str(run))
                self.assertEqual(run.messages(), ["fabseq: stopped by signal XCPU"])
                self.assertEqual(run.json("summary.json")["status"], "stopped")
                self.assertTrue(os.path.exists(run.path("checkpoint/newest")))

    def test_nobody_reads_the_output_any_more(self):
        """As when a closed terminal ends the `tee` behind a run."""
        output = os.path.join(self.directory, "unread")
        run = self.run_in_shell("{run} | head -2; exit ${{PIPESTATUS[0]}}", output)
        self.assertEqual(run.status, STOPPED, str(run))
        self.assertEqual(run.json("summary.json")["reason"], "stopped by signal PIPE")
        self.assertTrue(os.path.exists(run.path("checkpoint/newest")))

    def test_nohup(self):
        """It goes on without the terminal."""
        output = os.path.join(self.directory, "nohup")
        command = ["nohup", PROGRAM, "-config", self.write_config(plate_2d()), "-output", output, *LONG]
        with Process(command, self.directory) as process:
            self.wait_for_lines(process, output, 2)
            process.process.send_signal(signal.SIGHUP)
            self.wait_for_lines(process, output, 5)
            process.process.send_signal(signal.SIGTERM)
            run = self.finish(process, output)
        self.assertEqual(run.status, STOPPED, str(run))
        self.assertEqual(run.json("summary.json")["reason"], "stopped by signal TERM")

    def test_limit_of_file_sizes(self):
        """`ulimit -f` is met like a full disk."""
        run = self.run_in_shell("ulimit -f 64; {run} -elements 160,96", os.path.join(self.directory, "large"))
        self.assertEqual(run.status, OUTPUT_FAILURE, str(run))
        self.assertIn("File too large", run.messages()[-1])

    def test_to_one_rank_only(self):
        output = os.path.join(self.directory, "one")
        with self.start(3, output) as process:
            self.wait_for_lines(process, output, 2)
            os.kill(process.ranks()[1], signal.SIGUSR2)
            run = self.finish(process, output)
        self.assertEqual(run.status, STOPPED, str(run))
        self.assertIn("stopped by signal USR2", run.stderr)
        self.check_goes_on(3, run.output)

    def test_layer_groups(self):
        for ranks, groups in distinct((4, 2), (2, 2)):
            with self.subTest(ranks=ranks, groups=groups):
                arguments = ("-layer_groups", groups)
                run = self.stop_by(signal.SIGUSR1, ranks, *arguments, output=f"groups_{ranks}")
                self.assertEqual(run.status, STOPPED, str(run))
                self.assertIn("fabseq: stopped by signal USR1", run.messages())
                self.check_goes_on(ranks, run.output, *arguments)

    def test_other_tasks(self):
        """Nothing to continue, but the same status."""
        path, output = self.write_config(plate_2d()), os.path.join(self.directory, "task")
        for task in ("simulate", "evaluate", "check_gradients"):
            command = ["mpirun", "-np", "2", PROGRAM, "-config", path, "-task", task, "-output", output, "-overwrite",
                       "-max_wall_time", "0.001"]
            run = Result(command, *run_fabseq.run_command(command, self.directory, PATIENCE), output)
            self.assertEqual(run.status, STOPPED, str(run))
            self.assertEqual(run.messages(), ["fabseq: stopped: -max_wall_time is over"])


class WithinAnIterationTest(StopTest):
    """Layer groups are each at its own layers when the request comes, for seconds: they all leave them."""

    # An iteration takes several seconds; the file is looked for once a second.
    ARGUMENTS = ("-layer_groups", 2, "-elements", "160,96" if SANITIZED else "320,192", "-layers", 24 if SANITIZED else 48,
                 "-tolerance", "1e-11")

    def stop_by(self, request, reason):
        output = os.path.join(self.directory, "run")
        with self.start(2, output, *self.ARGUMENTS) as process:
            self.wait_for_lines(process, output, 1)
            request(process, output)
            run = self.finish(process, output)
        self.assertEqual(run.status, STOPPED, str(run))
        self.assertIn(f"fabseq: {reason}", run.messages())
        self.assertEqual(run.json("summary.json")["reason"], reason)
        self.assertEqual(run.json("summary.json")["layer_groups"], 2)
        self.assertEqual(len(run.history()), 1, "the iteration was completed")
        self.assertTrue(os.path.exists(run.path("checkpoint/newest")))
        return run

    def test_signal(self):
        self.stop_by(lambda process, _: process.process.send_signal(signal.SIGUSR1), "stopped by signal USR1")

    def test_signal_to_a_rank_of_one_group(self):
        for rank in distinct(1, 0):
            with self.subTest(rank=rank):
                self.stop_by(lambda process, _, victim=rank: os.kill(process.ranks()[victim], signal.SIGUSR2),
                             "stopped by signal USR2")
                shutil.rmtree(os.path.join(self.directory, "run"))

    def test_file(self):
        run = self.stop_by(lambda _, output: os.close(os.open(os.path.join(output, "stop"), os.O_CREAT)),
                           "stopped by the file 'stop' in the output directory")
        self.assertFalse(os.path.exists(run.path("stop")))


class LimitTest(StopTest):
    def test_wall_time(self):
        for limit, ranks in distinct(("0:0:3", 2), ("2.5", 1)):
            with self.subTest(limit=limit):
                output = os.path.join(self.directory, f"limit_{ranks}")
                with self.start(ranks, output, "-max_wall_time", limit) as process:
                    run = self.finish(process, output)
                self.assertEqual(run.status, STOPPED, str(run))
                self.assertEqual(run.messages(), ["fabseq: stopped: -max_wall_time is over"])
                if run.history():
                    self.check_goes_on(ranks, output)

    def test_over_before_the_first_iteration(self):
        output = os.path.join(self.directory, "at_once")
        with self.start(2, output, "-max_wall_time", "0.0001") as process:
            run = self.finish(process, output)
        self.assertEqual(run.status, STOPPED, str(run))
        self.assertEqual(run.json("summary.json")["iterations"], 0)
        with open(run.path("stop"), "w", encoding="utf-8") as file:
            file.write("3")
        with self.start(2, output, "-restart", "auto") as process:
            run = self.finish(process, output)
        self.assertEqual(run.status, STOPPED, str(run))
        self.assertEqual([line["iteration"] for line in run.history()], [1, 2, 3])

    def test_stop_file(self):
        output = os.path.join(self.directory, "file")
        with self.start(2, output) as process:
            self.wait_for_lines(process, output, 2)
            with open(os.path.join(output, "stop"), "w", encoding="utf-8"):
                pass
            run = self.finish(process, output)
        self.assertEqual(run.status, STOPPED, str(run))
        self.assertFalse(os.path.exists(run.path("stop")))
        self.check_goes_on(2, output)


class KillTest(StopTest):
    def test_kill(self):
        """Of all ranks, or of one, which mpirun answers by ending the others."""
        for victims in distinct("one", "all"):
            with self.subTest(victims=victims):
                output = os.path.join(self.directory, f"kill_{victims}")
                with self.start(2, output, "-checkpoint_every", 3) as process:
                    self.wait_for_lines(process, output, 8)
                    ranks = process.ranks()
                    self.assertEqual(len(ranks), 2)
                    for rank in ranks if victims == "all" else ranks[1:]:
                        os.kill(rank, signal.SIGKILL)
                    self.assertNotEqual(self.finish(process, output).status, 0)
                done = len(Result([], 0, "", "", output).history())
                expected = output + "_expected"
                os.mkdir(expected)
                runs = []
                for folder in distinct(output, expected):
                    with open(os.path.join(folder, "stop"), "w", encoding="utf-8") as file:
                        file.write(str(done + 2))
                    with self.start(2, folder, "-checkpoint_every", 3, "-restart", "auto") as process:
                        runs.append(self.finish(process, folder))
                    self.assertEqual(runs[-1].status, STOPPED, str(runs[-1]))
                continued = int(runs[0].stdout.split("continues after iteration ")[1].split()[0])
                self.assertGreaterEqual(continued, done - 4)  # the one every three iterations, or the one under way then
                self.assertEqual(history_text(runs[0]), history_text(runs[-1]))


if __name__ == "__main__":
    run_fabseq.main()
