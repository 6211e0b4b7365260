"""schemas.py ORTHANT: what each command prints with --json holds to its `orthant schema`, and the documented scenes to
`scene`.

Every schema is also given what it must refuse: an output with a key more, and one with a key less.
"""

import copy
import glob
import json
import re
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

import jsonschema

ORTHANT = str(Path(sys.argv[1]).resolve())
ROOT = Path(__file__).parents[2]

PROBLEMS = {
    "p.json": '"A": {"storage": "dense", "n": 2, "rows": [[2, 1], [1, 2]]}, "b": [-5, -6]',
    "none.json": '"A": {"storage": "dense", "n": 1, "rows": [[-1]]}, "b": [-1]',
    "half.json": '"A": {"storage": "dense", "n": 2, "rows": [[0, 0], [0, 1]]}, "b": [0, -1]',
    "disc.json": '"A": {"storage": "dense", "n": 3, "rows": [[2, 0, 0], [0, 1, 0], [0, 0, 1]]}, "b": [-2, 3, 4], '
                 '"lo": [0, "-inf", "-inf"], "friction": [{"first": 1, "normal": 0, "mu": 0.5, "rows": 2}]',
}
SWEEP = """
question = "Which?"
scene = "bouncing_ball"
duration = 1.0
measure = "ball.y"
reference = "event-driven:rtol=1e-10"
[[grid]]
integrator = ["moreau-jean", "rattle"]
step = [1e-2, 5e-3, 2e-3, 1e-3, 5e-4]
[[grid]]
integrator = ["adaptive"]
repeats = 2
step = [1e-2]
rtol = [1e-4, 1e-6, 1e-8]
[[grid]]
integrator = ["moreau-jean"]
solver = ["lemke-howson"]
step = [1e-2]
"""
JAM = """
[[body]]
name = "a"
mass = 1
inertia = 1
[[joint]]
type = "drive"
of = "slide"
bodies = ["ground", "a"]
amplitude = 0.1
omega = 50
"""
# schema: the commands, and their exit codes
COMMANDS = {
    "version": [("--version --json", 0)], "error": [("simulate nothing.toml --json", 1),
                                                    ("check slider_crank --set mu=-1 --json", 1),
                                                    ("solve --json --nothing", 1)],
    "solve": [("solve p.json --error-bound --log --json", 0), ("solve none.json --json", 2),
              ("solve disc.json --json", 0), ("solve disc.json --facets 8 --json", 3),
              ("solve p.json --solver lemke-howson --json", 3),
              ("solve p.json --solver pgs:max_sweeps=1 --json", 3)], "analyse": [("analyse p.json --json", 0),
                                                                                 ("analyse none.json --json", 0),
                                                                                 ("analyse half.json --json", 0)],
    "enumerate": [("enumerate p.json --json", 0), ("enumerate half.json --json", 0),
                  ("enumerate none.json --json", 2)], "replay": [("replay p.json --json", 0),
                                                                 ("replay none.json --json", 2)],
    "simulate": [("simulate slider_crank --integrator adaptive --duration 0.02 --json", 0),
                 ("simulate bouncing_ball --check --json", 0), ("simulate top --duration 0.01 --json", 0),
                 ("simulate slider_crank --step 1e-7 --time-limit 1e-3 --json", 3)], "list": [
                     (f"list{what} --json", 0) for what in ("", " solvers", " integrators", " scenes", " summary")
                 ], "check": [("check slider_crank --json", 0), ("check jam.toml --json", 0), ("check pile --json", 0),
                              ("check bennett --json", 0)], "sweep-list": [
                                  ("sweep s.sweep.toml --results s.sqlite --list --json", 0)
                              ], "sweep": [("sweep s.sweep.toml --results s.sqlite --json", 0)], "results": [
                                  ("results s.sqlite --json", 0)
                              ], "results-failures": [("results s.sqlite --failures --json", 0)], "results-orders": [
                                  ("results s.sqlite --orders --json", 0)
                              ], "results-times": [("results s.sqlite --times --json", 0)], "report": [
                                  ("report s.sqlite --output s.html --json", 0)
                              ], "view": [("view bouncing_ball --output v.html --json", 0)],
    "new": [("new mechanism --output m.toml --json", 0)], "import": [
        (f"import {ROOT}/core/scenes/robot_arm.urdf{more} --json", 0) for more in ("", " --output arm.toml")
    ], "gradient": [
        ("gradient slider_crank --duration 0.02 --of crank.theta,slider.x --wrt mu,start.crank.omega --json", 0),
        ("gradient slider_crank --duration 1e3 --time-limit 0.05 --of crank.theta --wrt mu --json", 3)
    ], "lyapunov": [("lyapunov bouncing_ball --set e=0.5 --duration 0.6 --count 2 --json", 0)], "completion": [
        (f"completion {shell} --json", 0) for shell in ("bash", "zsh", "fish")
    ], "man": [("man --json", 0), ("man solve --json", 0)],
}


