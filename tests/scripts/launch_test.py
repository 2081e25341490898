# SPDX-License-Identifier: MIT
"""How runs end that are started with `mpirun`, as scripts/environment.sh makes it, or with
scripts/use/run.sh: at once after a mistake, with a checkpoint after a signal."""

import json
import os
import shlex
import signal
import subprocess
import tempfile
import time
import unittest

from run_fabseq import BAD_INPUT, DONE, ENVIRONMENT, PROGRAM, STOPPED
from small_parts import plate_2d
from terminal import CONTROL_C, Terminal

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))

PATIENCE = 60
AT_ONCE = 20  # seconds, on a machine with other things to do; three on an idle one
RUN_SCRIPT, MPIRUN = os.path.join(ROOT, "scripts", "use", "run.sh"), "mpirun"
KILLED_BY_USR1 = 128 + signal.SIGUSR1
WAIT = "OMPI_MCA_odls_base_sigkill_timeout"


class LaunchTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="fabseq_launch_", ignore_cleanup_errors=True)
        self.addCleanup(self.folder.cleanup)
        with open(self.path("plate.json"), "w", encoding="utf-8") as file:
            json.dump(plate_2d(), file)
        self.environment = {**ENVIRONMENT, **os.environ, "FABSEQ_PROGRAM": PROGRAM, "OMPI_MCA_orte_tmpdir_base": self.folder.name}
        self.environment.pop(WAIT, None)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def command(self, start, *options, ranks=2, output="out"):
        """The words of a run that takes its time."""
        words = [start, "-np", ranks, *([PROGRAM] if start == MPIRUN else []), "-config", self.path("plate.json"), "-output",
                 self.path(output), "-elements", "60,36", "-max_iterations", 100000, *options]
        return " ".join(map(str, words))

    def wait_until(self, condition, what):
        end = time.monotonic() + PATIENCE
        while not condition():
            self.assertLess(time.monotonic(), end, f"no {what}")
            time.sleep(0.02)

    def wait_for_history(self, output="out"):
        history = self.path(output + "/history.jsonl")
        self.wait_until(lambda: os.path.exists(history) and os.path.getsize(history) > 0, history)

    def wait_for_end(self, output):
        """Until nothing of the run is left."""
        find = ["pgrep", "-f", self.path(output)]
        self.wait_until(lambda: subprocess.run(find, capture_output=True, check=False).returncode, "end of " + output)

    def assert_stopped(self, output="out"):
        self.wait_for_end(output)
        with open(self.path(output + "/summary.json"), encoding="utf-8") as file:
            self.assertEqual(json.load(file)["status"], "stopped")
        self.assertTrue(os.path.exists(self.path(output + "/checkpoint/newest")))


class TerminalTest(LaunchTest):
    """Both ways of starting, typed into a shell that has read environment.sh."""

    def terminals(self):
        """A terminal for each way, and how the way begins."""
        for start in (MPIRUN, RUN_SCRIPT):
            with self.subTest(start=start), Terminal(self.folder.name, self.environment, PATIENCE) as terminal:
                terminal.run(f"source {ROOT}/scripts/environment.sh")
                self.assertEqual(terminal.wait_for_status(), DONE)
                yield terminal, start
                subprocess.run(["rm", "-rf", self.path("out")], check=True)

    def test_a_mistake(self):
        for terminal, start in self.terminals():
            if start == RUN_SCRIPT:
                terminal.run(f"export {WAIT}=60")
                self.assertEqual(terminal.wait_for_status(), DONE)
            begin = time.monotonic()
            terminal.run(self.command(start, "-set", "typo=1"))
            terminal.wait_for("/typo: unknown key")
            self.assertEqual(terminal.wait_for_status(), BAD_INPUT)
            self.assertLess(time.monotonic() - begin, AT_ONCE)

    def test_control_c(self):
        for terminal, start in self.terminals():
            terminal.run(self.command(start))
            self.wait_for_history()
            begin = time.monotonic()
            terminal.type(CONTROL_C)
            terminal.wait_for("stopping after the solve in hand")
            self.assertLess(time.monotonic() - begin, AT_ONCE)
            self.assertEqual(terminal.wait_for_status(), STOPPED)
            self.assert_stopped()
            terminal.run(self.command(start, "-restart", "auto", "-max_iterations", 1))
            terminal.wait_for("continues after iteration [1-9]")
            self.assertEqual(terminal.wait_for_status(), DONE)

    def test_a_second_one(self):
        for terminal, start in self.terminals():
            terminal.run(self.command(start, "-elements", "1200,720", "-layers", 40))
            self.wait_until(lambda: os.path.exists(self.path("out/lock")), "lock")
            terminal.type(CONTROL_C)
            terminal.wait_for("stopping after the solve in hand")
            time.sleep(0.2)  # sooner, the program takes it for the first one
            terminal.type(CONTROL_C)
            terminal.wait_for("ending at once")
            begin = time.monotonic()
            self.assertEqual(terminal.wait_for_status(), KILLED_BY_USR1)
            self.assertLess(time.monotonic() - begin, AT_ONCE)

    def test_the_terminal_goes(self):
        for terminal, start in self.terminals():
            terminal.run(self.command(start))
            self.wait_for_history()
            terminal.close()
            self.assert_stopped()

    def test_nothing_else_is_shown(self):
        """No notices of jobs, as of what a shell has put into the background."""
        with Terminal(self.folder.name, self.environment, PATIENCE) as terminal:
            terminal.run(f"source {ROOT}/scripts/environment.sh")
            terminal.wait_for_status()
            terminal.run("mpirun -np 1 echo of the rank")
            shown = terminal.wait_for(r"(?s)\r\n(.*)status=0\r\n")[1]
            self.assertEqual(shown, "of the rank\r\n")


