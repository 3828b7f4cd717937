"""Rounds of large assemblies: what they begin with, how their steps are lengthened, where they end."""

from dataclasses import replace

import numpy as np
import pytest

import wiggleroom as wr
from wiggleroom.assembly.build import assemble
from wiggleroom.audit import path_audit
from wiggleroom.drawing.model import Region
from wiggleroom.freespace.cells.cells import grow_cells
from wiggleroom.geometry.relative_pose import relative_pose
from wiggleroom.maximise import witness
from wiggleroom.parallel.batches import in_batches
from wiggleroom.program.nonlinear_program import build_program
from wiggleroom.search.prepare import prepare_as_drawn
from wiggleroom.solve import interior_point
from wiggleroom.solve.carried_multipliers import even_multipliers, pair_wrenches
from wiggleroom.solve.factorisation import factor
from wiggleroom.solve.newton_step import Iterate, max_step, newton
from wiggleroom.solve.predictor_corrector import corrected


@pytest.fixture(scope="module")
def ready():
    return prepare_as_drawn(wr.patterns.grid(6, 5, joint="tee", gap=0.02))


@pytest.fixture(scope="module")
def program(ready):
    return build_program(ready.bodies, ready.cells, ready.objective(ready.assembly.goals), length=ready.clearance)


def iterate(program, rng, spread):
    """A point a little beside rest, whose products of slack and multiplier lie apart by a factor."""
    u = 1e-2 * rng.standard_normal(len(program.scale))
    at = program.linearise(u)
    s = np.maximum(at.h, 1e-3)
    lam = 0.1 / s * np.exp(spread * rng.standard_normal(len(s)))
    return Iterate(u, s, lam, at, interior_point.barrier_unit(at), np.zeros_like(u), 1e-8)


def test_correctors_lengthen_steps_and_keep_the_rows(program):
    longer = []
    for seed in range(6):
        rng = np.random.default_rng(seed)
        state = iterate(program, rng, 2.0)
        matrix = factor(program.pattern)
        assert matrix.update(state.at.condensed(state.lam / state.s, 0 * state.lam), 1e-3)
        dual, gap, _ = state.residuals()
        mean = gap / len(state.s)
        plain = newton(state, matrix, dual, 0.3 * mean - state.s * state.lam)
        before = plain.primal_step + plain.dual_step
        assert np.allclose(before, max_step(state.s, plain.s) + max_step(state.lam, plain.lam), rtol=1e-12)
        better = corrected(state, matrix, plain, 0.3 * mean, np.empty_like(state.s))
        after = max_step(state.s, better.s) + max_step(state.lam, better.lam)
        assert np.allclose(after, better.primal_step + better.dual_step, rtol=1e-12)
        assert after >= before
        longer.append(after - before)
        # slacks still follow the rows to first order, here by the Jacobian as a matrix
        assert np.allclose(
            state.at.jacobian() @ better.u - better.s, state.s - state.at.h, atol=1e-9 * np.abs(better.s).max()
        )
    assert max(longer) > 0.1


def test_step_lengths_keep_every_row(program):
    rng = np.random.default_rng(2)
    for scale in (0.1, 1.0, 30.0):
        x, dx = rng.random(500) + 0.01, scale * rng.standard_normal(500)
        step = max_step(x, dx)
        assert (x + step * dx).min() >= -1e-15
        assert step == 1.0 or (x + 1.0001 * step * dx).min() < 0


def test_new_walls_push_as_the_old_ones_did(ready, program):
    """Cells grown elsewhere get multipliers whose forces balance what the old ones balanced; the others keep theirs."""
    solution = interior_point.solve(program, tolerance=1e-2)
    at = program.linearise(solution.inner)
    assert solution.inner_lam is not None
    bodies, cells = ready.bodies, ready.cells
    seed = relative_pose(bodies, cells.a, cells.b, program.motion(solution.inner))
    grown, good = grow_cells(bodies, cells.a, cells.b, seed, np.full(len(seed), ready.clearance))
    assert good.all()
    other = build_program(bodies, grown, program.objective, length=program.length)
    there = other.linearise(solution.inner)
    forces = pair_wrenches(at, solution.inner_lam)
    lam = even_multipliers(
        there, solution.inner_mu * interior_point.barrier_unit(at), forces, np.full(other.rows, np.nan)
    )
    assert (lam > 0).all()
    balance = at.jacobian().T @ solution.inner_lam
    even = solution.inner_mu * interior_point.barrier_unit(at) / there.h
    missed, without = (np.abs(there.jacobian().T @ x - balance).sum() for x in (lam, even))
    assert missed < 0.5 * without
    # where nothing is new nothing changes
    assert np.array_equal(even_multipliers(at, 1.0, forces, solution.inner_lam), solution.inner_lam)
    # and a round that begins so is near its path: it takes no more steps than one that begins even
    warm = interior_point.solve(other, solution.inner, mu=solution.inner_mu, multipliers=lam, tolerance=1e-6)
    even_start = interior_point.solve(other, solution.inner, mu=solution.inner_mu, tolerance=1e-6)
    assert warm.status == "converged"
    assert warm.iterations <= even_start.iterations
    value = [program.objective.value(program.motion(x.u)) for x in (warm, even_start)]
    assert value[0] == pytest.approx(value[1], rel=1e-4)


def shuffled(assembly, rng):
    """The same parts in another order."""
    drawing = assembly.drawing
    return assemble(replace(drawing, parts=tuple(drawing.parts[k] for k in rng.permutation(len(drawing.parts)))))


def mirrored(assembly):
    """Left and right exchanged; the pull goes up as before."""

    def turned_over(region):
        flip = np.array([-1.0, 1.0])
        return Region(region.outer[::-1] * flip, tuple(hole[::-1] * flip for hole in region.holes))

    drawing = assembly.drawing
    parts = tuple(
        replace(part, regions=tuple(map(turned_over, part.regions)), at=(-part.at[0], part.at[1], -part.at[2]))
        for part in drawing.parts
    )
    return assemble(replace(drawing, parts=parts))


def test_order_and_handedness_of_the_parts_change_nothing():
    assembly = wr.patterns.grid(14, 13, joint="tee", gap=0.01)
    rng = np.random.default_rng(1)
    values = [witness(one).objective for one in (assembly, shuffled(assembly, rng), mirrored(assembly))]
    assert max(values) / min(values) - 1 < 1e-4


def test_paths_are_judged_alike_in_batches(monkeypatch):
    answer = witness(wr.patterns.grid(6, 5, joint="tee", gap=0.02))
    cut = answer.waypoints[[0, len(answer.waypoints) // 2, -1]].copy()
    cut[-1, 3:9, 0] += 0.4
    whole = [path_audit.audit_path(answer.assembly, waypoints) for waypoints in (answer.waypoints, cut)]
    monkeypatch.setattr(path_audit, "STOP_CHECK_CORNERS", 200)
    split = [path_audit.audit_path(answer.assembly, waypoints) for waypoints in (answer.waypoints, cut)]
    assert whole[0].free
    assert not whole[1].free
    for one, other in zip(whole, split, strict=True):
        for name in ("doubtful", "a", "b", "piece"):
            assert np.array_equal(getattr(one, name), getattr(other, name))


def test_batches_keep_their_order():
    assert in_batches(1000, 7, lambda some: list(range(1000))[some])[0] == list(range(142))
    assert np.concatenate(in_batches(1000, 7, lambda some: np.arange(1000)[some])).tolist() == list(range(1000))
