"""No line of C++ or Python, comments included, is longer than 120 columns."""
import pathlib
import sys

MOST = 120
ROOT = pathlib.Path(__file__).resolve().parent.parent

wide = [f"{path.relative_to(ROOT)}:{number}: {len(line)} columns: {line.strip()[:60]} …"
        for part in ("core", "solvers", "integrators", "experiments", "tests", "paper")
        for path in sorted((ROOT / part).rglob("*"))
        if path.suffix in (".h", ".cpp", ".py", ".pyi") and "node_modules" not in path.parts
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1) if len(line) > MOST]
if wide:
    sys.exit("\n".join([f"{len(wide)} lines are longer than {MOST} columns:", *wide]))
