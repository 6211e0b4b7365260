"""Pinocchio (PyPI: pin): its ADMM of contact problems with Coulomb's cone, symmetric matrices; the protocol of
driver.h."""
import sys
import time

import numpy as np

METHODS = {"admm": "discs"}


def read(path):
    with open(path, "rb") as file:
        n, entries, frictions = np.fromfile(file, np.int64, 3)
        start = np.fromfile(file, np.int64, n + 1)
        column, value = np.fromfile(file, np.int32, entries), np.fromfile(file, np.float64, entries)
        b, _, _ = (np.fromfile(file, np.float64, n) for _ in range(3))
        row, normal = (np.fromfile(file, np.int32, frictions) for _ in range(2))
        mu, rows = np.fromfile(file, np.float64, frictions), np.fromfile(file, np.int32, frictions)
    return n, start, column, value, b, row, normal, mu, rows


def solve(path, tolerance):
    import pinocchio as pin
    import scipy.sparse as sparse
    n, start, column, value, b, row, normal, mu, rows = read(path)
    k = np.arange(len(mu))
    if n != 3 * len(mu) or (row != 3 * k + 1).any() or (normal != 3 * k).any() or (rows != 2).any():
        return "unsupported 0 0 0 not three rows a contact", []
    order = np.arange(n).reshape(-1, 3)[:, [1, 2, 0]].ravel()  # theirs: tangents, then the normal
    matrix = sparse.csr_matrix((value, column, start), (n, n))[order][:, order].tocsc()
    if abs(matrix - matrix.T).max() > 1e-9 * abs(matrix).max():
        return "unsupported 0 0 0 an unsymmetric matrix", []
    model = pin.Model()
    model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "body")
    models, datas = pin.StdVec_ConstraintModel(), pin.StdVec_ConstraintData()
    for friction in mu:
        contact = pin.PointContactConstraintModel(model, 1)
        contact.setFriction(float(friction))
        models.append(pin.ConstraintModel(contact))
        datas.append(models[-1].createData())
    settings = pin.ADMMSolverSettings()
    settings.absolute_feasibility_tol = settings.absolute_complementarity_tol = tolerance
    settings.relative_feasibility_tol = settings.relative_complementarity_tol = tolerance
    settings.max_iterations = 20000
    times, found, result = [], None, None
    while not times or (len(times) < 5 and sum(times) + times[0] < 0.1):
        delassus, solver = pin.DelassusOperatorSparse(matrix), pin.ADMMConstraintSolver(int(n))
        result = pin.ADMMSolverResult()
        begin = time.process_time()
        found = solver.solve(delassus, b[order], models, datas, settings, result)
        times.append(time.process_time() - begin)
    z = np.empty(n)
    z[order] = result.retrieveConstraintImpulses()
    return f"{'solved' if found else 'failed'} {result.iterations} {len(times)} {np.median(times):.9g} -", z


def main():
    if len(sys.argv) == 1:
        import pinocchio  # absent: the caller hears of it  # noqa: F401
        print(*(f"{name} {takes}" for name, takes in METHODS.items()), sep="\n")
        return
    _, problem, answer, tolerance = sys.argv[1:]
    line, z = solve(problem, float(tolerance))
    with open(answer, "w") as file:
        print(line, *(f"{x:.17g}" for x in z), sep="\n", file=file)


if __name__ == "__main__":
    main()
