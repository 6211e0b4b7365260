"""A sweep in four shards: one worker is killed midway, no case is lost or doubled. shards.py ORTHANT"""
import csv
import io
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[2] / "experiments/scripts/sweep_shards.py"
CASES = 40
SWEEP = """
scene = "bouncing_ball"
duration = 0.3
measure = "ball.y"
reference = "event-driven:rtol=1e-12"
[[grid]]
integrator = ["moreau-jean", "rattle"]
step = {from = 4e-3, to = 1e-3, count = 20, scale = "log"}
"""
TIMES = {"seconds", "slowest"}  # differ from run to run


def table(orthant, folder, file):
    text = subprocess.run([orthant, "results", file, "--csv"], cwd=folder, capture_output=True, text=True,
                          check=True).stdout
    return [{k: v for k, v in row.items() if k not in TIMES} for row in csv.DictReader(io.StringIO(text))]


def main(orthant):
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        (folder / "a.sweep.toml").write_text(SWEEP)

        def start(verb, *options, **environment):
            return subprocess.Popen(
                [sys.executable, SCRIPT, verb, "a.sweep.toml", "--folder", "shards", "--orthant", orthant, *options],
                cwd=folder, stdout=subprocess.PIPE, text=True, env={**os.environ,
                                                                    **environment}, start_new_session=True)

        def run(verb, *options):
            process = start(verb, *options)
            return process.communicate()[0], process.returncode

        subprocess.run([orthant, "sweep", "a.sweep.toml", "--results", "whole.sqlite"], cwd=folder, check=True,
                       capture_output=True)
        assert run("split", "--results", "out.sqlite", "--shards", "4") == (f"{CASES} cases in 4 shards\n", 0)
        workers = [start("work", SLURM_ARRAY_TASK_ID=str(k)) for k in range(4)]
        rows = folder / "shards/rows.2"
        while not rows.exists() or rows.stat().st_size == 0:
            time.sleep(0.002)
        os.killpg(workers[2].pid, signal.SIGKILL)  # the program that it runs as well
        assert [w.wait() for w in workers] == [0, 0, -signal.SIGKILL, 0]
        with rows.open("a") as out:
            out.write('{"key": "cut sh')  # as a full disk leaves it
        out, code = run("merge", "--results", "out.sqlite")
        assert code == 1 and not out.endswith(" 0 cases missing\n"), out  # else it was killed too late to tell anything
        before = (folder / "shards/rows.0").read_bytes()
        assert run("work", "--shard", "2")[1] == 0
        assert '{"key": "cut sh' in rows.read_text().split("\n")  # and nothing after it in its line
        assert run("work", "--shard", "0")[1] == 0  # nothing to do
        assert (folder / "shards/rows.0").read_bytes() == before
        out, code = run("merge", "--results", "out.sqlite")
        assert code == 0 and out.endswith(" 0 cases missing\n"), out
        whole = table(orthant, folder, "whole.sqlite")
        assert len(whole) == CASES and table(orthant, folder, "out.sqlite") == whole
        # Rows that a new split would lose stay.
        assert run("split", "--results", "other.sqlite")[1] == 1 and rows.exists()


main(sys.argv[1])
