"""Builds the wheel: scikit-build-core compiles, then (on Linux) auditwheel puts the shared libraries inside.

Kept in build/, so that a second build of an unchanged tree compiles nothing: the objects, a static HDF5 without network
libraries (experiments/scripts/slim_hdf5), and copies of the tools, for pip gives every build another temporary folder.
Environment:
  ORTHANT_SLIM_HDF5  a folder made by slim_hdf5, or "system": the system's HDF5, with all that it needs inside the wheel
  ORTHANT_REPAIR     0: leave the shared libraries where they are (the wheel then serves this machine only)
"""

from __future__ import annotations

import importlib
import importlib.metadata
import importlib.util
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path
from typing import Any, Iterable, Optional

ROOT = Path(__file__).resolve().parents[3]


def kept(package: str, distribution: str) -> Path:
    """The package's copy in build/: a folder that stays the same, for objects are thrown away when one of these
    moves."""
    where = ROOT / "build/wheel_tools" / f"{distribution}-{importlib.metadata.version(distribution)}"
    if not where.exists():
        found = importlib.util.find_spec(package)
        assert found is not None and found.submodule_search_locations
        where.parent.mkdir(parents=True, exist_ok=True)
        half = Path(tempfile.mkdtemp(dir=where.parent))
        shutil.copytree(found.submodule_search_locations[0], half / package,
                        ignore=shutil.ignore_patterns("__pycache__"))
        half.rename(where)
    return where


sys.path.insert(0, str(kept("scikit_build_core", "scikit-build-core")))
inner = importlib.import_module("scikit_build_core.build")
Settings = Optional[dict[str, Any]]

# Header-only libraries, whose code is in the wheel as well: Debian's names.
HEADERS = ["libeigen3-dev", "nlohmann-json3-dev", "libcli11-dev", "libboost-dev"]
# The manylinux rules leave these to the system; auditwheel decides, this is for the list of licences alone.
SYSTEM = re.compile(r"(ld-linux.*|lib(c|m|dl|rt|pthread|util|resolv|stdc\+\+|gcc_s|z))\.so")

ECLIPSE = re.compile(r"lib(Clp|CoinUtils|ipopt)\b")

NOTE = """Orthant itself is under BSD-3-Clause. This wheel also contains the libraries below; their licences lie beside
this file. UMFPACK and CHOLMOD's Supernodal and MatrixOps modules are under the GPL, version 2 or later; KLU,
BTF, CHOLMOD's other modules, libquadmath and a part of NLopt under the LGPL, version 2.1 or later; GNU MP
under LGPL-3 or GPL-2; METIS under Apache-2.0; Eigen under MPL-2.0; the GCC runtime under the GPL with its
exception; the others under permissive licences.
"""
WHOLE = """So the wheel as a whole may be used by anybody for anything, and passed on under the terms of the GPL,
version 3 or later. Whoever passes it on offers the sources with it: of Orthant, and of the Debian packages named
below, in these versions.

"""
MIXED = """It also contains libraries under the Eclipse Public License (CLP, CoinUtils, Ipopt), whose terms cannot be
met together with those of the GPL. The wheel may be used by whoever built it, but NOT PASSED ON. Build
without ORTHANT_WITH_CLP and ORTHANT_WITH_IPOPT one that may be.

"""


def terms(libraries: Iterable[str]) -> str:
    """What may be done with a wheel that holds these libraries."""
    return MIXED if any(map(ECLIPSE.match, libraries)) else WHOLE


def say(words: str) -> None:
    print(f"orthant: {words}", file=sys.stderr, flush=True)