def orthant(folder, words, code=0):
    run = subprocess.run([ORTHANT, *words.split()], cwd=folder, capture_output=True, text=True, timeout=300)
    assert run.returncode == code, (words, run.returncode, run.stdout[-500:], run.stderr[-500:])
    return run.stdout


def refuses(validator, printed, name):
    """One key more, or less, is not the command's: in the object, or in the first of a list."""
    for change in ("more", "less"):
        wrong = copy.deepcopy(printed)
        one = wrong[0] if isinstance(wrong, list) else wrong
        if isinstance(one, str):
            wrong[0] = 1
        elif change == "more":
            one["surplus"] = [1]
        else:
            keys = validator.schema.get("required") or validator.schema.get("items", {}).get("required", [])
            if not keys:  # all of them may be absent
                continue
            del one[keys[-1]]
        assert not validator.is_valid(wrong), f"{name}: the schema takes what no command prints ({change})"


def main():
    with tempfile.TemporaryDirectory() as folder:
        for file, text in PROBLEMS.items():
            Path(folder, file).write_text('{"format": "orthant-lcp", "version": 1, ' + text + "}")
        Path(folder, "s.sweep.toml").write_text(SWEEP)
        Path(folder, "jam.toml").write_text(JAM)
        seen = 0
        for name, commands in COMMANDS.items():
            schema = json.loads(orthant(folder, f"schema {name}"))
            jsonschema.Draft7Validator.check_schema(schema)
            validator = jsonschema.Draft7Validator(schema)
            for words, code in commands:
                printed = json.loads(orthant(folder, words, code))
                assert printed, f"{words}: printed nothing to compare"
                problems = [
                    f"{words}: {'/'.join(map(str, e.path))}: {e.message[:300]}" for e in validator.iter_errors(printed)
                ]
                assert not problems, "\n".join(problems)
                seen += 1
            refuses(validator, printed, name)

        # Each command that has --json has a schema, and each schema a command here.
        said = subprocess.run([ORTHANT, "schema", "nothing"], capture_output=True, text=True).stderr
        names = set(re.findall(r"[a-z-]+", said[said.index("{"):said.index("}")]))
        assert names == {"scene", *COMMANDS}, names ^ {"scene", *COMMANDS}
        commands = re.findall(r"^  ([a-z]+) ",
                              orthant(folder, "--help").split("Subcommands:")[1].split("Exit codes")[0], re.M)
        assert len(commands) > 10
        for command in set(commands) - {"schema"}:  # which prints JSON anyway
            assert command in {name.split("-")[0] for name in COMMANDS}, command
            assert "--json" in orthant(folder, f"{command} --help"), command

        scene = jsonschema.Draft7Validator(json.loads(orthant(folder, "schema scene")))
        texts = re.findall("```toml\n(.*?)```", (ROOT / "core/scenes/README.md").read_text(), re.S)
        in_space = (ROOT / "core/scenes/space.md").read_text()
        texts.append("\n".join(re.findall("^(?:    (.*)|)$", in_space[:in_space.index("## Keys")], re.M)))
        texts += [Path(file).read_text() for files in ("core/scenes/*.toml", "tests/data/*.toml")
                  for file in glob.glob(str(ROOT / files))] + [Path(folder, "m.toml").read_text()]
        assert len(texts) > 20
        for text in texts:
            problems = [
                f"{'/'.join(map(str, e.path))}: {e.message[:200]}" for e in scene.iter_errors(tomllib.loads(text))
            ]
            assert not problems, text[:200] + "\n" + "\n".join(problems)
        assert not scene.is_valid({"gravityy": [0, 1]}) and not scene.is_valid({"body": [{"name": 3}]})
        assert sum("dimension = 3" in text for text in texts) >= 2
        body = {"name": "a", "mass": 1, "inertia": 1, "position": [0, 1, 2]}
        assert scene.is_valid({"dimension": 3, "body": [body]}) and not scene.is_valid({"body": [body]})
        assert not scene.is_valid({"dimension": 3, "body": [body | {"position": [0, 1]}]})
        print(f"schemas: {seen} outputs and {len(texts)} scenes hold to theirs")


main()