class ShellScriptTest(LaunchTest):
    """`mpirun` in scripts, which may read environment.sh twice."""

    def start(self, text):
        script = f"set -eu\nsource {ROOT}/scripts/environment.sh\nsource {ROOT}/scripts/environment.sh\n{text}"
        process = subprocess.Popen(["bash", "-c", script], cwd=self.folder.name, env=self.environment, stdin=subprocess.DEVNULL,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True)
        self.addCleanup(process.kill)
        return process

    def run_script(self, text):
        """Status and both streams."""
        process = self.start(text)
        streams = process.communicate(timeout=PATIENCE)
        return process.returncode, *streams

    def test_a_mistake(self):
        for ranks in (1, 2, 3):
            with self.subTest(ranks=ranks):
                begin = time.monotonic()
                command = self.command(MPIRUN, "-set", "typo=1", ranks=ranks)
                status, stdout, stderr = self.run_script(f"{command}\necho goes on")
                self.assertEqual((status, stdout), (BAD_INPUT, ""), stderr)
                self.assertRegex(stderr, r"\Afabseq: /typo: unknown key[^\n]*\n\Z")  # and nothing of mpirun's
                self.assertLess(time.monotonic() - begin, AT_ONCE)
                self.assertFalse(os.path.exists(self.path("out")))

    def test_input_output_and_status(self):
        program = "sh -c 'cat; echo of the rank >&2; exit 3'"
        status, stdout, stderr = self.run_script(f"echo typed | mpirun -np 1 {program}")
        self.assertEqual((status, stdout, stderr), (3, "typed\n", "of the rank\n"))
        dashes = 30 * "-"
        done = self.run_script(f"mpirun -np 1 sh -c 'printf \"%s\\n\" {dashes} x {dashes} >&2'")
        self.assertEqual(done[2], f"{dashes}\nx\n{dashes}\n")
        self.assertEqual(self.run_script("mpirun -np 1 echo out & wait $!"), (0, "out\n", ""))
        self.assertEqual(self.run_script("mpirun -np 1 echo out | tr a-z A-Z"), (0, "OUT\n", ""))
        status, stdout, _ = self.run_script("if mpirun -np 1 false; then echo yes; else echo no $?; fi")
        self.assertEqual((status, stdout), (0, "no 1\n"))

    def test_the_shell_stays_as_it_is(self):
        settings = "trap -p; shopt; set +o; declare -F; jobs"
        script = f"""trap 'echo own' INT TERM USR1
                     before=$({settings}); mpirun -np 1 true; [[ $before == "$({settings})" ]]
                     (trap 'echo of the subshell' USR2; mpirun -np 1 true; kill -USR2 $BASHPID)
                     (mpirun -np 1 true; trap)
                     kill -USR1 $$"""
        self.assertEqual(self.run_script(script), (0, "of the subshell\nown\n", ""))

    def test_in_the_background(self):
        for name in ("TERM", "INT", "USR1"):
            with self.subTest(name=name):
                process = self.start(f"{self.command(MPIRUN, output=name)} & echo $!\nwait $!")
                launched = int(process.stdout.readline())
                self.wait_for_history(name)
                os.kill(launched, getattr(signal, "SIG" + name))
                _, stderr = process.communicate(timeout=PATIENCE)
                self.assertEqual(process.returncode, STOPPED, stderr)
                self.assert_stopped(name)

    def test_a_lost_signal(self):
        """A launcher that has not taken TERM, and what it has started, end all the same."""
        started = f"(trap '' TERM; exec -a {self.path('started')} sleep 600)"
        script = f"trap : TERM; echo ready; {started} & while true; do sleep 0.1; done"
        process = self.start(f"launch_stoppable name bash -c {shlex.quote(script)}")
        self.assertEqual(process.stdout.readline(), "ready\n")
        begin = time.monotonic()
        os.kill(process.pid, signal.SIGINT)
        process.communicate(timeout=PATIENCE)
        self.assertNotEqual(process.returncode, DONE)
        self.assertLess(time.monotonic() - begin, AT_ONCE)
        self.wait_for_end("started")

    def test_a_group(self):
        """INT and TERM to all, also to what reads the output of the run."""
        for number in (signal.SIGINT, signal.SIGTERM):
            for reader in ("", " | cat"):
                with self.subTest(number=number, reader=reader):
                    output = f"{number}{len(reader)}"
                    process = self.start(self.command(MPIRUN, output=output) + reader)
                    self.wait_for_history(output)
                    os.killpg(process.pid, number)
                    process.communicate(timeout=PATIENCE)
                    self.assert_stopped(output)

    def test_before_there_is_a_run(self):
        """A signal is not lost, whatever mpirun is at."""
        for milliseconds in range(0, 400, 80):
            with self.subTest(milliseconds=milliseconds):
                output = f"after_{milliseconds}"
                process = self.start(f"echo ready; {self.command(MPIRUN, output=output)}")
                self.assertEqual(process.stdout.readline(), "ready\n")
                time.sleep(milliseconds / 1000)
                os.killpg(process.pid, signal.SIGINT)
                begin = time.monotonic()
                process.communicate(timeout=PATIENCE)
                self.assertNotEqual(process.returncode, DONE)
                self.assertLess(time.monotonic() - begin, AT_ONCE)
                self.wait_for_end(output)


if __name__ == "__main__":
    unittest.main()