def fetch_page_parts() -> None:
    """uPlot and three.js, which the report and the view are drawn with. An sdist has them already."""
    folder = ROOT / "experiments/report"
    wanted = json.loads((folder / "package.json").read_text())["dependencies"]

    def present(library: str) -> bool:
        package = folder / f"node_modules/{library}/package.json"
        return package.exists() and json.loads(package.read_text())["version"] == wanted[library]
    if present("uplot") and present("three") and (folder / "node_modules/three/build/three.bundle.js").exists():
        return
    npm = shutil.which("npm")
    if npm is None:
        raise SystemExit(
            "orthant: npm is needed to fetch uplot and three.js, the libraries that pages are drawn with:\n"
            "  Debian, Ubuntu: apt-get install npm      Fedora: dnf install nodejs-npm\n"
            "  Homebrew: brew install node              conda-forge: conda install -c conda-forge nodejs")
    subprocess.run([
        npm, "install", "--prefix",
        str(folder), "--no-package-lock", "--ignore-scripts", "--no-audit", "--no-fund", "--loglevel=error"
    ], check=True)
    subprocess.run([npm, "run", "--prefix", str(folder), "--silent", "bundle"], check=True)


def require_compiler() -> None:
    """CMake's own words name no packages."""
    given = os.environ.get("CXX", "").split()[:1] or ["c++", "g++", "clang++"]
    if not any(map(shutil.which, given)):
        raise SystemExit(
            f"orthant: a compiler with C++20 is needed, GCC 11, Clang 14 or newer: {' or '.join(given)} is not found:\n"
            "  Debian, Ubuntu: apt-get install g++      Fedora: dnf install gcc-c++\n"
            "  Homebrew: brew install gcc               conda-forge: conda install -c conda-forge cxx-compiler")


def slim_hdf5() -> Optional[Path]:
    """None: the system's own."""
    given = os.environ.get("ORTHANT_SLIM_HDF5", "")
    if given == "system" or not sys.platform.startswith("linux"):
        return None
    prefix = Path(given) if given else ROOT / "build/slim_hdf5"
    if not (prefix / "complete").exists():
        if given:
            raise SystemExit(
                f"orthant: ORTHANT_SLIM_HDF5 = {given}: must be a folder that experiments/scripts/slim_hdf5 made")
        say("building a static HDF5 (once, about a minute)")
        if subprocess.run(["bash", str(ROOT / "experiments/scripts/slim_hdf5"), str(prefix)]).returncode != 0:
            say("taking the system's HDF5 instead: the wheel becomes larger")
            return None
    return prefix.resolve()


def with_defines(settings: Settings, hdf5: Optional[Path]) -> dict[str, Any]:
    mine: dict[str, Any] = {
        "cmake.define.pybind11_DIR": str(kept("pybind11", "pybind11") / "pybind11/share/cmake/pybind11"),
        "cmake.define.ORTHANT_SLIM_HDF5": str(hdf5 or "")
    }
    return {**mine, **(settings or {})}


def libraries_of(wheel: Path) -> dict[str, Path]:
    """Shared libraries that the wheel's programs load from the system, by name."""
    found: dict[str, Path] = {}
    with tempfile.TemporaryDirectory() as folder, zipfile.ZipFile(wheel) as archive:
        archive.extractall(folder)
        for file in Path(folder).rglob("*"):
            if file.is_file() and file.open("rb").read(4) == b"\x7fELF":
                said = subprocess.run(["ldd", str(file)], capture_output=True, text=True).stdout
                found.update((name, Path(place)) for name, place in re.findall(r"(\S+) => (/\S+)", said))
    return {name: place for name, place in sorted(found.items()) if not SYSTEM.match(name)}


