"""dask.py DRIVER ORTHANT SWEEP RESULTS: a scheduler and two workers on loopback, one of them killed midway."""
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

driver, orthant, sweep, results = sys.argv[1:]
python = [sys.executable, "-s", "-E"]


def wait_for(holds, words, seconds=300):  # a case takes ten seconds under the thread sanitizer
    until = time.monotonic() + seconds
    while not holds():
        if time.monotonic() > until:
            sys.exit(f"waited in vain: {words}")
        time.sleep(0.02)


def rows():
    reply = subprocess.run([orthant, "results", results, "--csv"], capture_output=True, text=True)
    return max(0, reply.stdout.count("\n") - 1)


def main(folder, processes):
    def start(*words):
        log = open(folder / f"{len(processes)}.log", "w")
        processes.append(subprocess.Popen([*python, *words], stdout=log, stderr=log, cwd=folder,
                                          start_new_session=True))
        return processes[-1]

    told = folder / "scheduler.json"
    start("-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard",
          "--scheduler-file", told)
    wait_for(told.exists, "the scheduler")
    workers = [start("-m", "distributed.cli.dask_worker", "--scheduler-file", told, "--nthreads", "1", "--no-nanny",
                     "--no-dashboard", "--host", "127.0.0.1") for _ in range(2)]
    address = json.loads(told.read_text())["address"]
    running = start(driver, sweep, "--results", results, "--scheduler", address, "--orthant", orthant)
    wait_for(lambda: rows() >= 4 or running.poll() is not None, "the first rows")
    before = rows()
    os.kill(workers[0].pid, signal.SIGKILL)
    wait_for(lambda: running.poll() is not None, "the end")
    print(f"{before} rows when the worker was killed, {rows()} at the end")
    if running.returncode:
        print((folder / "3.log").read_text())
    return running.returncode


with tempfile.TemporaryDirectory() as folder:
    started = []
    try:
        code = main(Path(folder), started)
    finally:
        for process in started:
            process.kill()
            process.wait()
sys.exit(code)
