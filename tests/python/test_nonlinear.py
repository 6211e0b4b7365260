"""Problems by callbacks, and games."""

import numpy as np
import orthant
import pytest
import scipy.sparse as sp


def kojima_shindo(z):  # Dirkse & Ferris' collection: solutions (sqrt(6)/2, 0, 0, 1/2) and (1, 0, 3, 0)
    a, b, c, d = z
    return np.array([3 * a * a + 2 * a * b + 2 * b * b + c + 3 * d - 6, 2 * a * a + a + b * b + 10 * c + 2 * d - 2,
                     3 * a * a + a * b + 2 * b * b + 2 * c + 9 * d - 9, a * a + 3 * b * b + 2 * c + 3 * d - 3])


def slope(z):
    a, b, _, _ = z
    return np.array([[6 * a + 2 * b, 2 * a + 4 * b, 1, 3], [4 * a + 1, 2 * b, 10, 2], [6 * a + b, a + 4 * b, 2, 9],
                     [2 * a, 6 * b, 2, 3]])


@pytest.mark.parametrize("form", [lambda J: J, sp.csr_matrix, lambda J: J.tolist()])
def test_a_nonlinear_problem(form):
    r = orthant.solve_mcp(kojima_shindo, lambda z: form(slope(z)), np.zeros(4))
    assert r.solved and r.residual < 1e-9
    assert np.allclose(r.z, [np.sqrt(6) / 2, 0, 0, 0.5]) or np.allclose(r.z, [1, 0, 3, 0])
    assert np.allclose(r.F, kojima_shindo(r.z))


def test_bounds():
    r = orthant.solve_mcp(lambda z: z - 5, lambda z: np.eye(1), [0.0], upper=[2.0])
    assert r.solved and r.z[0] == 2


def test_errors_of_callbacks_reach_the_caller():
    def fails(z):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        orthant.solve_mcp(fails, slope, np.zeros(4))
    with pytest.raises(ValueError, match=r"F returned 3 numbers: must be \(4,\)"):
        orthant.solve_mcp(lambda z: np.zeros(3), slope, np.zeros(4))
    with pytest.raises(ValueError, match="jacobian returned another shape"):
        orthant.solve_mcp(kojima_shindo, lambda z: np.eye(3), np.zeros(4))
    with pytest.raises(TypeError, match="F = 3: must be a function of z"):
        orthant.solve_mcp(3, slope, np.zeros(4))
    with pytest.raises(ValueError, match="time_limit = -1: must be > 0"):
        orthant.solve_mcp(kojima_shindo, slope, np.zeros(4), time_limit=-1)
    with pytest.raises(ValueError, match="unknown option"):
        orthant.solve_mcp(kojima_shindo, slope, np.zeros(4), no_such=1)


def test_games():
    A, B = -np.array([[3.0, 3], [2, 5], [0, 6]]), -np.array([[3.0, 2], [2, 6], [3, 1]
                                                             ])  # von Stengel 2002: three equilibria
    all_of_them = orthant.equilibria(A, B)
    assert sorted(np.round(e.x, 6).tolist() for e in all_of_them) == [[0, 0.333333, 0.666667], [0.8, 0.2, 0], [1, 0, 0]]
    e = orthant.equilibrium(A, B, 0)
    assert np.isclose(e.cost_1, e.x @ A @ e.y) and (A @ e.y).min() >= e.cost_1 - 1e-12
    with pytest.raises(ValueError, match="label"):
        orthant.equilibrium(A, B, 17)


def test_complex_numbers_from_callbacks_are_refused():
    with pytest.raises(TypeError, match="F returned complex numbers"):
        orthant.solve_mcp(lambda z: kojima_shindo(z) + 1j, slope, np.zeros(4))
    with pytest.raises(TypeError, match="jacobian returned complex numbers"):
        orthant.solve_mcp(kojima_shindo, lambda z: slope(z) + 1j, np.zeros(4))
    with pytest.raises(ValueError, match="F returned 4 numbers in 2 dimensions"):
        orthant.solve_mcp(lambda z: kojima_shindo(z)[:, None], slope, np.zeros(4))


def test_entries_that_are_not_finite_are_named():
    bad = orthant.solve_mcp(lambda z: np.array([z[0] - 1, np.nan]), lambda z: np.eye(2), [0.0, 0.0])
    assert bad.status == "numerical_error" and bad.why == "F[1] = nan: must be finite"
    bad = orthant.solve_mcp(lambda z: z - 1, lambda z: np.array([[1.0, np.inf], [0, 1]]), [0.0, 0.0])
    assert bad.why == "jacobian[0, 1] = inf: must be finite"
    assert orthant.solve_mcp(lambda z: z - 1, lambda z: np.eye(2), [0.0, 0.0]).why == ""


def test_an_equilibrium_says_what_rounding_left_of_it():
    K = 1e12
    e = orthant.equilibrium([[K, 0], [K + 1, 1]], [[0, 1], [1, 0]], 1)
    assert e.regret == pytest.approx((e.x @ [[K, 0], [K + 1, 1]] @ e.y) - min([[K, 0], [K + 1, 1]] @ e.y))
    assert orthant.equilibrium([[3, 0], [5, 1]], [[3, 5], [0, 1]]).regret <= 1e-15


def test_all_extreme_equilibria_of_a_degenerate_game():
    A = [[0, 0, 6, 0, 0], [0, 0, 3, 2, 1], [4, 3, 0, 0, 1]]  # after a public bug report, Nashpy#82: players minimize
    B = [[3, 0, 2, 1, 0], [0, 2, 0, 0, 4], [4, 0, 2, 4, 4]]
    found = orthant.extreme_equilibria(A, B)
    assert len(found) == 8 and len({e.label for e in found}) == 4
    for e in found:
        assert e.regret == 0 and e.x.sum() == pytest.approx(1) and e.y.sum() == pytest.approx(1)
        assert e.x @ A @ e.y <= (A @ e.y).min() + 1e-14 and e.x @ B @ e.y <= (e.x @ B).min() + 1e-14
    assert any(np.allclose(e.x, [1 / 3, 1 / 2, 1 / 6]) and np.allclose(e.y, [0, 4 / 9, 2 / 9, 1 / 3, 0]) for e in found)
    with pytest.raises(ValueError, match="same shape"):
        orthant.extreme_equilibria(A, np.ones((2, 2)))
