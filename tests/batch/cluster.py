"""A Slurm cluster of one node for tests: munged, slurmctld and slurmd as plain processes with private paths and ports.

    with Cluster(work) as cluster:
        subprocess.run(["sbatch", ...], env=cluster.environment)

Needs root, because slurmd starts tasks as their users. missing() names programs that are not installed.
"""
import os
import pathlib
import shutil
import socket
import subprocess
import time

# A task of a lost node may start again when its old credentials have expired (cred_expire, 120 s by default).
SCHEDULER = "batch_sched_delay=0,sched_interval=1,sched_min_interval=0,bf_interval=1"


def missing():
    """Returns the programs of a cluster that are not installed (packages munge and slurm-wlm)."""
    return [name for name in ("munged", "slurmctld", "slurmd", "sbatch") if not tool(name)]


def tool(name):
    return shutil.which(name, path=os.environ.get("PATH", "") + ":/usr/sbin:/sbin")


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Cluster:
    def __init__(self, work, processors=2):
        self.home = pathlib.Path(work).resolve() / "cluster"
        # A socket's path has at most 107 characters.
        self.munge = pathlib.Path("/run") / f"moiregauge-munge-{os.getpid()}"
        self.processors = processors
        self.processes = {}
        self.environment = dict(os.environ, SLURM_CONF=str(self.home / "slurm.conf"))

    def write_configuration(self):
        host = socket.gethostname().split(".")[0]
        (self.home / "slurm.conf").write_text(f"""ClusterName=moiregauge
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={free_port()}
SlurmdPort={free_port()}
AuthType=auth/munge
AuthInfo=socket={self.munge}/socket,cred_expire=5
CredType=cred/munge
SlurmUser=root
SlurmdUser=root
StateSaveLocation={self.home}/state
SlurmdSpoolDir={self.home}/spool
SlurmctldLogFile={self.home}/slurmctld.log
SlurmdLogFile={self.home}/slurmd.log
SlurmctldPidFile={self.home}/slurmctld.pid
SlurmdPidFile={self.home}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters={SCHEDULER}
AccountingStorageType=accounting_storage/none
MpiDefault=none
ReturnToService=2
KillWait=2
BatchStartTimeout=1
SlurmdTimeout=10
NodeName={host} NodeAddr=127.0.0.1 CPUs={self.processors} State=UNKNOWN
PartitionName=main Nodes={host} Default=YES MaxTime=INFINITE State=UP
""")
        # Newer versions require control groups of systemd unless they are disabled. Older ones do not know this value.
        version = subprocess.run([tool("slurmd"), "-V"], capture_output=True, text=True, check=True).stdout.split()[-1]
        if int(version.split(".")[0]) >= 23:
            (self.home / "cgroup.conf").write_text("CgroupPlugin=disabled\n")

    def start(self, name, *words):
        log = (self.home / f"{name}.log").open("ab")
        self.processes[name] = subprocess.Popen([tool(name), *map(str, words)], stdout=log, stderr=log, env=self.environment)

    def start_slurmd(self):
        self.start("slurmd", "-D", "-f", self.home / "slurm.conf")

    def kill_slurmd(self):
        """Kills the daemon of the node, and what it runs, as a power cut would."""
        steps = self.steps()
        self.processes["slurmd"].kill()
        self.processes["slurmd"].wait()
        for step in steps:
            kill_tree(step)

    def steps(self):
        """Returns the processes that slurmd started, one for each running task."""
        done = subprocess.run(["pgrep", "slurmstepd"], capture_output=True, text=True, check=False)
        return [step for step in map(int, done.stdout.split()) if self.is_mine(step)]

    def is_mine(self, process):
        """Returns true if a process, or one below it, has this cluster in its environment. Newer steps clear their own."""
        try:
            if str(self.home).encode() in pathlib.Path(f"/proc/{process}/environ").read_bytes():
                return True
        except OSError:
            return False
        return any(map(self.is_mine, children(process)))

    def wait_for_steps(self, count, seconds):
        """Waits until `count` tasks run, and returns their processes."""
        deadline = time.time() + seconds
        while len(steps := self.steps()) < count:
            if time.time() > deadline:
                raise RuntimeError(f"{len(steps)} of {count} tasks run: {self.jobs()}")
            time.sleep(0.1)
        return steps

    def task_of(self, step):
        """Returns the job number of a task, e.g. 2, from the step's title `slurmstepd: [2.batch]`."""
        title = pathlib.Path(f"/proc/{step}/cmdline").read_bytes().decode()
        return title.split("[")[1].split(".")[0]

    def jobs(self):
        """Returns the states of all tasks that are queued or run, by task."""
        done = subprocess.run(["squeue", "--noheader", "--array", "--format=%i %T"], env=self.environment,
                              capture_output=True, text=True, check=False)
        return dict(line.split(maxsplit=1) for line in done.stdout.splitlines())

    def wait(self, seconds):
        """Waits until no task is left."""
        deadline = time.time() + seconds
        while self.jobs():
            if time.time() > deadline:
                raise RuntimeError(f"tasks are left: {self.jobs()}")
            time.sleep(0.2)

    def __enter__(self):
        shutil.rmtree(self.home, ignore_errors=True)
        for folder in (self.home / "state", self.home / "spool", self.munge):
            folder.mkdir(parents=True)
        self.munge.chmod(0o700)
        (self.munge / "key").write_bytes(os.urandom(1024))
        (self.munge / "key").chmod(0o400)
        self.write_configuration()
        self.start("munged", "--foreground", "--force", f"--socket={self.munge}/socket", f"--key-file={self.munge}/key",
                   f"--pid-file={self.munge}/pid", f"--log-file={self.munge}/log", f"--seed-file={self.munge}/seed")
        for _ in range(100):
            if (self.munge / "socket").exists():
                break
            time.sleep(0.05)
        self.start("slurmctld", "-D", "-f", self.home / "slurm.conf")
        self.start_slurmd()
        for _ in range(150):
            done = subprocess.run(["sinfo", "--noheader", "--format=%T"], env=self.environment, capture_output=True, text=True, check=False)
            if done.stdout.strip() in ("idle", "mixed"):
                return self
            time.sleep(0.2)
        logs = "".join((self.home / f"{name}.log").read_text()[-2000:] for name in self.processes)
        self.__exit__()
        raise RuntimeError(f"the node did not come up: {done.stdout}{done.stderr}\n{logs}")

    def __exit__(self, *_):
        subprocess.run(["scancel", "--user=root"], env=self.environment, capture_output=True, check=False)
        for step in self.steps():
            kill_tree(step)
        for name in ("slurmd", "slurmctld", "munged"):
            process = self.processes.get(name)
            if process and process.poll() is None:
                process.terminate()
                try:
                    process.wait(10)
                except subprocess.TimeoutExpired:
                    process.kill()
                    process.wait()
        shutil.rmtree(self.munge, ignore_errors=True)


def children(process):
    done = subprocess.run(["pgrep", "-P", str(process)], capture_output=True, text=True, check=False)
    return list(map(int, done.stdout.split()))


def kill_children(process):
    for child in children(process):
        kill_tree(child)


def kill_tree(process):
    """Kills a process and all below it."""
    below = children(process)
    try:
        os.kill(process, 9)
    except ProcessLookupError:
        pass
    for child in below:
        kill_tree(child)
