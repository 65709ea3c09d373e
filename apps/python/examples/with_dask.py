"""An ensemble in shards on the workers of a Dask cluster: with_dask.py ENSEMBLE DIR [SHARDS]

Needs dask.distributed, and folders that all workers see. DASK_SCHEDULER_ADDRESS names the cluster; without it two workers start on
this machine. The folder has the bytes of a run on one machine. A shard that was cut off goes on where it was.
"""
import os
import subprocess
import sys

from dask.distributed import Client, as_completed

PROGRAM = os.environ.get("FRANA_PROGRAM", "frana")


def shard(part, file, folder):
    subprocess.run([PROGRAM, "ensemble", file, "--out", folder, "--shard", part, "--threads", "1", "--resume", "--quiet"], check=True)
    return part


def main(file, folder, shards):
    address = os.environ.get("DASK_SCHEDULER_ADDRESS")
    alone = {} if address else {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": None}
    with Client(address, **alone) as client:
        parts = [client.submit(shard, f"{n}/{shards}", file, folder, pure=False) for n in range(shards)]
        for done in as_completed(parts):
            print("shard", done.result())
    subprocess.run([PROGRAM, "ensemble", "--join", folder, "--quiet"], check=True)


if __name__ == "__main__":  # workers import this file
    main(os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2]), int(sys.argv[3]) if len(sys.argv) > 3 else 4)
