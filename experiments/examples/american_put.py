"""An American put option: what it is worth, and below which price it is exercised."""

import numpy as np
import orthant
import scipy.sparse as sp

strike, rate, sigma, maturity = 100.0, 0.05, 0.2, 1.0
n, steps = 400, 200
x = np.linspace(np.log(strike / 4), np.log(strike * 4), n + 2)[1:-1]  # x = log S
dx, dt = x[1] - x[0], maturity / steps
payoff = np.maximum(strike - np.exp(x), 0)

# Black-Scholes in x, implicit in time: B v = old v while the option is held
slope, curve = (rate - sigma**2 / 2) / (2 * dx), sigma**2 / (2 * dx**2)
B = sp.diags([dt * (slope - curve), 1 + dt * (rate + 2 * curve), -dt * (slope + curve)], [-1, 0, 1], shape=(n, n),
             format="csr")
edge = np.zeros(n)
edge[0] = dt * (curve - slope) * (strike * (1 - 1 / 4))  # worth the payoff at the left end

# v >= payoff, B v >= old v, one of the two equal: z = v - payoff, one problem a step
solver, v = orthant.Solver("auto"), payoff.copy()
for _ in range(steps):
    result = solver.solve(B, B @ payoff - v - edge)
    assert result.solved
    v = payoff + result.z
held = v > payoff
print(f"worth at S = 100: {np.interp(np.log(100), x, v):.3f} (6.090 by a fine binomial tree)")
print(f"exercised below S = {np.exp(x[held][0]):.1f}")
