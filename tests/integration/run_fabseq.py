# SPDX-License-Identifier: MIT
"""Runs fabseq as users do, under mpirun or, on one rank, without, for the tests of this folder.

FABSEQ_PROGRAM names the binary (default: build/release/fabseq), FABSEQ_SANITIZED=1 says that it is a slow
one, instrumented with sanitizers. With FABSEQ_NO_SKIPS, a skipped test is an error unless the reason is
one of this build or is matched by the regular expression FABSEQ_MAY_SKIP."""

import contextlib
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

from compare_runs import assert_same_run

HERE = os.path.dirname(os.path.realpath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
PROGRAM = os.path.abspath(os.environ.get("FABSEQ_PROGRAM", os.path.join(ROOT, "build", "release", "fabseq")))
SANITIZED = os.environ.get("FABSEQ_SANITIZED", "0") not in ("", "0", "OFF", "FALSE")
REFERENCE_DATA = os.path.join(ROOT, "tests", "data", "reference")

DONE, BAD_INPUT, NUMERICAL_FAILURE, STOPPED, OUTPUT_FAILURE = 0, 2, 3, 4, 5

OF_THIS_BUILD = "of this build: "  # how the reason begins where another build runs what is skipped
only_release = unittest.skipIf(SANITIZED, OF_THIS_BUILD + "the sanitizers make this too slow: runs in the release build")


def distinct(*cases):
    """The cases that a test repeats itself with. Sanitizers look for code paths: the first will do there."""
    return cases[:1] if SANITIZED else cases


ENVIRONMENT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OPENBLAS_NUM_THREADS": "1",
               "OMP_NUM_THREADS": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1",
               "OMPI_MCA_hwloc_base_binding_policy": "none", "OMPI_MCA_mpi_yield_when_idle": "1",
               "OMPI_MCA_pml": "ob1",  # what Open MPI takes here, too, after it has looked for networks
               "OMPI_MCA_orte_allowed_exit_without_sync": "1",  # scripts/environment.sh says why
               "OMPI_MCA_ess_singleton_isolated": "1",  # a program without mpirun starts no daemon of Open MPI
               "HWLOC_COMPONENTS": "-gl",  # mpirun would be killed when an X server that it has looked at goes away
               "ASAN_OPTIONS": "detect_leaks=0:detect_odr_violation=0"}
# Seconds that mpirun sleeps once a rank has ended with a status other than 0, even if all are gone by then.
FORCED_ENVIRONMENT = {"OMPI_MCA_odls_base_sigkill_timeout": "0"}


class Result:
    """What a run left: exit status, its two streams, the output directory."""

    def __init__(self, command, status, stdout, stderr, output):
        self.command, self.status, self.stdout, self.stderr, self.output = command, status, stdout, stderr, output

    def messages(self):
        """Lines on stderr but for those of mpirun, which stand between lines of dashes, and its libevent."""
        lines, of_mpirun = [], False
        for line in self.stderr.splitlines():
            if re.fullmatch("-{60,}", line.strip()):
                of_mpirun = not of_mpirun
            elif not of_mpirun and line.strip() and not line.startswith("[warn] Epoll "):
                lines.append(line)
        return lines

    def path(self, name):
        return os.path.join(self.output, name)

    def json(self, name):
        with open(self.path(name), encoding="utf-8") as file:
            return json.load(file)

    def history(self):
        with open(self.path("history.jsonl"), encoding="utf-8") as file:
            return [json.loads(line) for line in file if line.endswith("\n")]  # the program may be writing the last one

    def __str__(self):
        return f"{' '.join(self.command)}\nexit status {self.status}\nstdout:\n{self.stdout}stderr:\n{self.stderr}"


