"""The documentation as a site: pages of this folder, READMEs, and the reference made from headers and docstrings.

    ./experiments/run docs                                  into build/docs; builds the Python package first
    build.py --output DIR --package build/release/python    the same by hand

Sphinx and its theme live in an environment of their own, build/docs-env, made from requirements.txt at the first call.
"""
import argparse
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
KATEX = Path("/usr/share/javascript/katex")
# READMEs and notes that are pages here as they stand there.
PAGES = {
    "scenes.md": "core/scenes/README.md",
    "examples.md": "experiments/examples/README.md",
    "peers.md": "experiments/benchmarks/README.md",
    "theory/tilted_start.md": "paper/notes/tilted_start.md",
}
FOLDERS = {
    "core/lcp": "Problems and solutions",
    "core/lcp/cones": "Intervals, discs, contacts: projections and residuals",
    "core/lcp/judge": "The judge, error bounds, matrix classes",
    "core/lcp/problems": "Known problems and families",
    "core/lcp/files": "Problem files",
    "core/mechanics": "Rows of Jacobians, blocks of bodies",
    "core/mechanics/planar": "Planar geometry, joints, contacts, springs, loads",
    "core/mechanics/spatial": "Spatial geometry, joints, contacts, springs, loads",
    "core/mechanics/models": "Models in URDF and MJCF, meshes",
    "core/mechanics/scene": "Scenes and scene files",
    "core/mechanics/dynamics": "Systems, terms, the basic system",
    "core/scenes": "Built-in scenes",
    "core/support": "Support",
    "solvers": "Solver interface and registry",
    "solvers/pivoting": "Pivoting solvers",
    "solvers/active_set": "Active-set, Newton and interior-point solvers",
    "solvers/first_order": "First-order solvers",
    "solvers/cones": "Solvers for friction discs",
    "solvers/external": "Solvers over Ipopt and NLopt",
    "solvers/distributed": "Problems distributed over MPI (PETSc)",
    "solvers/proof": "Proofs of infeasibility",
    "solvers/derivatives": "Derivatives of solutions",
    "solvers/linear_algebra": "Factorizations and kernels",
    "integrators": "Integrator interface, registry, simulation loop",
    "integrators/step": "Parts of one step",
    "integrators/fixed_step": "Fixed-step schemes",
    "integrators/derivatives": "Derivatives of runs",
    "integrators/between_events": "Smooth motion between events",
    "integrators/adaptive": "Adaptive integrator",
    "integrators/event_driven": "Event-driven integrator",
}
INTERNAL = {"core/mechanics/scene/toml"}  # not installed


def in_environment(environment):
    """Goes on in the documentation's own environment, which is made or renewed where requirements.txt asks for another
    one."""
    python, stamp = environment / "bin/python", environment / "requirements.txt"
    wanted = (HERE / "requirements.txt").read_text(encoding="utf-8")
    if Path(sys.prefix).resolve() == environment.resolve():
        return
    if not stamp.exists() or stamp.read_text(encoding="utf-8") != wanted:
        make = ["/usr/bin/python3", "-m", "venv", "--clear", "--system-site-packages", str(environment)]
        fill = [str(python), "-m", "pip", "install", "-q", "--disable-pip-version-check", "-r"]
        for command in (make, [*fill, str(HERE / "requirements.txt")]):
            if subprocess.run(command, check=False).returncode != 0:
                sys.exit(f"docs: '{' '.join(command)}' failed; it makes the environment that the site is built in")
        stamp.write_text(wanted, encoding="utf-8")
    sys.stdout.flush()
    os.execv(python, [str(python), "-s", *sys.argv])


def page_of(text):
    """A README's Markdown: links to files of the tree become their names."""
    return re.sub(r"\[([^\]]+)\]\((?!https?:|#)([^)]+)\)", r"\1 (`\2`)", text)


def header_page(header):
    """A header's page: its opening comment, the declarations with links (cpp_api.py), the text of the header. It stands
    in its part's table, not in the navigation, which would be most of every page: hence "orphan"."""
    lines = header.read_text(encoding="utf-8").splitlines()
    count = next((i for i, line in enumerate(lines) if not line.startswith("//")), len(lines))
    name = header.relative_to(ROOT)
    about = [line[2:].removeprefix(" ") for line in lines[:count]]
    title = re.sub(r"^\S+\.h — ", "", about[0]).rstrip(".:") if about else str(name)
    part = FOLDERS[str(name.parent)]
    return (f"---\norphan: true\n---\n\n# {name.name}\n\n*{title}.* Part of [{part}](index.md).\n\n"
            "```text\n" + "\n".join(about) + "\n```\n\n"
            f"`#include <orthant/{name}>`\n\n## Declarations\n\n```{{cpp-header}} {name}\n```\n\n"
            f"## Text of the header\n\n```{{code-block}} c++\n" + "\n".join(lines[count:]).strip() + "\n```\n"), title


