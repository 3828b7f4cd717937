"""Both solvers on the same programs, held against each other and against the optimality conditions."""

from __future__ import annotations

import sys
import threading
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import nnls

import wiggleroom as wr
from wiggleroom.assembly import patterns
from wiggleroom.errors import InputError, MissingExtraError
from wiggleroom.solve import SOLVERS, interior_point, ipopt, solver_named
from wiggleroom.solve.kkt_conditions import conditions
from wiggleroom.solve.nonnegative_least_squares import nonnegative_least_squares

from .programs import ASSEMBLIES, first_program, squares, with_roles

BOTH = pytest.mark.parametrize("solver", SOLVERS)
USUAL, TIGHT = 1e-7, 1e-9

PROBLEMS = {
    "chain of 10 tees": lambda: patterns.chain(10, gap=0.02),
    "chain of 5 swallowtails": lambda: patterns.chain(5, "swallowtail", 0.03),
    "chain of 10 dovetails": lambda: patterns.chain(10, "dovetail"),
    "revolute chain": lambda: patterns.chain(6, "revolute", 0.02),
    "6 by 5 tees": lambda: patterns.grid(6, 5),
    "frame": lambda: patterns.frame(5, 4),
    "jigsaw": lambda: patterns.jigsaw(4, 3),
    "tees, middle fixed and glued": ASSEMBLIES["tees, middle fixed, two glued"],
}
GOALS = {
    "as made": lambda names: (),
    "sideways": lambda names: [wr.Pull(names[-1], (-0.6, 0.8), point=(3.0, 1.0))],
    "turn": lambda names: [wr.Turn(names[-1], "cw")],
    "several": lambda names: [
        wr.Pull(names[-1], (0, 1)),
        wr.Turn(names[1], "ccw", 0.5),
        wr.W(names[2], (0.3, -0.1, 0.2)),
    ],
}


def problem(name, goal="as made"):
    assembly = PROBLEMS[name]()
    return first_program(assembly, GOALS[goal](assembly.names))


def value(program, solution):
    return program.objective.value(program.motion(solution.u))


def agree(program, size):
    found = {name: solver_named(name)(program, tolerance=TIGHT) for name in SOLVERS}
    for solution in found.values():
        assert solution.status == "converged"
        assert solution.error < 1e-7
        assert solution.lam.min() >= 0
        its = conditions(program, solution.u, solution.lam)
        assert its.hold(size), its
        assert its.stationarity < 1e-5
        assert its.complementarity < 1e-7
    ours, theirs = (value(program, s) for s in found.values())
    assert ours == pytest.approx(theirs, rel=1e-8)


@pytest.mark.parametrize("name", PROBLEMS)
def test_same_optimum_and_optimality_conditions(name):
    agree(problem(name), PROBLEMS[name]().size)


@pytest.mark.parametrize(
    ("name", "goal"), [("6 by 5 tees", "sideways"), ("revolute chain", "turn"), ("6 by 5 tees", "several")]
)  # the others have several local optima, and solvers may end at different ones
def test_same_optimum_for_other_goals(name, goal):
    agree(problem(name, goal), PROBLEMS[name]().size)


@BOTH
def test_multipliers_are_derivatives_of_the_optimum(solver):
    """All rows eased by the same length: the optimum grows by the sum of the multipliers."""
    program = problem("6 by 5 tees")
    solution = solver_named(solver)(program, tolerance=TIGHT)
    e = 1e-5
    rows = program.geometry
    turns = rows.ends + np.array([-e, e]) / rows.lever[:, None]
    eased = replace(program, geometry=replace(rows, off=rows.off - e, ends=turns))
    np.testing.assert_allclose(eased.values(solution.u), program.values(solution.u) + e / program.length, atol=1e-12)
    gained = value(eased, solver_named(solver)(eased, tolerance=TIGHT)) - value(program, solution)
    assert gained == pytest.approx(solution.lam.sum() * e / program.length, rel=2e-3)


@BOTH
@pytest.mark.parametrize("name", PROBLEMS)
def test_the_path_and_the_inner_point_are_strictly_inside(name, solver):
    program = problem(name)
    solution = solver_named(solver)(program, tolerance=USUAL)
    assert len(solution.path) >= 3
    assert not solution.path[0].any()
    for u in solution.path:
        assert program.values(u).min() > 0
    assert any(u is solution.inner for u in solution.path)
    best, inner = value(program, solution), program.objective.value(program.motion(solution.inner))
    assert 0 <= inner < best
    assert solution.inner_mu * program.rows > USUAL  # not at the walls yet


@BOTH
@pytest.mark.parametrize("name", ["6 by 5 tees", "jigsaw"])
def test_a_start_inside_leads_to_the_same_optimum(name, solver):
    program = problem(name)
    solve = solver_named(solver)
    cold = solve(program, tolerance=TIGHT)
    again = solve(program, cold.inner.copy(), mu=cold.inner_mu, tolerance=TIGHT)
    assert again.status == "converged"
    assert np.array_equal(again.path[0], cold.inner)
    assert all(program.values(u).min() > 0 for u in again.path)
    assert value(program, again) == pytest.approx(value(program, cold), rel=1e-7)


