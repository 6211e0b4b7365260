"""Linear complementarity problems and the nonsmooth mechanics that produces them.

>>> import orthant
>>> result = orthant.solve([[2.0, 1.0], [1.0, 2.0]], [-5.0, -6.0])
>>> result.status, result.z
('solved', array([1.33333333, 2.33333333]))

`solve`, `analyse`, `enumerate_solutions`, `error_bound`: problems `z in [lower, upper], w = M z + q`, row by row
complementary. `sensitivity`: derivatives of a solution. `solve_mcp`: the same with a nonlinear F. `equilibrium`,
`equilibria`: bimatrix games. `Scene`, `simulate`, `sweep`: planar mechanisms with joints, clearances, impacts and
friction. Nothing is called solved that an independent judge has not recomputed and accepted.
"""

from . import _pages as _pages  # first: where the parts of pages are
from ._autodiff import as_jax, as_torch
from ._derivatives import (Gradient, Lyapunov, RunAdjoint, RunGradient, RunTangent, Sensitivity, Tangent, WeaklyActive,
                           gradient, lyapunov, sensitivity)
from ._files import read_problem, set_largest_input, write_fclib, write_npz, write_problem
from ._models import ImportedModel, import_model
from ._nonlinear import McpResult, equilibria, equilibrium, extreme_equilibria, solve_mcp
from ._orthant import Equilibrium, Face, LogEntry, Problem, Result, Solutions, Step, __version__, revision
from ._problems import (
    Delassus, Solver, analyse, enumerate_solutions, error_bound, register_solver, solve, solve_many, solvers)
from ._scene import Scene, register_scene, scenes
from ._simulate import OrthantWarning, integrators, register_integrator, simulate
from ._sweep import sweep
from ._trajectory import Interrupted, Trajectory

__all__ = [
    "Delassus", "Equilibrium", "Face", "Gradient", "ImportedModel", "Interrupted", "LogEntry", "Lyapunov", "McpResult",
    "OrthantWarning", "Problem", "Result", "RunAdjoint", "RunGradient", "RunTangent", "Scene", "Sensitivity",
    "Solutions", "Solver", "Step", "Tangent", "Trajectory", "WeaklyActive", "__version__", "analyse", "as_jax",
    "as_torch", "enumerate_solutions", "equilibria", "equilibrium", "error_bound", "extreme_equilibria", "gradient",
    "import_model", "integrators", "lyapunov", "read_problem", "register_integrator", "register_scene",
    "register_solver", "revision", "scenes", "sensitivity", "set_largest_input", "simulate", "solve", "solve_many",
    "solve_mcp", "solvers", "sweep", "write_fclib", "write_npz", "write_problem",
]