class Process:
    """A command under way, to be used in a with statement."""

    def __init__(self, command, directory, environment=None):
        self.command = command
        self.streams = [tempfile.TemporaryFile("w+", encoding="utf-8", errors="backslashreplace") for _ in range(2)]
        # Of its own: an mpirun that starts trips over the common folder that another, which ends, is
        # removing.
        self.sessions = tempfile.TemporaryDirectory(prefix="fabseq_mpirun_", ignore_cleanup_errors=True)
        variables = {**ENVIRONMENT, **os.environ, **FORCED_ENVIRONMENT, "OMPI_MCA_orte_tmpdir_base": self.sessions.name,
                     **(environment or {})}
        self.process = subprocess.Popen(command, cwd=directory, env=variables, stdin=subprocess.DEVNULL,
                                        stdout=self.streams[0], stderr=self.streams[1], start_new_session=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.end()
        for stream in self.streams:
            stream.close()
        self.sessions.cleanup()

    def end(self):
        if self.process.poll() is not None:
            return
        os.killpg(self.process.pid, signal.SIGTERM)  # mpirun ends its ranks, which have groups of their own
        try:
            self.process.wait(30)
        except subprocess.TimeoutExpired:
            os.killpg(self.process.pid, signal.SIGKILL)
            self.process.wait()

    def ranks(self):
        """Processes that mpirun has started."""
        path = f"/proc/{self.process.pid}/task/{self.process.pid}/children"
        with open(path, encoding="utf-8") as file:
            return [int(word) for word in file.read().split()]

    def wait(self, timeout):
        """Status, stdout and stderr of the command, which must end within `timeout` seconds."""
        hangs = False
        try:
            self.process.wait(timeout)
        except subprocess.TimeoutExpired:
            hangs = True
            self.end()
        texts = []
        for stream in self.streams:
            stream.seek(0)
            texts.append(stream.read())
        if hangs:
            raise AssertionError(f"no end after {timeout} s: {' '.join(self.command)}\n{texts[0]}{texts[1]}")
        return self.process.returncode, texts[0], texts[1]


def run_command(command, directory, timeout):
    """Status, stdout and stderr of a command that must end within `timeout` seconds."""
    with Process(command, directory) as process:
        return process.wait(timeout)


def launcher(ranks):
    return ["mpirun", "-np", str(ranks)] if ranks > 1 else []


def build_preload(directory, name):
    """Path of tests/faults/NAME.cc, compiled in that directory as a library to be preloaded (LD_PRELOAD)."""
    library = os.path.join(directory, name + ".so")
    source = os.path.join(ROOT, "tests", "faults", name + ".cc")
    subprocess.run(["g++", "-std=c++20", "-O1", "-fPIC", "-shared", "-o", library, source, "-ldl"], check=True)
    return library


class NoSmallDisk(Exception):
    """Why a small disk cannot be had here."""


@contextlib.contextmanager
def small_disk(path, size):
    """A disk in memory of that size (as mount takes it), mounted at `path`, a folder that this makes,
    within a with statement; raises NoSmallDisk."""
    os.mkdir(path)
    if os.geteuid() != 0:
        raise NoSmallDisk("only root can mount a small disk")
    mount = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=" + size, "tmpfs", path],
                           capture_output=True, text=True, check=False)
    if mount.returncode != 0:
        raise NoSmallDisk("a small disk cannot be mounted here: " + mount.stderr.strip())
    try:
        yield path
    finally:
        subprocess.run(["umount", "--lazy", path], check=False)


