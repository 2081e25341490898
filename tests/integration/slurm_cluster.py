#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""A Slurm of one node for tests: munged, slurmctld and slurmd of Debian's packages munge and slurm-wlm,
without systemd.

    tests/integration/slurm_cluster.py COMMAND...     runs a command beside such a cluster and ends both

Everything is private to the cluster: key, sockets, ports of the loopback interface, state and logs, all of it
in one new directory. Who shall talk to it needs SLURM_CONF, which points to its slurm.conf
(Cluster.environment). The daemons and all jobs inherit that variable, and by it they are found and ended: by
a process of its own that waits for the end of whoever started the cluster, so that nothing is left over even
if that one is killed.
"""

import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

PATIENCE = 60  # seconds for a daemon to start
DAEMONS = ("munged", "slurmctld", "slurmd")

CONFIG = """\
ClusterName=fabseq_test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller_port}
SlurmdPort={node_port}
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
CredType=cred/munge
# A requeued job waits until the credential of its last start is out of date: 5 seconds are the least.
AuthInfo=socket={directory}/munge.socket,cred_expire=5
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=0,sched_interval=2,sched_min_interval=0
StateSaveLocation={directory}/state
SlurmdSpoolDir={directory}/spool
# Jobs of two clusters have the same numbers, and folders of PMIx there are named by them.
TmpFS={directory}/tmp
SlurmctldPidFile={directory}/slurmctld.pid
SlurmdPidFile={directory}/slurmd.pid
SlurmctldLogFile={directory}/slurmctld.log
SlurmdLogFile={directory}/slurmd.log
SlurmdParameters=config_overrides
ReturnToService=2
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} State=UNKNOWN
PartitionName=test Nodes={host} Default=YES MaxTime=INFINITE State=UP OverSubscribe=NO
"""


class Unavailable(Exception):
    """Slurm cannot start here, with the reason."""


class Cluster:
    """A running cluster, to be used in a with statement. Raises Unavailable if it does not come up.

    cpus: how many of them Slurm hands out; it believes what it is told.
    """

    def __init__(self, cpus=2):
        missing = [name for name in (*DAEMONS, "sbatch", "srun", "scontrol") if not find(name)]
        if missing:
            raise Unavailable(f"{', '.join(missing)} missing: apt-get install slurm-wlm munge")
        if os.geteuid() != 0:
            raise Unavailable("not root")
        self.directory = tempfile.mkdtemp(prefix="fabseq_slurm_")
        self.environment = {**os.environ, "SLURM_CONF": os.path.join(self.directory, "slurm.conf")}
        self.guard = start_guard(self.directory)
        self.daemons = []
        try:
            self.write_files(cpus)
            self.start("munged", "--foreground", "--key-file", self.path("munge.key"), "--socket", self.path("munge.socket"),
                       "--pid-file", self.path("munged.pid"), "--log-file", self.path("munged.log"),
                       "--seed-file", self.path("munge.seed"))
            self.wait_for(lambda: os.path.exists(self.path("munge.socket")), "munged")
            self.start("slurmctld", "-D", "-i")
            self.wait_for(lambda: self.command("scontrol", "ping").returncode == 0, "slurmctld")
            self.start("slurmd", "-D")
            self.wait_for(lambda: self.command("sinfo", "-h", "-o", "%T").stdout.strip() == "idle", "slurmd")
        except BaseException:
            self.stop()
            raise

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stop()

    def path(self, name):
        return os.path.join(self.directory, name)

    def write_files(self, cpus):
        os.chmod(self.directory, 0o755)
        for name in ("state", "spool", "tmp"):
            os.mkdir(self.path(name), 0o755)
        with open(os.open(self.path("munge.key"), os.O_WRONLY | os.O_CREAT, 0o400), "wb") as file:
            file.write(os.urandom(128))
        controller_port, node_port = free_ports(2)
        with open(self.environment["SLURM_CONF"], "w", encoding="utf-8") as file:
            file.write(CONFIG.format(directory=self.directory, host=socket.gethostname().split(".")[0], cpus=cpus,
                                     controller_port=controller_port, node_port=node_port))

    def start(self, name, *arguments):
        with open(self.path(name + ".out"), "w", encoding="utf-8") as output:
            self.daemons.append(subprocess.Popen([find(name), *arguments], env=self.environment, stdin=subprocess.DEVNULL,
                                                 stdout=output, stderr=output, start_new_session=True))

    def wait_for(self, condition, name):
        end = time.monotonic() + PATIENCE
        while not condition():
            status = self.daemons[-1].poll()
            if status is not None or time.monotonic() > end:
                what = "does not answer" if status is None else f"ended with status {status}"
                raise Unavailable(f"{name} {what}; its last words: {' | '.join(self.log(name).splitlines()[-3:]) or 'none'}")
            time.sleep(0.1)

    def log(self, name):
        """What a daemon has written."""
        text = ""
        for path in (self.path(name + ".out"), self.path(name + ".log")):
            if os.path.exists(path):
                with open(path, encoding="utf-8", errors="replace") as file:
                    text += file.read()
        return text

    def command(self, *words, **options):
        """A finished Slurm command."""
        options.setdefault("env", self.environment)
        return subprocess.run(words, capture_output=True, text=True, check=False, **options)

    def stop(self):
        """Ends all daemons and jobs and removes the directory."""
        if self.guard is None:
            return
        self.guard.close()
        self.guard = None
        for daemon in self.daemons:
            daemon.wait(PATIENCE)
        end = time.monotonic() + PATIENCE
        while os.path.exists(self.directory) and time.monotonic() < end:
            time.sleep(0.05)


def find(name):
    """Path of a program; daemons are not on everybody's PATH."""
    return shutil.which(name, path=os.environ.get("PATH", "") + ":/usr/sbin:/sbin")


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