@BOTH
def test_stop_by_an_event_from_progress(solver):
    event, seen = threading.Event(), []

    def progress(iteration, objective):
        seen.append((iteration, objective))
        if iteration == 3:
            event.set()

    program = problem("frame")
    solution = solver_named(solver)(program, stop=event, progress=progress)
    assert solution.status == "stopped"
    assert [k for k, _ in seen] == [0, 1, 2, 3]
    assert seen[0][1] == 0.0
    assert seen[-1][1] == pytest.approx(value(program, solution), abs=1e-12)


@BOTH
def test_an_open_assembly_escapes(solver):
    assembly = squares(3)
    program = first_program(assembly)
    solution = solver_named(solver)(program, horizon=4 * assembly.size)
    assert solution.status == "escaping"
    motion = program.motion(solution.u)
    assert np.abs(motion[:, :2]).max() > 4 * assembly.size
    assert motion[2, 0] > 4 * assembly.size
    assert len(solution.path) > 2


@BOTH
@pytest.mark.parametrize(
    "assembly",
    [
        pytest.param(lambda: with_roles(patterns.grid(4, 4), ("b1-1", "b4-1", "b1-4")), id="three corners fixed"),
        pytest.param(lambda: with_roles(patterns.grid(5, 3), ("b1-1",), (("b5-2", "b5-3"),)), id="glued end"),
        pytest.param(lambda: patterns.frame(6, 6, gap=0.003), id="frame"),
    ],
)
def test_degenerate_grids_converge(solver, assembly):
    made = assembly()
    program = first_program(made)
    solution = solver_named(solver)(program)
    assert solution.status == "converged"
    assert solution.iterations < 100
    assert conditions(program, solution.u, solution.lam).hold(made.size)


@pytest.mark.parametrize(
    "assembly",
    [
        pytest.param(lambda: patterns.chain(6, "revolute", 0.02), id="revolute"),
        pytest.param(lambda: patterns.grid(4, 4), id="4 by 4"),
    ],
)
def test_answers_are_the_same_through_flex(assembly):
    made = assembly()
    ours, theirs = (wr.flex(made, solver=name, search=0) for name in SOLVERS)
    assert (ours.solver, theirs.solver) == tuple(SOLVERS)
    assert theirs.objective == pytest.approx(ours.objective, rel=1e-6)
    assert {str(ours.verdict), str(theirs.verdict)} <= {"proven", "optimal", "stationary"}
    assert theirs.collision_free


def test_ipopt_names_the_extra_that_is_missing(monkeypatch):
    monkeypatch.setitem(sys.modules, "casadi", None)
    with pytest.raises(MissingExtraError, match=r"pip install '.\[ipopt\]'"):
        ipopt.solve(problem("jigsaw"))


def test_an_unknown_solver_is_refused_by_name():
    with pytest.raises(InputError, match='"simplex" is not known; solvers are interior-point, ipopt'):
        solver_named("simplex")


def test_conditions_see_what_is_wrong():
    assembly = PROBLEMS["6 by 5 tees"]()
    program = first_program(assembly)
    solution = interior_point.solve(program)
    u, lam = solution.u, solution.lam
    assert conditions(program, u, lam).hold(assembly.size)
    assert not conditions(program, u, 1.1 * lam).hold(assembly.size)
    assert not conditions(program, u, np.zeros_like(lam)).hold(assembly.size)
    assert not conditions(program, u, -lam).hold(assembly.size)
    assert not conditions(program, 1.1 * u, lam).hold(assembly.size)
    assert not conditions(program, np.zeros_like(u), lam).hold(assembly.size)
    push = np.zeros_like(lam)
    push[program.values(u).argmax()] = lam.max()
    assert not conditions(program, u, lam + push).hold(assembly.size)


def test_nonnegative_least_squares_comes_as_near_as_the_library():
    rng = np.random.default_rng(5)
    for case in range(400):
        columns = rng.standard_normal((rng.integers(1, 30), rng.integers(1, 5)))
        if case % 4 == 1:
            columns = np.round(columns)  # many that depend on others, and some that are zero
        elif case % 4 == 2:
            columns *= 10.0 ** rng.uniform(-4, 2, (len(columns), 1))
        elif case % 4 == 3:
            columns[:, 0] = 0.0
        right = columns.T @ np.maximum(rng.standard_normal(len(columns)), 0.0) + (case % 2) * columns[0]
        found, left = nonnegative_least_squares(columns, right)
        size = np.linalg.norm(right)
        assert (found >= 0.0).all()
        assert abs(np.linalg.norm(columns.T @ found - right) - left) <= 1e-9 * size
        assert left <= nnls(columns.T, right)[1] + 1e-9 * size


def test_same_multipliers_where_they_are_unique():
    """The forces that pairs transmit, as single rows need not be unique."""
    program = problem("chain of 5 swallowtails")
    forces = []
    for name in SOLVERS:
        solution = solver_named(name)(program, tolerance=TIGHT)
        at = program.linearise(solution.u)
        pair = np.repeat(np.arange(len(program.cells.a)), np.diff(program.cells.row))
        forces.append(np.column_stack([np.bincount(pair, at.d[:, k] * solution.lam) for k in range(3)]))
    assert np.abs(forces[0]).max() > 0.1
    np.testing.assert_allclose(*forces, atol=1e-4 * np.abs(forces[0]).max())


@BOTH
def test_a_closed_assembly_does_not_escape_within_its_size(solver):
    assembly = PROBLEMS["jigsaw"]()
    assert solver_named(solver)(first_program(assembly), horizon=assembly.size).status == "converged"