class FabseqTest(unittest.TestCase):
    """A test with a working directory of its own, `directory`."""

    # Whether optimizations are repeated in two halves, stopped and continued, which must come to the same
    # bytes: three runs in place of one. A test sets it for what restart_test does not know. Sanitizers do
    # without.
    resumes = False

    def setUp(self):
        self.directory = tempfile.mkdtemp(prefix="fabseq_test_")
        self.addCleanup(shutil.rmtree, self.directory, ignore_errors=True)
        self.runs = 0

    def small_disk(self, size):
        """A small disk (see small_disk) in the working directory until the test ends; skips the test where
        it cannot be had."""
        stack = contextlib.ExitStack()
        self.addCleanup(stack.close)
        try:
            return stack.enter_context(small_disk(os.path.join(self.directory, "disk"), size))
        except NoSmallDisk as reason:
            return self.skipTest(str(reason))

    def write_config(self, config, name="case.json"):
        """Writes a config (a dict, or text) into the working directory and returns its path."""
        path = os.path.join(self.directory, name)
        with open(path, "w", encoding="utf-8") as file:
            file.write(config if isinstance(config, str) else json.dumps(config))
        return path

    def run_program(self, ranks, *arguments, output=None, timeout=None):
        """Runs `mpirun -np ranks fabseq arguments -output output` in the working directory; a single rank
        without mpirun, with which it takes twice as long to start.

        output: a new directory by default, "" for a command line without -output.
        """
        self.runs += 1
        if output is None:
            output = os.path.join(self.directory, f"output_{self.runs}")
        command = [*launcher(ranks), PROGRAM, *(str(argument) for argument in arguments)]
        if output:
            command += ["-output", output]
        if timeout is None:
            timeout = 600 if SANITIZED else 300
        result = Result(command, *run_command(command, self.directory, timeout), output)
        if self.resumes and not SANITIZED and output and result.status == DONE and "-restart" not in command:
            self.check_resumed(ranks, [str(argument) for argument in arguments], result, timeout)
        return result

    def check_resumed(self, ranks, arguments, expected, timeout):
        """Repeats an optimization with a stop after half of its iterations, and compares."""
        if not os.path.exists(expected.path("history.jsonl")) or len(expected.history()) < 2:
            return
        output = os.path.join(self.directory, f"resumed_{self.runs}")
        os.mkdir(output)
        half = len(expected.history()) // 2
        with open(os.path.join(output, "stop"), "w", encoding="utf-8") as file:
            file.write(f"{half}\n")
        command = [*launcher(ranks), PROGRAM, *arguments, "-output", output, "-restart", "auto"]
        command = [word for word in command if word != "-overwrite"]
        stopped = Result(command, *run_command(command, self.directory, timeout), output)
        self.assertEqual(stopped.status, STOPPED, str(stopped))
        self.assertEqual(len(stopped.history()), half, str(stopped))
        self.assertEqual(stopped.json("summary.json")["status"], "stopped")
        resumed = Result(command, *run_command(command, self.directory, timeout), output)
        self.assertEqual(resumed.status, DONE, str(resumed))
        self.assertIn(f"continues after iteration {half} of", resumed.stdout)
        assert_same_run(self, resumed, expected, ranks)
        shutil.rmtree(output)

    def wait_for_history(self, process, output):
        """Waits until a run that goes on (a Process) has completed an iteration."""
        end = time.monotonic() + 120
        while not os.path.exists(os.path.join(output, "history.jsonl")):
            self.assertIsNone(process.process.poll(), "the run has ended by itself")
            self.assertLess(time.monotonic(), end)
            time.sleep(0.02)

    def run_config(self, ranks, config, *arguments, **options):
        """As run_program, of a config (a dict, text, or a path)."""
        path = config if isinstance(config, str) and os.path.exists(config) else self.write_config(config)
        return self.run_program(ranks, "-config", path, *arguments, **options)

    # Of optimize(), unless it is told.
    iterations = 4

    def optimize(self, config, ranks=1, iterations=None, *arguments):
        """A short optimization, solved closely, with fields and checkpoints every second iteration."""
        iterations = iterations or self.iterations
        run = self.run_config(ranks, config, "-max_iterations", iterations, "-output_every", 2, "-checkpoint_every", 2,
                              "-tolerance", "1e-11", *arguments)
        self.assert_done(run)
        self.assertEqual(len(run.history()), iterations)
        return run

    def simulate(self, config, *options):
        """A simulation of binary layers on one rank."""
        run = self.run_config(1, config, "-task", "simulate", "-binary", *options)
        self.assert_done(run)
        return run

    def run_tool(self, *words):
        """Runs `fabseq-tools words` in the working directory, with the program under test."""
        tools = os.path.join(ROOT, "scripts", "fabseq-tools")
        return subprocess.run([sys.executable, tools, *map(str, words)], capture_output=True, text=True, cwd=self.directory,
                              check=False, env={**ENVIRONMENT, **os.environ, "FABSEQ_PROGRAM": PROGRAM})

    def assert_done(self, result):
        self.assertEqual(result.status, DONE, str(result))
        self.assertEqual([line for line in result.messages() if not line.startswith("warning: ")], [], str(result))

    def tree(self):
        """All paths below the working directory with size and time of change."""
        entries = {}
        for folder, folders, files in os.walk(self.directory):
            for name in folders + files:
                path = os.path.join(folder, name)
                status = os.lstat(path)
                entries[path] = (status.st_size, status.st_mtime_ns)
        return entries


def largest_relative_difference(values, expected):
    """Of two nested lists of numbers of the same form; entries that are 0 in both do not count."""
    if isinstance(expected, (list, tuple)):
        if len(values) != len(expected):
            raise AssertionError(f"{len(values)} entries in place of {len(expected)}")
        return max((largest_relative_difference(v, e) for v, e in zip(values, expected, strict=True)), default=0.0)
    if values == expected:
        return 0.0
    return abs(values - expected) / max(abs(values), abs(expected))


def must_run(reason):
    """Whether it is an error to skip a test for that reason (FABSEQ_NO_SKIPS)."""
    allowed = os.environ.get("FABSEQ_MAY_SKIP")
    return bool(os.environ.get("FABSEQ_NO_SKIPS")) and not reason.startswith(OF_THIS_BUILD) and not (
        allowed and re.search(allowed, reason))


class Runner(unittest.TextTestRunner):
    """Makes errors of skipped tests that have to run."""

    def run(self, test):
        result = super().run(test)
        for skipped, reason in result.skipped:
            if must_run(reason):
                print(f"error: {skipped} was skipped: {reason}", file=sys.stderr)
                result.unexpectedSuccesses.append(skipped)
        return result


def main():
    if not os.access(PROGRAM, os.X_OK):
        sys.exit(f"{PROGRAM} is missing: scripts/setup.sh builds it")
    unittest.main(verbosity=2, testRunner=Runner)
