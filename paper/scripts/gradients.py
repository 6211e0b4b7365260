"""Derivatives of the crank angle, by steps and of the motion: gradients.py ORTHANT DATA. Writes gradients.csv and its
about."""
import csv
import json
import subprocess
import sys
from pathlib import Path

STEPS = (1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6)
PARAMETERS = ("mu", "e", "clearance")
COMMAND = "/usr/bin/python3 -s -E paper/scripts/gradients.py build/release/orthant paper/data"


def gradient(orthant, *options):
    run = subprocess.run([orthant, "gradient", "slider_crank", "--of", "crank.theta", "--wrt", ",".join(PARAMETERS),
                          "--duration", "0.2", "--json", *options], check=True, capture_output=True, text=True)
    found = json.loads(run.stdout)
    return [found["values"]["crank.theta"], *(found["derivatives"]["crank.theta"][key] for key in PARAMETERS)]


def main(orthant, data):
    with open(data / "gradients.csv", "w", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(["step", "theta", *PARAMETERS])  # step 0: of the motion itself
        for step in (0, *STEPS):
            how = ["--step", str(step)] if step else ["--integrator", "event-driven", "--step", "0.2"]
            out.writerow([f"{step:g}", *(f"{x:.9g}" for x in gradient(orthant, *how))])
    version = json.loads(
        subprocess.run([orthant, "--version", "--json"], check=True, capture_output=True, text=True).stdout)
    (data / "gradients.about.json"
     ).write_text(json.dumps({"command": COMMAND, "revision": version["revision"]}, indent=1) + "\n")


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]))
