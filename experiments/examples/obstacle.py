"""A membrane above a ball: a sparse problem of 63 x 63 nodes; where does it touch?"""

import numpy as np
import orthant
import scipy.sparse as sp

n = 63
x = np.linspace(-2, 2, n + 2)[1:-1]
second = sp.diags([-1, 2, -1], [-1, 0, 1], shape=(n, n))
laplace = sp.kronsum(second, second, format="csr")
radius2 = x[:, None] ** 2 + x[None, :] ** 2
obstacle = np.where(radius2 <= 1, np.sqrt(np.maximum(1 - radius2, 0)), -1.0).ravel()

# u >= obstacle, -laplace u >= 0, one of the two equal; z = u - obstacle, u = 0 at the boundary
result = orthant.solve(laplace, laplace @ obstacle)
touching = result.z.reshape(n, n) == 0
print(f"{result.status} in {result.seconds:.3f} s, residual {result.residual:.1e}")
print(f"touches within r = {np.sqrt(radius2[touching].max()):.3f} (0.698 for the differential equation)")
