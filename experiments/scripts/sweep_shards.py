#!/usr/bin/env python3
"""A sweep in shards: for SLURM arrays, or processes of this machine; the rows end in one results file.

    sweep_shards.py split FILE --results OUT.sqlite --shards 64 --folder SHARDS   # deals the missing cases out
    sbatch --array=0-63 --wrap "sweep_shards.py work FILE --folder SHARDS"        # shard: $SLURM_ARRAY_TASK_ID
    sweep_shards.py work FILE --folder SHARDS --shard 3                           # the same by hand
    sweep_shards.py merge FILE --results OUT.sqlite --folder SHARDS               # exit code 1 while cases are missing

A worker writes each finished case at once, a line of JSON in SHARDS/rows.N, under a lock: two workers of one shard take
turns, a killed one loses the case that it had. Started again it does what is missing. `merge` may run at any time and
as often as wanted; a line cut short is left out. SHARDS lies on a disk that all machines share, the SQLite file on a
local one. All machines need the same build at the same place: a case's key names the revision.
"""
import argparse
import fcntl
import json
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def rows_of(path):
    """The complete lines of a shard's file, by key."""
    rows = {}
    for line in path.read_bytes().split(b"\n") if path.exists() else []:
        try:
            row = json.loads(line)
            rows[row["key"]] = line.decode()
        except (ValueError, KeyError, TypeError):
            continue
    return rows


def split(a, command):
    listed = subprocess.run([*command, "--results", a.results, "--list"], check=True, stdout=subprocess.PIPE, text=True)
    keys = listed.stdout.split()
    a.folder.mkdir(parents=True, exist_ok=True)
    for old in [*a.folder.glob("keys.*"), *a.folder.glob("rows.*")]:
        if old.name.startswith("rows.") and rows_of(old):
            sys.exit(f"{old}: holds rows: merge first, then delete the folder")
        old.unlink()
    for shard in range(a.shards):  # dealt in turn: neighbours in a sweep cost about the same
        (a.folder / f"keys.{shard}").write_text("\n".join(keys[shard::a.shards]) + "\n")
    print(f"{len(keys)} cases in {a.shards} shards")


def work(a, command):
    shard = a.shard if a.shard is not None else os.environ.get("SLURM_ARRAY_TASK_ID")
    if shard is None:
        sys.exit("sweep_shards: --shard: required outside of a SLURM array")
    keys = (a.folder / f"keys.{shard}").read_text().split()
    path = a.folder / f"rows.{shard}"
    with path.open("ab+") as out:
        fcntl.flock(out, fcntl.LOCK_EX)
        done = rows_of(path)
        if path.stat().st_size and not path.read_bytes().endswith(b"\n"):
            out.write(b"\n")  # after a line that was cut short
        for key in keys:
            if key in done:
                continue
            result = subprocess.run([*command, "--case", key], check=True, stdout=subprocess.PIPE)
            out.write(result.stdout if result.stdout.endswith(b"\n") else result.stdout + b"\n")
            out.flush()
            os.fsync(out.fileno())


def merge(a, command):
    rows = {}
    for path in sorted(a.folder.glob("rows.*")):
        for line in path.read_bytes().split(b"\n"):
            try:
                row = json.loads(line)
                rows.setdefault(row["key"], line)
            except (ValueError, KeyError, TypeError):
                continue
    subprocess.run([command[0], "results", a.results, "--add"], check=True,
                   input=b"".join(line + b"\n" for line in rows.values()))
    missing = subprocess.run([*command, "--results", a.results, "--list"], check=True, stdout=subprocess.PIPE,
                             text=True).stdout.split()
    print(f"{len(rows)} rows, {len(missing)} cases missing")
    return 1 if missing else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("verb", choices=["split", "work", "merge"])
    parser.add_argument("sweep", type=Path)
    parser.add_argument("--folder", required=True, type=Path, help="of the shards")
    parser.add_argument("--results", type=Path, help="SQLite file, of split and merge")
    parser.add_argument("--shards", type=int, default=4, help="default: %(default)s")
    parser.add_argument("--shard", type=int, help="which one; default: $SLURM_ARRAY_TASK_ID")
    parser.add_argument("--quick", action="store_true", help="the reduced grid")
    parser.add_argument("--orthant", type=Path, default=ROOT / "build/release/orthant", help="default: %(default)s")
    a = parser.parse_args()
    if a.verb != "work" and a.results is None:
        parser.error(f"--results: required by {a.verb}")
    if a.shards < 1:
        parser.error(f"--shards = {a.shards}: must be at least 1")
    command = [str(a.orthant.resolve()), "sweep", str(a.sweep.resolve()), *(["--quick"] if a.quick else [])]
    try:
        return {"split": split, "work": work, "merge": merge}[a.verb](a, command)
    except (subprocess.CalledProcessError, OSError) as error:
        sys.exit(f"sweep_shards: {error}")


if __name__ == "__main__":
    sys.exit(main())
