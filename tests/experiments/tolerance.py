"""A share of `experiments/run tolerance`: no random scene errs by more than 100 times rtol without a word."""
import importlib.util
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
spec = importlib.util.spec_from_file_location("tolerance", ROOT / "experiments/studies/tolerance.py")
tolerance = importlib.util.module_from_spec(spec)
spec.loader.exec_module(tolerance)


def check(kinds, scenes, seed, rtol):
    silent, judged = tolerance.main(["--kinds", kinds, "--scenes", str(scenes), "--seed", str(seed), "--rtol", rtol,
                                     "--limit", "30", "--orthant", sys.argv[1]])
    if silent > 0:
        sys.exit(f"tolerance: {silent:.1%} of the scenes of a kind err by more than 100 rtol, and no word is said")
    if judged < 0.6:
        sys.exit(f"tolerance: only {judged:.0%} of the scenes of a kind could be judged")


check("tumbling,polygons,journals,linkages", 12, 10, "1e-6")
check("balls,sliders,pendulums", 4, 10, "1e-6")
check("solids", 3, 45, "1e-6,1e-8")  # corners that rattle in turn until the box slides on all four
check("solids", 2, 146, "1e-8")  # bounces of two corners at once: the tail of a series counts
