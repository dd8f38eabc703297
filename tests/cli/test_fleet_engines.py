# SPDX-License-Identifier: MIT
"""The same merged bytes from one process, make, GNU parallel, Snakemake and a real Slurm; each is skipped where it is not installed.

With RIPPLENOTCH_FLEET_LOGS=10000 in the environment the fleet has so many logs, of 250 rows each, and what each engine costs is
printed: seconds of a core, the part of both cores that this is (an idle machine asked for), and milliseconds a log beside one process.
"""

import os
import re
import shutil
import socket
import subprocess
import sys
import time

from commands import GEAR, SOURCE, TOOL, new_folder
from commands import SOURCE, TOOL, new_folder
from test_features import Case as FeatureCase

LOGS = int(os.environ.get("RIPPLENOTCH_FLEET_LOGS", "20"))
MANY = LOGS > 100
SHARDS = 40 if MANY else 8
OPTIONS = [*GEAR, "--date-from-name", "{robot}_%Y-%m-%d.csv"]


def spent(before):
    after = os.times()
    return after.children_user + after.children_system - before.children_user - before.children_system


class Engine(FeatureCase):
    def setUp(self):
        super().setUp()
        self.small_fleet(LOGS, 250 if MANY else None)
        bad = self.folder / "list.txt"
        bad.write_text(bad.read_text() + "missing_2026-05-05.csv\n")
        self.environment = dict(os.environ, RIPPLENOTCH=TOOL, LC_ALL="C.UTF-8", HOME=str(self.folder))

    counts_cpu = True  # its workers are children of this process
    one_process = None  # bytes of one process and its seconds of a core: the same for each engine

    def whole(self):
        if Engine.one_process is None:
            before = os.times()
            text = self.run_tool("features", "--manifest", "list.txt", *OPTIONS, text=False).stdout
            Engine.one_process = text, spent(before)
        return Engine.one_process[0]

    def measured(self, *words):
        """The engine's first run; what it cost is printed for many logs."""
        self.whole()
        before = os.times()
        done = self.call(*words)
        cpu, wall = spent(before), os.times().elapsed - before.elapsed
        if MANY and not self.counts_cpu:
            print(f"{type(self).__name__}: {LOGS} logs in {SHARDS} shards in {wall:.1f} s", file=sys.stderr, flush=True)
        elif MANY:
            more = (cpu - Engine.one_process[1]) / LOGS * 1e3
            print(f"{type(self).__name__}: {LOGS} logs in {SHARDS} shards: {cpu:.1f} s of a core in {wall:.1f} s, {50 * cpu / wall:.0f} % "
                  f"of two cores, {more:+.2f} ms a log beside one process ({Engine.one_process[1]:.1f} s)", file=sys.stderr, flush=True)
        return done

    def need(self, *programs):
        for program in programs:
            if shutil.which(program) is None:
                self.skipTest(f"{program} is not installed")

    def call(self, *words, timeout=300 + LOGS):
        return subprocess.run([str(word) for word in words], cwd=self.folder, env=self.environment, capture_output=True, text=True, timeout=timeout)

    def check(self, done):
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual((self.folder / "shards.ndjson").read_bytes(), self.whole())
        self.assertEqual(len(list((self.folder / "shards").glob("*.done.json"))), SHARDS)

    def lose_a_shard(self):
        for path in (self.folder / "shards").glob("shard-000003-*"):
            path.unlink()
        (self.folder / "shards.ndjson").unlink()
        return {path.name: path.stat().st_ino for path in (self.folder / "shards").glob("*.ndjson")}

    def check_resumed(self, done, before):
        self.check(done)
        after = {path.name: path.stat().st_ino for path in (self.folder / "shards").glob("*.ndjson")}
        self.assertEqual({name: after[name] for name in before}, before, "a complete shard was done again")


class Make(Engine):
    def test_the_same_bytes_and_only_what_is_missing(self):
        self.need("make")
        options = " ".join(f"'{word}'" for word in OPTIONS)
        words = ["make", "-j2", "-f", SOURCE / "scripts/fleet/Makefile", f"SHARDS={SHARDS}", f"OPTIONS={options}", f"RIPPLENOTCH={TOOL}"]
        self.check(self.measured(*words))
        before = self.lose_a_shard()
        self.check_resumed(self.call(*words), before)


