"""Your own LCP: 0 <= z, w = M z + q >= 0, z'w = 0; what kind of matrix is it, and are there other solutions?"""

import numpy as np
import orthant

M = np.array([[2.0, 1.0], [1.0, 2.0]])
q = np.array([-5.0, -6.0])

result = orthant.solve(M, q)
print(result.status, result.z, "residual", result.residual)

facts = orthant.analyse(M)
print("P-matrix (exactly one solution for every q):", facts["p"])
print("all solutions:", [z.tolist() for z in orthant.enumerate_solutions(M, q).isolated])

print(orthant.solve([[-1.0]], [-1.0]).status)  # no solution, and a proof in .certificate
