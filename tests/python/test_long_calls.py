"""Long calls from Python: other threads run meanwhile; time limits and Ctrl-C end them; values go to other
processes."""

import copy
import pickle
import signal
import threading
import time

import numpy as np
import orthant
import pytest
import scipy.sparse as sp

from support import random_problem

M = np.array([[2.0, 1.0], [1.0, 2.0]])
q = np.array([-5.0, -6.0])


def large_problem(n):
    """As fast to make as to fill: definite and diagonally dominant, not symmetric."""
    rng = np.random.default_rng(1)
    return rng.random((n, n)) + n * np.eye(n), rng.standard_normal(n)


def test_the_interpreter_is_free_while_a_solver_works():
    A, b = random_problem(500)
    solver, ticks, done = orthant.Solver("lemke"), 0, threading.Event()

    def work():
        for _ in range(3):
            solver.solve(A, b)
        done.set()

    thread = threading.Thread(target=work)
    thread.start()
    while not done.is_set():
        ticks += 1
        time.sleep(1e-4)
    thread.join()
    assert ticks > 5


def test_ctrl_c_ends_a_solve(ctrl_c):
    """In the main thread; a signal between calls is none of ours, and the solver answers again afterwards."""
    A, b = large_problem(2500)
    ctrl_c()
    begin = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        orthant.solve(A, b, solver="lemke")
    assert time.perf_counter() - begin < 5
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    assert orthant.solve(M, q, solver="lemke").solved
    with pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGINT)
    assert orthant.solve(M, q, solver="lemke").solved


def test_a_handler_that_does_not_raise_sees_the_run_cancelled(ctrl_c):
    A, b = large_problem(2500)
    heard = []
    signal.signal(signal.SIGINT, lambda *_: heard.append(1))
    ctrl_c()
    assert orthant.solve(A, b, solver="lemke").status == "cancelled" and heard


def test_a_solver_at_work_refuses_a_second_thread():
    A, b = random_problem(600)
    solver, errors = orthant.Solver("lemke"), []

    def work():
        for _ in range(3):
            try:
                solver.solve(A, b)
            except RuntimeError as error:
                errors.append(str(error))

    threads = [threading.Thread(target=work) for _ in range(2)]
    [t.start() for t in threads]
    [t.join() for t in threads]
    assert errors and "another thread" in errors[0]


def test_a_call_costs_microseconds():
    """10 x 10: what a call takes beyond the solver itself, 15 us asked for (3 to 9 measured, by machine)."""
    A, b = random_problem(10)

    def beyond():
        begin = time.perf_counter()
        inside = sum(orthant.solve(A, b).seconds for _ in range(100))
        return (time.perf_counter() - begin - inside) / 100

    best = min(beyond() for _ in range(30))
    print(f"{1e6 * best:.1f} us beyond the solver")  # pytest -s shows it
    assert best < 15e-6


def copies(value):
    return copy.copy(value), copy.deepcopy(value), pickle.loads(pickle.dumps(value))


def test_values_go_to_other_processes():
    for matrix in (M, sp.csr_matrix(M), orthant.Delassus(sp.csr_matrix(np.eye(2)), [1.0, 2.0], [0.5, 0.5])):
        for p in copies(orthant.Problem(matrix, [-5.0, -6], lower=[0, -np.inf], friction=[(1, 0, 0.3)])):
            assert p.q.tolist() == [-5, -6] and p.lower.tolist() == [0, -np.inf] and p.friction == [(1, 0, 0.3)]
            assert np.array_equal(orthant.solve(p).z, orthant.solve(matrix, q, friction=[(1, 0, 0.3)]).z)
    result = orthant.solve([[-1.0, 0], [0, 1]], [-1.0, 1], solver="lemke", log=True)
    for r in copies(result):
        assert (r.status, r.iterations, r.seconds, len(r.log)) == (result.status, result.iterations, result.seconds,
                                                                   len(result.log))
        assert np.array_equal(r.certificate, result.certificate) and r.log[0].event == result.log[0].event
    for s in copies(orthant.enumerate_solutions([[1.0, -1], [-1, 1]], [0.0, 0])):
        assert s.complete and s.faces[0].directions[0].tolist() == [1, 1]
    for e in copies(orthant.equilibrium(M, M)):
        assert np.isclose(e.x.sum(), 1)
    for solver in copies(orthant.Solver("pgs", omega=1.5)):
        assert repr(solver) == "Solver('pgs:omega=1.5')" and solver.solve(M, q).solved


def beside(work, until=0.2):
    """How often another thread gets to run while `work` does, which is told to end after `until` seconds."""
    ticks, done = 0, threading.Event()

    def count():
        nonlocal ticks
        while not done.is_set():
            ticks += 1
            time.sleep(1e-3)

    thread = threading.Thread(target=count)
    thread.start()
    begin = time.perf_counter()
    try:
        work(until)
    except TimeoutError:
        pass
    finally:
        seconds = time.perf_counter() - begin
        done.set()
        thread.join()
    return ticks, seconds


LARGE = large_problem(1200)
CORNERS = -np.eye(18), np.ones(18)  # each of a cube is a solution
COSTS = np.random.default_rng(1).random((2, 60, 60))
LONG = {"analyse": lambda t: orthant.analyse(LARGE[0], time_limit=t),
        "enumerate": lambda t: orthant.enumerate_solutions(*CORNERS, time_limit=t),
        "error bound": lambda t: orthant.error_bound(*LARGE, z=np.ones(1200), time_limit=t),
        "equilibria": lambda t: orthant.equilibria(*COSTS, time_limit=t)}


@pytest.mark.parametrize("name", LONG)
def test_long_calls_let_other_threads_run_and_end_in_time(name):
    ticks, seconds = beside(LONG[name])
    assert 0.1 < seconds < 5 and ticks > 20  # a lock that is held leaves one or two


@pytest.mark.parametrize("name", LONG)
def test_ctrl_c_ends_long_calls(ctrl_c, name):
    ctrl_c()
    begin = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        LONG[name](60)
    assert time.perf_counter() - begin < 10


def test_answers_cut_short_by_the_time_limit_say_so():
    assert orthant.enumerate_solutions(*CORNERS, time_limit=1e-3).complete is False
    assert orthant.enumerate_solutions(M, q, time_limit=60).complete is True
    a = orthant.analyse(random_problem(12)[0], time_limit=1e-9)
    assert a["p"] is None and a["symmetric"] is True and np.isnan(a["condition"])
    with pytest.raises(TimeoutError, match="time_limit"):
        orthant.equilibria(*COSTS, time_limit=1e-3)
