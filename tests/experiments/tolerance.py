"""A share of `experiments/run tolerance`: no random scene errs by more than 100 times rtol without a word."""
import importlib.util
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
spec = importlib.util.spec_from_file_location("tolerance", ROOT / "experiments/studies/tolerance.py")
tolerance = importlib.util.module_from_spec(spec)
spec.loader.exec_module(tolerance)

kinds = "tumbling,polygons,journals,linkages"
silent, judged = tolerance.main(
    ["--kinds", kinds, "--scenes", "12", "--seed", "10", "--rtol", "1e-6", "--limit", "30", "--orthant", sys.argv[1]]
)
if silent > 0:
    sys.exit(f"tolerance: {silent:.1%} of the scenes of a kind err by more than 100 rtol, and no word is said")
if judged < 0.6:
    sys.exit(f"tolerance: only {judged:.0%} of the scenes of a kind could be judged")
