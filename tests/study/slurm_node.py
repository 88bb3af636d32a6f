"""A Slurm of one node, this machine, from Debian's packages slurmctld, slurmd, slurm-client and munge.

All its files lie in one folder; nothing of a Slurm that may be installed is touched. Daemons run as the caller, and
slurmd asks for root.
"""

import os
import shutil
import socket
import subprocess
import time
from pathlib import Path

DAEMONS = ["munged", "slurmctld", "slurmd"]
CONFIGURATION = """ClusterName=sprung
SlurmctldHost={host}
SlurmUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
SlurmctldPort={port}
SlurmdPort={node_port}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
SwitchType=switch/none
ReturnToService=2
NodeName={host} CPUs={cpus} State=UNKNOWN
PartitionName=all Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


def what_is_missing() -> str:
    """Why no Slurm can be started here; "" if one can."""
    absent = [name for name in [*DAEMONS, "sbatch", "squeue"]
              if not shutil.which(name, path=f"{os.environ['PATH']}:/usr/sbin:/sbin")]
    if absent:
        return f"no {', '.join(absent)}: as root, apt-get install slurmctld slurmd slurm-client munge"
    return "" if os.geteuid() == 0 else "slurmd has to be started by root"


def free_port() -> int:
    with socket.socket() as one:
        one.bind(("", 0))
        return one.getsockname()[1]


class SlurmNode:
    """Runs from `with` to its end; `environment` is what sbatch wants."""

    def __init__(self, folder: Path):
        self.folder = folder
        self.environment = {**os.environ, "SLURM_CONF": str(folder / "slurm.conf"),
                            "PATH": f"{os.environ['PATH']}:/usr/sbin:/sbin"}

    def _call(self, *command) -> subprocess.CompletedProcess:
        return subprocess.run([str(part) for part in command], env=self.environment, check=True, capture_output=True,
                              text=True, timeout=60)

    def __enter__(self) -> "SlurmNode":
        for name in ("state", "spool"):
            (self.folder / name).mkdir()
        key = self.folder / "munge.key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o600)
        (self.folder / "slurm.conf").write_text(CONFIGURATION.format(
            host=socket.gethostname().split(".")[0], user="root", folder=self.folder, port=free_port(),
            node_port=free_port(), cpus=os.cpu_count()))
        # --force: a folder under /tmp, which others may write to, is good enough for a key that lives for a test.
        self._call("munged", "--force", f"--key-file={key}", f"--socket={self.folder}/munge.socket",
                   f"--pid-file={self.folder}/munged.pid", f"--log-file={self.folder}/munged.log",
                   f"--seed-file={self.folder}/munge.seed")
        self._call("slurmctld", "-i")
        self._call("slurmd")
        for _ in range(60):
            if "idle" in self._call("sinfo", "--noheader", "--format=%T").stdout:
                return self
            time.sleep(1.0)
        self.__exit__()
        raise RuntimeError("Slurm's node did not come up:\n" + (self.folder / "slurmd.log").read_text()[-2000:])

    def __exit__(self, *_) -> None:
        for name in reversed(DAEMONS):
            file = self.folder / f"{name}.pid"
            if file.exists():
                try:
                    os.kill(int(file.read_text()), 15)
                except ProcessLookupError:
                    pass
        time.sleep(1.0)  # they still write where the caller is about to delete