def write_reference(folder, work):
    import cpp_api  # needs Sphinx

    entries = {file: found for file, found in cpp_api.collect(ROOT, work).items() if str(Path(file).parent) in FOLDERS}
    (folder / "api.json").write_text(json.dumps(entries), encoding="utf-8")
    index = [
        "# C++ reference", "",
        "Every public header: its opening comment, its declarations, its text. The opening comment",
        "explains the algorithm and cites its sources. [All names](names.md).", ""
    ]
    (folder / "names.md").write_text("# All C++ names\n\n```{cpp-names}\n```\n", encoding="utf-8")
    parts = {str(header.parent.relative_to(ROOT)) for library in ("core", "solvers", "integrators")
             for header in (ROOT / library).rglob("*.h")}
    if missing := parts - INTERNAL - set(FOLDERS):
        raise SystemExit(f"build.py: FOLDERS lacks {', '.join(sorted(missing))}: public headers need a page")
    for part, title in FOLDERS.items():
        target = folder / part.replace("/", "_")
        target.mkdir(parents=True)
        rows = []
        for header in sorted((ROOT / part).glob("*.h")):
            text, about = header_page(header)
            (target / f"{header.stem}.md").write_text(text, encoding="utf-8")
            rows.append(f"| [{header.name}]({header.stem}.md) | {about.replace('|', chr(92) + '|')} |")
        (target / "index.md").write_text(f"# {title}\n\n`{part}`\n\n| header | |\n|---|---|\n" + "\n".join(rows) + "\n",
                                         encoding="utf-8")
        index.append(f"- [{title}]({target.name}/index.md): `{part}`")
    index += ["", "```{toctree}", ":hidden:", "", "names"] + [f"{part.replace('/', '_')}/index"
                                                              for part in FOLDERS] + ["```", ""]
    (folder / "index.md").write_text("\n".join(index), encoding="utf-8")


def gather(source, orthant):
    """All pages in one folder, as Sphinx wants them; nothing is written into the tree."""
    shutil.rmtree(source, ignore_errors=True)
    shutil.copytree(HERE, source, ignore=shutil.ignore_patterns("__pycache__", "*.py", "requirements.txt"))
    for file in ("conf.py", "cpp_api.py"):
        shutil.copy(HERE / file, source)
    import contact_tables
    import figure_pages
    import figures
    import gallery  # needs Matplotlib, which the environment takes from the system

    figure_pages.pages(source / "data", figures.load())
    contact_tables.pictures(source / "data")
    gallery.write(orthant, source)
    for page, file in PAGES.items():
        (source / page).write_text(page_of((ROOT / file).read_text(encoding="utf-8")), encoding="utf-8")
    shutil.copy(ROOT / "paper/notation.csv", source / "theory/notation.csv")
    shutil.copytree(ROOT / "experiments/examples", source / "examples", ignore=shutil.ignore_patterns("*.md"))
    (source / "reference/cpp").mkdir(parents=True)
    write_reference(source / "reference/cpp", source.parent / "doxygen")
    static = source / "_static/katex"
    if not KATEX.is_dir():
        sys.exit(f"docs: {KATEX} is missing, which draws the formulas (Debian: libjs-katex)")
    shutil.copytree(KATEX, static)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=Path, default=ROOT / "build/docs", help="default: %(default)s")
    parser.add_argument("--package", type=Path, default=ROOT / "build/release/python", help="default: %(default)s")
    a = parser.parse_args()
    in_environment(ROOT / "build/docs-env")
    source = a.output / "source"
    gather(source, (a.package.parent / "orthant").resolve())
    sys.path.insert(0, str(a.package.resolve()))  # autodoc imports the package
    from sphinx.cmd.build import main as sphinx

    folders = [str(folder) for folder in (a.output / "doctrees", source, a.output / "html")]
    status = sphinx(["-q", "-W", "--keep-going", "-n", "-j", "2", "-b", "html", "-d", *folders])
    if status == 0:
        print(f"docs: {a.output / 'html/index.html'}")
    sys.exit(status)


if __name__ == "__main__":
    main()
