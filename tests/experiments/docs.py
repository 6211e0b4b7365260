"""docs.py PAGES BUILD PREFIX CXX: every block of code of the documentation runs, and says what the page says.
So do the C++, the scene and the commands on built-in scenes and lists of README.md and experiments/README.md.

A page's blocks share one empty folder. By language:
  python    one after the other in one namespace, by this interpreter; those after a console block run with all
            before them
  toml, cpp, cmake, xml, python
            a first line `# file: NAME`, `// file: NAME`, `<!-- file: NAME -->` writes the file for the blocks that
            follow; a C++ program that no console block of its page builds is built and run here
  console   `$ COMMAND` by bash; the lines below it, if any, are its output, where ... stands for anything
Any other language is an error, except `text` and `none`, which are not code. SETS_UP lists commands that are not run,
since they install or measure for minutes; each must be on some page.
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

SETS_UP = {
    "export PATH=$PWD/build/release:$PATH": "done here, with this build's folder",
    "export PATH=$PWD/build/release:$PATH PYTHONPATH=$PWD/build/release/python": "likewise",
    "export PATH=$PWD/build/release:$PWD/build/release/experiments:$PATH": "likewise",
    "./experiments/scripts/setup release": "what the tests were built by",
    "pip wheel --no-deps .": "tests/wheel does it: minutes, and the package index",
    "cmake --install build/release --prefix $HOME/orthant": "consumer/install does it, with another prefix",
    "experiments/docs/figures.py quiet regret regret_sparse": "half an hour, likewise",
    "experiments/benchmarks/setup    # the rivals": "it fetches the rivals",
    "experiments/docs/scaling piles": "some minutes, likewise",
    "experiments/docs/scaling mechanisms": "likewise",
    "experiments/docs/figures.py quiet cones facets": "half an hour, likewise, with the rivals",
    "./experiments/run cone --problems FOLDER --rivals build/peers/cone    # of your own FCLIB files": "likewise",
    "experiments/docs/figures.py quiet solvers": "seven minutes, on a machine that does nothing else",
    "experiments/docs/figures.py quiet time_to_error": "two minutes, likewise",
}
ROOT = Path(__file__).resolve().parents[2]
NOT_CODE = {"text", "none", "{csv-table}", "{toctree}", "{eval-rst}", "{literalinclude}", "{include}"}


def blocks(text):
    """(line, language, lines) of each fenced block."""
    inside = None
    for number, line in enumerate(text.splitlines(), 1):
        if inside is None:
            if match := re.match(r"\s*```+\s*([^\s]*)", line):
                inside = (number, match[1], [])
        elif re.match(r"\s*```+\s*$", line):
            yield inside
            inside = None
        else:
            inside[2].append(line)
    if inside is not None:
        raise SystemExit(f"line {inside[0]}: a block that does not end")


def matches(said, expected):
    pattern = ".*?".join(re.escape(part) for part in "\n".join(expected).split("..."))
    return re.fullmatch(pattern + r"\s*", said, re.S) is not None


class Page:
    def __init__(self, file, build, prefix, compiler):
        self.file, self.build, self.prefix, self.compiler = file, build, prefix, compiler
        self.folder, self.home = (Path(tempfile.mkdtemp(prefix=kind)) for kind in ("page", "home"))
        self.python, self.programs, self.failures, self.run_count, self.not_run = [], [], 0, 0, set()
        self.python_done = 0
        self.environment = {
            **os.environ, "PATH": f"{build}:{build}/experiments:{os.environ['PATH']}", "HOME": str(self.home),
            "CXX": compiler, "PYTHONPATH": f"{build}/python",
            "PKG_CONFIG_PATH": f"{prefix}/lib/pkgconfig:{prefix}/share/pkgconfig"
        }
        (self.home / "orthant").symlink_to(prefix)

    def fail(self, line, words):
        self.failures += 1
        print(f"{self.file}:{line}: {words}", file=sys.stderr)

    def bash(self, command):
        return subprocess.run(["bash", "-c", command], cwd=self.folder, env=self.environment, capture_output=True,
                              text=True)

    def console(self, line, lines):
        commands = []
        for text in lines:
            if text.startswith("$ "):
                commands.append((text[2:], []))
            elif commands:
                commands[-1][1].append(text)
            else:
                self.fail(line, "a console block begins with no command")
        for command, expected in commands:
            if command in SETS_UP:
                self.not_run.add(command)
                continue
            if match := re.fullmatch(r"export (.*)", command):  # kept for the commands below
                for name, value in re.findall(r"(\w+)=(\S+)", match[1]):
                    self.environment[name] = self.bash(f'echo "{value}"').stdout.strip()
                continue
            self.run_count += 1
            done = self.bash(f"{ROOT}/{command}" if command.startswith("experiments/studies/plots/plot_") else command)
            if done.returncode != 0:
                self.fail(line,
                          f"$ {command}\nended with {done.returncode}: {done.stdout[-2000:]}{done.stderr[-2000:]}")
            elif expected and not matches(done.stdout, expected):
                self.fail(line,
                          f"$ {command}\nshould say:\n" + "\n".join(expected) + f"\nand says:\n{done.stdout[:2000]}")

    def keep(self, line, language, lines):
        match = re.match(r"(?:#|//|<!--) file: (\S+)( -->)?$", lines[0] if lines else "")
        if match:
            (self.folder / match[1]).write_text("\n".join(lines) + "\n", encoding="utf-8")
            if language == "cpp":
                self.programs.append((line, match[1]))
        elif language == "toml":  # a scene by itself
            self.run_count += 1
            (self.folder / "block.toml").write_text("\n".join(lines) + "\n", encoding="utf-8")
            done = self.bash("orthant simulate block.toml --duration 0.002")
            if done.returncode != 0:
                self.fail(line, f"no scene that runs: {done.stderr}")
        else:
            self.fail(line, f"a {language} block without `file: NAME`")

    def build_programs(self, text):
        for line, name in self.programs:
            if re.search(rf"^\$ (cmake --build|c\+\+ .*{re.escape(name)})", text, re.M):
                continue
            self.run_count += 1
            done = self.bash(f"$CXX -std=c++20 {name} -o program $(pkg-config --cflags --libs orthant) && ./program")
            if done.returncode != 0:
                self.fail(line, f"{name}: {done.stdout}{done.stderr[-3000:]}")

    def run_python(self):
        """In one go; each block's line numbers are those of the page."""
        if len(self.python) == self.python_done:
            return
        self.run_count += len(self.python) - self.python_done
        self.python_done = len(self.python)
        source = []
        for line, lines in self.python:
            source += [""] * (line - len(source)) + lines
        (self.folder / "page.py").write_text("\n".join(source) + "\n", encoding="utf-8")
        done = subprocess.run([sys.executable, "-s", "page.py"], cwd=self.folder, env=self.environment,
                              capture_output=True, text=True)
        if done.returncode != 0:
            self.fail(self.python[-1][0], done.stderr)

    def check(self):
        text = self.file.read_text(encoding="utf-8")
        for line, language, lines in blocks(text):
            if language == "python" and not (lines and lines[0].startswith("# file: ")):
                self.python.append((line, lines))
            elif language == "console":
                self.run_python()  # files it writes may be wanted
                self.console(line, lines)
            elif language in ("toml", "cpp", "cmake", "xml", "python"):
                self.keep(line, language, lines)
            elif language not in NOT_CODE:
                self.fail(line, f"language '{language}': must be python, toml, cpp, cmake, xml, console, text or none")
        self.run_python()
        self.build_programs(text)
        return self.done()

    def done(self):
        shutil.rmtree(self.folder), shutil.rmtree(self.home)
        return self.failures

    def check_readme(self, least):
        """Its C++ is the inside of a program. Of its commands those run that need no file of the reader's and no
        minutes."""
        text = self.file.read_text(encoding="utf-8")
        for line, language, lines in blocks(text):
            if language == "toml":
                self.keep(line, language, lines)
            if language == "cpp":
                top = [x for x in lines if x.startswith(("#include", "using "))]
                inside = [x for x in lines if x not in top]
                (self.folder / "main.cpp").write_text("\n".join([*top, "int main() {", *inside, "}", ""]),
                                                      encoding="utf-8")
                self.programs.append((line, "main.cpp"))
        self.build_programs(text)
        for number, line in enumerate(text.splitlines(), 1):
            if match := re.match(r"    (?:build/release/(orthant (?:simulate slider_crank|simulate door|list).*)|"
                                 r"(experiments/studies/plots/plot_run.py .*))", line):
                self.run_count += 1
                done = self.bash(match[1].split("  #")[0] if match[1] else f"{ROOT}/{match[2]}")
                if done.returncode != 0:
                    self.fail(number, f"$ {match[1]}\nended with {done.returncode}: {done.stderr[-2000:]}")
        if self.run_count < least:
            self.fail(1, f"only {self.run_count} programs and commands were found")
        return self.done()


