"""A nonlinear complementarity problem by callbacks: a market clears where supply covers demand or the price is zero."""

import numpy as np
import orthant

demand = np.array([10.0, 4.0, 1.0])


def excess(p):  # supply less demand at prices p
    return np.sqrt(p + 1) * 3 - demand / (1 + p)


def slope(p):
    return np.diag(1.5 / np.sqrt(p + 1) + demand / (1 + p) ** 2)


result = orthant.solve_mcp(excess, slope, start=np.ones(3))
print(result.status, "prices", result.z.round(6), "excess", result.F.round(9))
