"""A sweep by the workers of a Dask scheduler, into the same results file as `orthant sweep` writes.

Each worker runs `orthant sweep FILE --case KEY`, so it needs the same build and the same files at the same places (a
folder that all machines share). Rows are kept here, as they come: a worker that dies costs the case that it had, which
another one gets; stopped here and started again, what is missing is done. Timed cases are timed on workers as busy as
they are.

    sweep_dask.py experiments/studies/slider_crank.sweep.toml --results OUT.sqlite [--scheduler tcp://host:8786] \\
        [--quick]
"""
import argparse
import subprocess
import sys
from pathlib import Path

from distributed import Client, as_completed

ROOT = Path(__file__).resolve().parents[2]


def run_case(command, key):
    return subprocess.run([*command, "--case", key], check=True, capture_output=True, text=True).stdout


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sweep", type=Path)
    parser.add_argument("--results", required=True, type=Path)
    parser.add_argument("--scheduler", help="address; default: workers of this machine, one a core")
    parser.add_argument("--quick", action="store_true", help="the reduced grid")
    parser.add_argument("--retry", action="store_true", help="what a time limit or a crash ended once more")
    parser.add_argument("--max-input", metavar="SIZE", help="largest file that is read, as of orthant")
    parser.add_argument("--orthant", type=Path, default=ROOT / "build/release/orthant", help="default: %(default)s")
    a = parser.parse_args()

    command = [str(a.orthant.resolve()), "sweep", str(a.sweep.resolve()), *(["--quick"] if a.quick else []),
               *(["--max-input", a.max_input] if a.max_input else [])]
    listed = subprocess.run([*command, "--results", a.results, "--list", *(["--retry"] if a.retry else [])],
                            stdout=subprocess.PIPE, text=True)
    if listed.returncode:
        sys.exit(listed.returncode)
    keys = listed.stdout.split()
    # No dashboard: nothing listens but what the sweep needs.
    with Client(a.scheduler) if a.scheduler else Client(threads_per_worker=1, dashboard_address=None) as client:
        futures = [client.submit(run_case, command, key, key=f"case-{key}", retries=2) for key in keys]
        store = subprocess.Popen([command[0], "results", a.results, "--add"], stdin=subprocess.PIPE, text=True)
        done = failed = 0
        for future in as_completed(futures):
            if future.status == "finished":
                store.stdin.write(future.result())
                store.stdin.flush()
                done += 1
            else:
                failed += 1
                print(f"{future.key}: {future.exception()!r}", file=sys.stderr)
            future.release()
            if (done + failed) % max(1, len(keys) // 10) == 0:
                print(f"{done + failed}/{len(keys)}, {failed} lost", file=sys.stderr)
        store.stdin.close()
        sys.exit(store.wait() or (1 if failed else 0))


if __name__ == "__main__":
    main()