def undocumented(page, build):
    """Keys of a sweep's file and columns of its results that the page does not name; the command lists them."""
    text = page.read_text(encoding="utf-8")
    named = set(re.findall(r"`(?:\[\[)?([a-z_0-9]+)(?:\]\])?`", text))
    count = 0
    with tempfile.TemporaryDirectory() as folder:
        def run(*words):
            return subprocess.run([f"{build}/orthant", *words], cwd=folder, capture_output=True, text=True)

        grid = '[[grid]]\nintegrator = "rattle"\nstep = 1e-2\n'
        head = 'scene = "bouncing_ball"\nduration = 0.02\n'
        for wrong in ("wrong = 1\n" + head + grid, head + grid + "wrong = 1\n", head + grid + "[[figure]]\nwrong = 1\n",
                      head + grid + "[[animation]]\nwrong = 1\n",
                      head + grid + '[[animation]]\ntitle = "x"\nruns = [{wrong = 1}]\n'):
            Path(folder, "keys.sweep.toml").write_text(wrong, encoding="utf-8")
            said = run("sweep", "keys.sweep.toml", "--list").stderr
            keys = re.findall(r"[a-z_]+", said.partition("must be one of ")[2])
            count += len(keys)
            yield from (f"{page}: does not name the key '{key}' ({said.strip()})" for key in keys if key not in named)
            if not keys:
                yield f"{page}: the command does not list its keys: {said}"
        Path(folder, "keys.sweep.toml").write_text(head + grid, encoding="utf-8")
        run("sweep", "keys.sweep.toml", "--results", "keys.sqlite")
        columns = run("results", "keys.sqlite", "--csv").stdout.split("\n")[0].split(",")
        yield from (f"{page}: does not name the column '{column}'" for column in columns if column not in named)
        if count < 40 or len(columns) < 30:
            yield f"{page}: only {count} keys and {len(columns)} columns were found"


def main():
    folder, build, prefix = (Path(x).resolve() for x in sys.argv[1:4])
    failures, not_run, count = 0, set(), 0
    for file in sorted(folder.rglob("*.md")):
        page = Page(file, build, prefix, sys.argv[4])
        failures += page.check()
        not_run |= page.not_run
        count += page.run_count
        print(f"{file.relative_to(folder)}: {page.run_count} run")
    for name, least in {"README.md": 3, "experiments/README.md": 3}.items():
        readme = Page(folder.parents[1] / name, build, prefix, sys.argv[4])
        failures += readme.check_readme(least)
        print(f"{name}: {readme.run_count} run")
    for fault in undocumented(folder / "sweeps.md", build):
        failures += 1
        print(fault, file=sys.stderr)
    for command in sorted(not_run):
        print(f"not run here ({SETS_UP[command]}): {command}")
    for command in sorted(SETS_UP.keys() - not_run):
        failures += 1
        print(f"no page has the command that is not run: {command}", file=sys.stderr)
    if count < 30:
        failures += 1
        print(f"only {count} blocks: the pages were not found", file=sys.stderr)
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
