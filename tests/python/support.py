"""Problems that several test files make."""

import numpy as np


def random_problem(n, seed=1):
    rng = np.random.default_rng(seed)
    A = rng.standard_normal((n, n))
    return A @ A.T + np.eye(n), rng.standard_normal(n)
