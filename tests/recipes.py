"""Recipes of conda, Homebrew and Nix: the project's version, every package that CMakeLists.txt requires, and sound
syntax.

Syntax is checked where Ruby and Nix are installed. No package system is reached.
"""

import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
CMAKE = (ROOT / "CMakeLists.txt").read_text()
RECIPES = ROOT / "experiments/python"
FOLDERS = {"conda": RECIPES / "conda/meta.yaml", "homebrew": RECIPES / "homebrew/orthant-lcp.rb",
           "nix": RECIPES / "nix/default.nix"}
NIX = {"nlohmann-json": "nlohmann_json", "suite-sparse": "suitesparse",
       "hdf5": "hdf5-cpp"}  # others are called as in Homebrew


def main():
    version = re.search(r"project\(Orthant VERSION ([0-9.]+)", CMAKE)[1]
    required = re.findall(r'orthant_require\("([^"]+)" "\$\{\w+\}" (\S+) (\S+) (\S+) (\S+)\)', CMAKE)
    assert len(required) >= 9, required
    wrong = []
    for system, file in FOLDERS.items():
        text = file.read_text()
        if f'"{version}"' not in text:
            wrong.append(f"{file.name}: must be of version {version}")
        for what, _, _, homebrew, conda in required:
            name = {"conda": conda, "homebrew": homebrew, "nix": NIX.get(homebrew, homebrew)}[system]
            there = re.search(rf'(^|["\s]){re.escape(name)}(["\s]|$)', text) is not None
            if there == (what == "CLP"):  # licence
                wrong.append(f"{file.name}: {name} must {'not ' if what == 'CLP' else ''}be there")
        if system != "conda" and "ORTHANT_WITH_CLP=OFF" not in text:
            wrong.append(f"{file.name}: must switch CLP off")
    for program, words in (("ruby", ["-c",
                                     str(FOLDERS["homebrew"])]), ("nix-instantiate", ["--parse",
                                                                                      str(FOLDERS["nix"])])):
        if shutil.which(program):
            run = subprocess.run([program, *words], capture_output=True, text=True)
            if run.returncode != 0:
                wrong.append(run.stderr)
    print("\n".join(wrong) or f"{len(FOLDERS)} recipes name {len(required)} packages")
    return 1 if wrong else 0


sys.exit(main())