def start_guard(directory):
    """Starts the process that cleans up; it does so once the returned file is closed, or its owner gone.

    It is nobody's child: a test runner that kills a test with all its children leaves it alone.
    """
    reading, writing = os.pipe()
    subprocess.run(["setsid", "--fork", sys.executable, os.path.abspath(__file__), "--clean-up", directory], stdin=reading,
                   check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    os.close(reading)
    return os.fdopen(writing, "w")


def clean_up(directory):
    """Waits for the end of standard input; then ends what belongs to the cluster."""
    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    sys.stdin.read()
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        members = members_of(directory)
        if not members:
            break
        for process in members:
            try:
                os.kill(process, signal.SIGKILL)
            except ProcessLookupError:
                pass
        time.sleep(0.05)
    shutil.rmtree(directory, ignore_errors=True)


def members_of(directory):
    """Processes with this cluster's SLURM_CONF in their environment: daemons, steps and ranks of jobs."""
    mark = f"SLURM_CONF={directory}/slurm.conf".encode()
    members = []
    for name in os.listdir("/proc"):
        if name.isdigit() and int(name) != os.getpid():
            try:
                with open(f"/proc/{name}/environ", "rb") as file:
                    environment = file.read()
                with open(f"/proc/{name}/stat", encoding="utf-8") as file:
                    state = file.read().rpartition(")")[2].split()[0]
            except OSError:  # it has just ended
                continue
            if state not in "ZX" and mark in environment.split(b"\0"):
                members.append(int(name))
    return members


def main():
    if sys.argv[1:2] == ["--clean-up"]:
        clean_up(sys.argv[2])
    elif len(sys.argv) < 2:
        sys.exit(__doc__)
    else:
        try:
            with Cluster() as cluster:
                sys.exit(subprocess.run(sys.argv[1:], env=cluster.environment, check=False).returncode)
        except Unavailable as reason:
            sys.exit(f"slurm_cluster.py: Slurm cannot start here: {reason}")


if __name__ == "__main__":
    main()
