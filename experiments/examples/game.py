"""A bimatrix game: all equilibria that Lemke and Howson's paths connect."""

import numpy as np
import orthant

gain_1 = np.array([[3, 3], [2, 5], [0, 6]])
gain_2 = np.array([[3, 2], [2, 6], [3, 1]])
for e in orthant.equilibria(-gain_1, -gain_2):  # costs
    print("x =", e.x.round(4), " y =", e.y.round(4), " gains", round(-e.cost_1, 4), round(-e.cost_2, 4))
