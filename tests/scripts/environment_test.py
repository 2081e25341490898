# SPDX-License-Identifier: MIT
"""What scripts/environment.sh finds out about the machine: whether ranks may read each other's memory."""

import ctypes
import json
import os
import platform
import struct
import subprocess
import tempfile
import unittest
from unittest import mock

from run_fabseq import ENVIRONMENT, PROGRAM
from small_parts import plate_2d

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
MECHANISM = "OMPI_MCA_btl_vader_single_copy_mechanism"
PROCESS_VM_READV = {"x86_64": 310, "aarch64": 270}[platform.machine()]


class Filter(ctypes.Structure):
    """The kernel's struct sock_fprog."""

    _fields_ = [("length", ctypes.c_ushort), ("code", ctypes.c_void_p)]


def forbid_reading():
    """A filter as containers have it, for this process and those that it starts: process_vm_readv fails with
    EPERM."""
    load_number, jump_if_equal, end = 0x20, 0x15, 0x06
    code = [(load_number, 0, 0, 0), (jump_if_equal, 0, 1, PROCESS_VM_READV), (end, 0, 0, 0x50001), (end, 0, 0, 0x7FFF0000)]
    text = ctypes.create_string_buffer(b"".join(struct.pack("HBBI", *line) for line in code))
    library = ctypes.CDLL(None)
    no_new_privileges, seccomp, filtered = 38, 22, 2
    done = library.prctl(no_new_privileges, 1, 0, 0, 0)
    done = done or library.prctl(seccomp, filtered, ctypes.byref(Filter(len(code), ctypes.addressof(text))), 0, 0)
    if done:
        raise OSError("no filter of system calls")


class EnvironmentTest(unittest.TestCase):
    def run_after_sourcing(self, line, shell="bash", forbidden=True, **environment):
        inherited = {key: value for key, value in {**ENVIRONMENT, **os.environ}.items() if key != MECHANISM}
        done = subprocess.run([shell, "-c", f". {ROOT}/scripts/environment.sh; {line}"], env={**inherited, **environment},
                              preexec_fn=forbid_reading if forbidden else None, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def test_where_it_is_forbidden(self):
        for shell in ("bash", "sh"):
            self.assertEqual(self.run_after_sourcing(f"echo ${MECHANISM}", shell).stdout, "none\n")

    def test_what_is_set_stays(self):
        self.assertEqual(self.run_after_sourcing(f"echo ${MECHANISM}", **{MECHANISM: "emulated"}).stdout, "emulated\n")

    def test_time_of_fewer_cores(self):
        """A limit of the container (cpu.max), in nested groups and in version 1: rounded up, and never more
        than there are cores."""
        v2, v1, nested = "/sys/fs/cgroup{}/cpu.max", "/sys/fs/cgroup/cpu/cpu.cfs_{}_us", "/sys/fs/cgroup/cpu/a/cpu.cfs_{}_us"
        for expected, files in ((1, {v2.format(""): "50000 100000"}), (2, {v2.format(""): "150000 100000"}),
                                (4, {v2.format(""): "max 100000"}), (4, {v2.format(""): "900000 100000"}), (4, {}),
                                (3, {"/proc/self/cgroup": "0::/a/b", v2.format("/a/b"): "max 100000",
                                     v2.format("/a"): "300000 100000"}),
                                (3, {"/proc/self/cgroup": "0::/a/b", v2.format("/a/b"): "300000 100000",
                                     v2.format("/a"): "max 100000"}),
                                (2, {v1.format("quota"): "200000", v1.format("period"): "100000"}),
                                (1, {"/proc/self/cgroup": "4:cpuset:/\n3:cpu,cpuacct:/a/b\n0::/", nested.format("quota"): "30000",
                                     nested.format("period"): "100000", v1.format("quota"): "-1"}),
                                (4, {v1.format("quota"): "-1", v1.format("period"): "100000"})):
            cases = " ".join(f"{path}) echo '{text}' ;;" for path, text in files.items())
            line = f"cat() {{ case $1 in {cases} *) return 1 ;; esac; }}; env() {{ echo 4; }}; core_count"
            with self.subTest(files=files):
                self.assertEqual(self.run_after_sourcing(line, forbidden=False).stdout, f"{expected}\n")

    def test_runs_side_by_side_share_no_core(self):
        """One rank each: bound, both would be on the first core."""
        say = "mpirun -np 1 grep Cpus_allowed_list /proc/self/status"
        free = {name: value for name, value in os.environ.items() if not name.startswith(("OMPI_MCA_hwloc", "SLURM_"))}
        with mock.patch.dict(os.environ, free, clear=True), mock.patch.dict(ENVIRONMENT):
            ENVIRONMENT.pop("OMPI_MCA_hwloc_base_binding_policy", None)
            allowed = self.run_after_sourcing(say, forbidden=False).stdout.split()[-1]
            self.assertEqual(allowed, self.run_after_sourcing(say.split("1 ")[1], forbidden=False).stdout.split()[-1])
            policy = self.run_after_sourcing("echo ${OMPI_MCA_hwloc_base_binding_policy-unset}", SLURM_JOB_ID="7").stdout
        self.assertEqual(policy, "unset\n")

    def test_nothing_is_set_without_need(self):
        """Where this machine allows it; where it does not, that is found out, too."""
        answer = self.run_after_sourcing(f"can_read_others && echo yes || echo no; echo ${MECHANISM}", forbidden=False).stdout
        self.assertIn(answer, ("yes\n\n", "no\nnone\n"))

    def test_a_run(self):
        """Its ranks exchange messages large enough for that, and say nothing of errors."""
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "plate.json")
            with open(path, "w", encoding="utf-8") as file:
                json.dump(plate_2d(), file)
            done = self.run_after_sourcing(f"mpirun -np 2 {PROGRAM} -config {path} -elements 200,120 -max_iterations 1 "
                                           f"-output {folder}/out", OMPI_MCA_orte_tmpdir_base=folder)
        self.assertNotIn("Read -1", done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main()
