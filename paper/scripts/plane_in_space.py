"""The planar slider-crank built in space, upright and turned, against its planar exact motion: plane_in_space.py
ORTHANT DATA. Writes plane_in_space.csv and its about.

error: of the crank angle at the end [rad]. event_error: of event-driven, the largest relative error of the time of a
known event. seconds: of the processor, the least of REPEATS runs that alternate with those of the other placements.
"""
import csv
import json
import math
import subprocess
import sys
from pathlib import Path

from crank import reference
from reduce import MACHINE

DURATION, STEP, REPEATS = 0.2, 1e-5, 5
PLACED = {"plane": ("slider_crank",), "space": ("slider_crank_space",),
          "turned": ("slider_crank_space", "--set", "turn_x=0.4", "--set", "turn_y=-1.1", "--set", "turn_z=0.7")}
INTEGRATORS = {"moreau-jean": STEP, "stewart-trinkle": STEP, "rattle": STEP, "adaptive:rtol=1e-9": DURATION,
               "event-driven": DURATION}
CASES = [(mu, e) for mu in (0, 0.01, 0.1) for e in (0, 0.4)]  # well conditioned to the end
EVENTS = Path(__file__).resolve().parents[2] / "tests/data/slider_crank_events.csv"
KINDS = {"impact": ("impact", "accumulation"), "release": ("release",), "slip_zero": ("slip", "stick")}
COMMAND = "/usr/bin/python3 -s -E paper/scripts/plane_in_space.py build/release/orthant paper/data"


def run(orthant, placed, integrator, mu, e):
    every = round(DURATION / INTEGRATORS[integrator])
    options = ["--set", f"mu={mu}", "--set", f"e={e}", "--integrator", integrator, "--step",
               str(INTEGRATORS[integrator]), "--duration", str(DURATION), "--every", str(every)]
    command = [orthant, "simulate", *PLACED[placed], *options]
    summary = json.loads(subprocess.run([*command, "--json"], check=True, capture_output=True, text=True).stdout)
    table = subprocess.run([*command, "--output", "-"], check=True, capture_output=True, text=True).stdout
    start, *_, end = csv.DictReader(table.splitlines())
    return summary, start, end


def turned(start, end):
    """Angle of the crank between two rows, in space up to whole turns and positive in the sense of its spin."""
    if "crank.theta" in end:
        return float(end["crank.theta"]) - float(start["crank.theta"])
    (w0, *u0), (w1, *u1) = ([float(row[f"crank.q{c}"]) for c in "wxyz"] for row in (start, end))
    cross = (u0[1] * u1[2] - u0[2] * u1[1], u0[2] * u1[0] - u0[0] * u1[2], u0[0] * u1[1] - u0[1] * u1[0])
    vector = [w0 * b - w1 * a + c for a, b, c in zip(u0, u1, cross)]  # of q_end times the conjugate of q_start
    spin = [float(end[f"crank.w{c}"]) for c in "xyz"]
    along = sum(a * b for a, b in zip(vector, spin)) / math.hypot(*spin)
    return 2 * math.atan2(along, w0 * w1 + sum(a * b for a, b in zip(u0, u1)))


def known_events():
    """(kind, time) by (mu, e), of the start without tilt."""
    found = {}
    for line in EVENTS.read_text().splitlines():
        if line and line[0] != "#":
            mu, e, omega3, event, t, _ = line.split(",")
            if float(omega3) == 0:
                found.setdefault((float(mu), float(e)), []).append((event, float(t)))
    return found


def event_error(known, table):
    return max(min(abs(event["t"] - t) for event in table if event["kind"] in KINDS[kind]) / t for kind, t in known)


def main(orthant, data):
    *_, exact = reference()
    known = known_events()
    with open(data / "plane_in_space.csv", "w", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(["mu", "e", "integrator", "step", "placed", "status", "angle", "error", "events", "event_error",
                      "seconds"])
        for mu, e in CASES:
            for integrator, step in INTEGRATORS.items():
                runs = [{placed: run(orthant, placed, integrator, mu, e) for placed in PLACED} for _ in range(REPEATS)]
                for placed, (summary, start, end) in runs[0].items():
                    angle = turned(start, end)
                    error = abs(math.remainder(angle - exact[mu, e], 2 * math.pi))
                    by_events = integrator == "event-driven"
                    out.writerow([mu, e, integrator, "" if step == DURATION else f"{step:g}", placed,
                                  summary["status"], f"{angle % (2 * math.pi):.15g}", f"{error:.3g}",
                                  len(known[mu, e]) if by_events else "",
                                  f"{event_error(known[mu, e], summary['event_table']):.3g}" if by_events else "",
                                  f"{min(each[placed][0]['seconds'] for each in runs):.4g}"])
    version = json.loads(
        subprocess.run([orthant, "--version", "--json"], check=True, capture_output=True, text=True).stdout)
    made = {key: version[key] for key in MACHINE} | {"command": COMMAND}
    (data / "plane_in_space.about.json").write_text(json.dumps(made, indent=1) + "\n")


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]))