class GnuParallel(Engine):
    def test_the_same_bytes_and_only_what_is_missing(self):
        self.need("parallel")
        if "GNU" not in subprocess.run(["parallel", "--version"], capture_output=True, text=True).stdout:
            self.skipTest("this parallel is not GNU's")
        words = [SOURCE / "scripts/fleet/gnu-parallel", "list.txt", "shards", SHARDS, "--", *OPTIONS]
        self.check(self.measured(*words))
        before = self.lose_a_shard()
        self.check_resumed(self.call(*words), before)


class Snakemake(Engine):
    def test_the_same_bytes_and_only_what_is_missing(self):
        self.need("snakemake")
        options = " ".join(f"'{word}'" for word in OPTIONS)
        words = ["snakemake", "-s", SOURCE / "scripts/fleet/Snakefile", "--profile", SOURCE / "scripts/fleet/profiles/local", "--cores", "2",
                 "--config", f"shards={SHARDS}", f"options={options}", f"tool={TOOL}"]
        self.check(self.measured(*words))
        before = self.lose_a_shard()
        self.check_resumed(self.call(*words), before)


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


CONFIGURATION = """ClusterName=fleet
SlurmctldHost=localhost(127.0.0.1)
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
SlurmctldPort={control}
SlurmdPort={worker}
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=0,sched_min_interval=0,sched_interval=1
MaxArraySize=6
ReturnToService=2
NodeName=fleet1 NodeHostname=localhost NodeAddr=127.0.0.1 Port={worker} CPUs=2 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


class Slurm(Engine):
    """A cluster of one node on the loopback, in a folder of its own, gone with the test."""

    counts_cpu = False

    def setUp(self):
        self.need("slurmctld", "slurmd", "munged", "sbatch", "scontrol")
        if os.geteuid() != 0:
            self.skipTest("a cluster is started by root alone")
        super().setUp()
        self.cluster = new_folder(self)
        self.cluster.chmod(0o755)
        for name in ("state", "spool"):
            (self.cluster / name).mkdir()
        (self.cluster / "munge.key").write_bytes(os.urandom(128))
        (self.cluster / "munge.key").chmod(0o600)
        configuration = self.cluster / "slurm.conf"
        configuration.write_text(CONFIGURATION.format(folder=self.cluster, control=free_port(), worker=free_port()))
        self.environment["SLURM_CONF"] = str(configuration)
        self.daemon("munged", "--foreground", "--force", f"--key-file={self.cluster}/munge.key", f"--socket={self.cluster}/munge.socket",
                    f"--pid-file={self.cluster}/munged.pid", f"--log-file={self.cluster}/munged.log", f"--seed-file={self.cluster}/munged.seed")
        self.wait_for(lambda: (self.cluster / "munge.socket").exists(), "munged")
        self.daemon("slurmctld", "-D")
        self.daemon("slurmd", "-D", "-N", "fleet1")
        self.wait_for(lambda: "idle" in self.call("sinfo", "-h", "-o", "%T").stdout, "the node")

    def daemon(self, *words):
        log = open(self.cluster / f"{words[0]}.out", "wb")
        started = subprocess.Popen(words, env=self.environment, stdout=log, stderr=log, start_new_session=True)

        def end():
            started.terminate()
            try:
                started.wait(10)
            except subprocess.TimeoutExpired:
                started.kill()
                started.wait()
            log.close()
        self.addCleanup(end)

    def wait_for(self, ready, what):
        for _ in range(300):
            if ready():
                return
            time.sleep(0.1)
        logs = "\n".join(path.read_text(errors="replace")[-600:] for path in self.cluster.glob("*.out"))
        logs += "\n".join(path.read_text(errors="replace")[-600:] for path in self.cluster.glob("*.log"))
        self.skipTest(f"{what} does not start here: {re.sub(r'[^ -~]+', ' ', logs)}")

    def test_the_same_bytes_by_arrays_in_windows_and_only_what_is_missing(self):
        words = [SOURCE / "scripts/fleet/slurm-array", "list.txt", "shards", SHARDS, "--", *OPTIONS]
        self.check(self.measured(*words))
        jobs = self.call("scontrol", "-o", "show", "jobs").stdout
        self.assertGreaterEqual(len(set(re.findall(r"ArrayJobId=(\d+)", jobs))), 2, "eight shards are two windows of five at most")
        before = self.lose_a_shard()
        self.check_resumed(self.call(*words), before)