def add_licences(wheel: Path, hdf5: Optional[Path]) -> None:
    texts: dict[str, str] = {}
    lines = []
    packages: dict[str, list[str]] = {}
    libraries = libraries_of(wheel)
    if terms(libraries) == MIXED:
        say("warning: this wheel must not be passed on: it holds UMFPACK (GPL) and CLP or Ipopt (Eclipse licence)")
    for name, place in libraries.items():
        owner = ""
        if shutil.which("dpkg-query"):
            for candidate in (place.resolve(), Path(re.sub("^/usr", "", str(place.resolve()))), place):
                said = subprocess.run(["dpkg-query", "-S", str(candidate)], capture_output=True, text=True).stdout
                if said:
                    owner = said.split(":")[0]
                    break
        packages.setdefault(owner or "unknown package", []).append(name)
    for package in HEADERS:
        packages.setdefault(package, ["(headers)"])
    for package, names in sorted(packages.items()):
        text = Path(f"/usr/share/doc/{package}/copyright")
        if text.exists():
            texts[package] = text.read_text(errors="replace")
        elif names == ["(headers)"]:
            continue
        version = ""
        if shutil.which("dpkg-query"):
            version = subprocess.run(["dpkg-query", "-W", "-f", "${source:Package} ${source:Version}", package],
                                     capture_output=True, text=True).stdout
        lines.append(f"{package} (source: {version or 'unknown'}): {', '.join(names)}\n")
    if hdf5:
        texts["hdf5"] = (hdf5 / "COPYING").read_text(errors="replace")
        lines.append("hdf5 (static)\n")
    texts["uplot"] = (ROOT / "experiments/report/node_modules/uplot/LICENSE").read_text()
    lines.append("uplot (script of the pages)\n")
    texts["three"] = (ROOT / "experiments/report/node_modules/three/LICENSE").read_text()
    lines.append("three.js (script of the pages of scenes in space)\n")
    lines.append(f"pybind11 {importlib.metadata.version('pybind11')} (headers, BSD-3-Clause)\n")
    with zipfile.ZipFile(wheel, "a", zipfile.ZIP_DEFLATED) as archive:  # auditwheel writes the RECORD anew
        archive.writestr("orthant/licenses/README.txt", NOTE + terms(libraries) + "".join(lines))
        for name, text in texts.items():
            archive.writestr(f"orthant/licenses/{name}.txt", text)


def repair(wheel: Path, into: Path) -> Path:
    environment = dict(os.environ)
    plain = [str(p) for kind in ("blas", "lapack") for p in Path("/usr/lib").glob(f"*/{kind}")]  # not a large OpenBLAS
    environment["LD_LIBRARY_PATH"] = os.pathsep.join([*plain, environment.get("LD_LIBRARY_PATH", "")]).strip(os.pathsep)
    subprocess.run([
        sys.executable, "-m", "auditwheel", "repair", "--strip", "--zip-compression-level", "9", "--wheel-dir",
        str(into),
        str(wheel)
    ], check=True, env=environment, stdout=sys.stderr)
    (repaired,) = into.glob("*.whl")
    return repaired


def build_wheel(directory: str, settings: Settings = None, metadata: Optional[str] = None) -> str:
    require_compiler()
    fetch_page_parts()
    hdf5 = slim_hdf5()
    if not sys.platform.startswith("linux") or os.environ.get("ORTHANT_REPAIR") == "0":
        return inner.build_wheel(directory, with_defines(settings, hdf5), metadata)
    with tempfile.TemporaryDirectory() as bare, tempfile.TemporaryDirectory() as whole:
        wheel = Path(bare) / inner.build_wheel(bare, with_defines(settings, hdf5), metadata)
        add_licences(wheel, hdf5)
        repaired = repair(wheel, Path(whole))
        shutil.move(str(repaired), Path(directory) / repaired.name)
        return repaired.name


def build_sdist(directory: str, settings: Settings = None) -> str:
    fetch_page_parts()
    return inner.build_sdist(directory, settings)


def build_editable(directory: str, settings: Settings = None, metadata: Optional[str] = None) -> str:
    require_compiler()
    fetch_page_parts()
    return inner.build_editable(directory, with_defines(settings, None), metadata)


get_requires_for_build_wheel = inner.get_requires_for_build_wheel
get_requires_for_build_sdist = inner.get_requires_for_build_sdist
get_requires_for_build_editable = inner.get_requires_for_build_editable
prepare_metadata_for_build_wheel = inner.prepare_metadata_for_build_wheel
prepare_metadata_for_build_editable = inner.prepare_metadata_for_build_editable
