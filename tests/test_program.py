"""The program: every derivative against finite differences, and steps that respect rotation."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import scipy.sparse as sp

from wiggleroom.assembly import patterns
from wiggleroom.drawing.model import Closer, Pull, Towards, Translation, Turn, W
from wiggleroom.geometry.relative_pose import relative_pose
from wiggleroom.geometry.row_kinds import A_EDGE, B_EDGE, HIGH_TURN, LOW_TURN
from wiggleroom.program.objectives import TERMS, objective
from wiggleroom.program.retraction import Retraction, factorised

from .programs import ASSEMBLIES, first_program

KINDS = {"corner of B": A_EDGE, "corner of A": B_EDGE, "angle from": LOW_TURN, "angle to": HIGH_TURN}
GOALS = {
    Pull: lambda name: [Pull(name, (0.6, -0.8)), Pull(name, (-3, 1), point=(2.5, -1.2), weight=0.3)],
    Turn: lambda name: [Turn(name, "ccw", 0.7), Turn(name, "cw", -1.3)],
    W: lambda name: [W(name, (0.2, -0.4, 1.7), weight=2.0)],
    Towards: lambda name: [Towards(name, (2, 1), (2.5, -1.2), 0.7), Towards(name, (-3, 0.5))],
    Translation: lambda _: [Translation(0.4)],
    Closer: lambda _: [Closer(0.7)],
}
each_assembly = pytest.mark.parametrize("name", ASSEMBLIES)
each_seed = pytest.mark.parametrize("seed", [0, 1])


@cache
def program(name):
    return first_program(ASSEMBLIES[name]())


def anywhere(of, seed):
    """Scaled variables of a random motion, tenths of a part and a radian: derivatives must not care what is legal."""
    random = np.random.default_rng(seed)
    motion = np.zeros((len(of.slot), 3))
    motion[of.free] = random.uniform(-0.3, 0.3, (len(of.free), 3))
    return of.variables(motion), random


def slope(function, u, step):
    """Derivative of a function along every variable, (m, 3F), error of fourth order in `step` (3F,)."""
    columns = []
    for k in range(len(u)):
        d = np.zeros_like(u)
        d[k] = step[k]
        columns.append(
            (8 * (function(u + d) - function(u - d)) - function(u + 2 * d) + function(u - 2 * d)) / (12 * step[k])
        )
    return np.array(columns).T


def steps(of):
    """Steps of a thousandth of a millimetre or radian in scaled variables."""
    return 1e-3 / of.scale


def whole(of, data):
    """The symmetric matrix of an upper triangle."""
    upper = sp.csc_matrix((data, of.pattern.indices, of.pattern.indptr), shape=(len(of.scale),) * 2).toarray()
    return upper + np.triu(upper, 1).T


def close(found, wanted, share):
    np.testing.assert_allclose(found, wanted, rtol=0, atol=share * max(np.abs(wanted).max(), 1e-300))


@each_assembly
@pytest.mark.parametrize("kind", KINDS)
def test_jacobian_of_every_row_kind(name, kind):
    of = program(name)
    u, _ = anywhere(of, 2)
    rows = of.geometry.kind == KINDS[kind]
    assert rows.any()
    found = of.linearise(u).jacobian().toarray()[rows]
    close(found, slope(of.values, u, steps(of))[rows], 1e-8)


@each_assembly
@each_seed
def test_condensed_matrix(name, seed):
    of = program(name)
    u, random = anywhere(of, seed)
    at = of.linearise(u)
    weight, lam = random.uniform(0, 2, (2, of.rows))
    curved = slope(lambda v: of.linearise(v).transposed_jacobian_product(lam) + of.linearise(v).gradient, u, steps(of))
    J = at.jacobian()
    close(whole(of, at.condensed(np.zeros(of.rows), lam)), -curved, 1e-8)
    close(whole(of, at.condensed(weight, lam)), (J.T @ sp.diags(weight) @ J).toarray() - curved, 1e-8)
    rows_only = slope(lambda v: of.linearise(v).transposed_jacobian_product(lam), u, steps(of))
    half = -rows_only - (curved - rows_only) / 2  # the solver divides the objective by its largest derivative
    close(whole(of, at.condensed(np.zeros(of.rows), lam, share=0.5)), half, 1e-8)


@each_assembly
@pytest.mark.parametrize("kind", KINDS)
def test_second_derivatives_of_every_row_kind(name, kind):
    of = program(name)
    u, random = anywhere(of, 3)
    lam = random.uniform(0, 2, of.rows) * (of.geometry.kind == KINDS[kind])
    nothing = np.zeros(of.rows)
    at = of.linearise(u)
    found = whole(of, at.condensed(nothing, lam)) - whole(of, at.condensed(nothing, nothing))
    wanted = -slope(lambda v: of.linearise(v).transposed_jacobian_product(lam), u, steps(of))
    scale = np.abs(at.transposed_jacobian_product(lam)).max()
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-7 * scale)


@each_assembly
@each_seed
def test_condensed_matrix_with_balance_is_the_curvature_along_steps(name, seed):
    of = program(name)
    u, random = anywhere(of, seed)
    at, retraction = of.linearise(u), Retraction(of)
    lam = random.uniform(0, 2, of.rows)
    balance = retraction.balance(-at.gradient - at.transposed_jacobian_product(lam), at)
    matrix = whole(of, at.condensed(np.zeros(of.rows), lam, balance))
    for _ in range(4):
        du = random.normal(size=len(u)) * 0.1 / of.scale

        def along(t, du=du):
            v = retraction.step(u, t * du, at)
            return of.linearise(v).value + lam @ of.values(v)

        t = 0.02
        second = (16 * (along(t) + along(-t)) - along(2 * t) - along(-2 * t) - 30 * along(0)) / (12 * t * t)
        size = np.abs(du) @ np.abs(matrix) @ np.abs(du)
        assert du @ matrix @ du == pytest.approx(-second, abs=1e-6 * size)


@pytest.mark.parametrize("term", TERMS, ids=lambda t: t.__name__)
@each_assembly
def test_every_registered_term(name, term):
    assert term in GOALS, f"{term.__name__} is registered in TERMS: give it goals to be tested with"
    assembly = ASSEMBLIES[name]()
    of = program(name)
    movable = [p for p in assembly.names if not of.bodies.fixed[of.bodies.body_of[assembly.names.index(p)]]]
    for part in (movable[0], movable[-1]):
        for goal in GOALS[term](part):
            it = objective(assembly, of.bodies, [goal])
            check_objective(of, it)
            assert it.value(np.zeros((len(of.slot), 3))) == 0.0


def check_objective(of, it):
    n = len(of.slot)
    motion = np.random.default_rng(7).uniform(-1, 1, (n, 3))
    h = np.full(3 * n, 1e-3)
    gradient = slope(lambda m: np.array([it.value(m.reshape(-1, 3))]), motion.ravel(), h)[0]
    np.testing.assert_allclose(it.gradient(motion).ravel(), gradient, rtol=0, atol=1e-10)
    curved = slope(lambda m: it.gradient(m.reshape(-1, 3)).ravel(), motion.ravel(), h)
    found = np.zeros((3 * n, 3 * n))
    bodies, own, coupled = it.hessian(motion)
    for body, block in zip(bodies, own, strict=True):
        found[3 * body : 3 * body + 3, 3 * body : 3 * body + 3] += block
    for i, j, block in zip(*it.couples, coupled, strict=True):
        found[3 * i : 3 * i + 3, 3 * j : 3 * j + 3] += block
        found[3 * j : 3 * j + 3, 3 * i : 3 * i + 3] += block.T
    np.testing.assert_allclose(found, curved, rtol=0, atol=1e-9)


def test_a_pulled_point_moves_as_a_material_point():
    assembly = ASSEMBLIES["tees"]()
    of = program("tees")
    index = assembly.names.index("b3-2")
    x, y, angle = motion = (0.3, -0.2, 1.1)
    at, point = complex(*assembly.parts[index].at[:2]), 2.5 - 1.2j
    wanted = (point - at) * np.exp(1j * angle) + at + complex(x, y) - point
    motions = np.zeros((len(of.slot), 3))
    body = of.bodies.body_of[index]
    origin = complex(*of.bodies.rest[body, :2])
    moved = (
        (origin - at) * np.exp(1j * angle) + at + complex(x, y) - origin
    )  # the same motion about the body's own origin
    motions[body] = moved.real, moved.imag, motion[2]
    value = objective(assembly, of.bodies, [Pull("b3-2", (3, 4), point=(point.real, point.imag), weight=2.0)]).value(
        motions
    )
    assert value == pytest.approx(2 * (0.6 * wanted.real + 0.8 * wanted.imag), abs=1e-13)


def test_a_step_turns_a_long_chain_as_a_rigid_body():
    of = first_program(patterns.chain(10))
    u, turn = np.zeros(len(of.scale)), 0.3
    motion, place = np.zeros((10, 3)), of.bodies.rest[:, 0] + 1j * of.bodies.rest[:, 1]
    arm = place[1:] - place[1]
    motion[1:] = np.column_stack([turn * -arm.imag, turn * arm.real, np.full(9, turn)])
    after = of.motion(Retraction(of).step(u, of.variables(motion), of.linearise(u)))
    turned = arm * np.exp(1j * turn) - arm
    wanted = np.column_stack([turned.real, turned.imag, np.full(9, turn)])
    np.testing.assert_allclose(after[1:], wanted, atol=1e-7)
    assert np.abs(motion[1:] - wanted).max() > 0.3  # a straight step would miss by more than a third of a block


def test_laplacians_of_many_bodies_are_solved_alike_whether_it_is_known_where_they_lie():
    """By fronts, in whatever order the entries stand, and by qdldl."""
    wide, high = 30, 25
    at = np.stack(np.meshgrid(np.arange(wide), np.arange(high)), -1).reshape(-1, 2)
    body, rng = np.arange(wide * high).reshape(high, wide), np.random.default_rng(5)
    one = np.concatenate([body[:, :-1].ravel(), body[:-1].ravel(), body[:-1, :-1].ravel()])
    other = np.concatenate([body[:, 1:].ravel(), body[1:].ravel(), body[1:, 1:].ravel()])
    weight = rng.uniform(0.1, 10.0, len(one))
    degree = np.bincount(np.concatenate([one, other]), np.concatenate([weight, weight])) + 1e-3
    row, column = np.concatenate([body.ravel(), one]), np.concatenate([body.ravel(), other])
    entry, order = np.concatenate([degree, -weight]), rng.permutation(len(one) + body.size)
    right = rng.standard_normal(body.size)
    x = factorised(row[order], column[order], entry[order], body.size, at.astype(float)).solve(right)
    np.testing.assert_allclose(x, factorised(row, column, entry, body.size).solve(right), rtol=1e-9)
    left = degree * x
    np.subtract.at(left, one, weight * x[other])
    np.subtract.at(left, other, weight * x[one])
    np.testing.assert_allclose(left, right, atol=1e-9)


@each_assembly
@pytest.mark.parametrize("term", [Translation, Closer])
def test_condensed_matrix_with_an_objective_of_the_whole(name, term):
    of = first_program(ASSEMBLIES[name](), [term(0.3), Turn(ASSEMBLIES[name]().names[0])])
    u, random = anywhere(of, 9)
    at = of.linearise(u)
    lam = random.uniform(0, 2, of.rows)
    curved = slope(lambda v: of.linearise(v).transposed_jacobian_product(lam) + of.linearise(v).gradient, u, steps(of))
    close(whole(of, at.condensed(np.zeros(of.rows), lam)), -curved, 1e-8)


@each_assembly
@each_seed
def test_products_are_those_of_the_jacobian(name, seed):
    of = program(name)
    u, random = anywhere(of, seed)
    at = of.linearise(u)
    du, y = random.normal(size=len(u)), random.normal(size=of.rows)
    close(at.h, of.values(u), 1e-14)
    close(at.jacobian_product(du), at.jacobian() @ du, 1e-13)
    close(at.transposed_jacobian_product(y), at.jacobian().T @ y, 1e-13)


@each_assembly
@each_seed
def test_relative_poses_are_what_the_part_sees(name, seed):
    of = program(name)
    u, _ = anywhere(of, seed)
    pose = of.bodies.rest + of.motion(u)
    place = pose[:, 0] + 1j * pose[:, 1]
    a, b = of.cells.a, of.cells.b
    seen = (place[b] - place[a]) * np.exp(-1j * pose[a, 2])
    g, turn = of.relative(of.motion(u))
    close(g, np.column_stack([seen.real, seen.imag, pose[b, 2] - pose[a, 2]]), 1e-13)
    close(turn, np.column_stack([np.cos(pose[a, 2]), np.sin(pose[a, 2])]), 1e-13)
    close(relative_pose(of.bodies, a, b, of.motion(u)), g, 1e-13)


@each_assembly
def test_half_way_is_the_same_from_both_ends(name):
    of = program(name)
    u, random = anywhere(of, 6)
    v = u + random.normal(size=len(u)) * 0.05 / of.scale
    retraction = Retraction(of)
    np.testing.assert_allclose(retraction.between(u, v), retraction.between(v, u), rtol=0, atol=1e-10 / of.scale.min())
    np.testing.assert_allclose(retraction.between(u, u) * of.scale, u * of.scale, rtol=0, atol=1e-7)
    off = np.abs(retraction.between(u, v) - (u + v) / 2) * of.scale
    assert off.max() < 0.1
