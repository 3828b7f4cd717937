"""Large assemblies: factorisation, distances that the first climb goes by, and where it leads, against truths that share nothing."""

import numpy as np
import pytest
import scipy.sparse as sp
import shapely

import wiggleroom as wr
from wiggleroom.assembly.assembly import place
from wiggleroom.geometry.placed_bodies import placed
from wiggleroom.geometry.relative_pose import relative_pose
from wiggleroom.geometry.row_kinds import A_EDGE
from wiggleroom.geometry.vertex_edge_pairs import near_vertices
from wiggleroom.maximise import witness
from wiggleroom.program.distance_program import build_distances
from wiggleroom.program.multifrontal import FrontalPlan, Multifrontal
from wiggleroom.program.nonlinear_program import build_program
from wiggleroom.search.prepare import prepare_as_drawn
from wiggleroom.solve.factorisation import factor


def block_matrix(at, block, reach, rng):
    """Positive definite matrix of dense blocks between points that are near each other."""
    far = np.linalg.norm(at[:, None] - at[None], axis=2)
    one, other = np.nonzero(np.triu(far < reach, 1))
    n = len(at)
    dense = np.zeros((n, block, n, block))
    for i, j in zip(one, other, strict=True):
        coupling = rng.standard_normal((block, block))
        dense[i, :, j] += coupling
        dense[j, :, i] += coupling.T
    dense = dense.reshape(n * block, n * block)
    own = np.kron(np.eye(n), np.ones((block, block))) * 0.1
    return dense + own + np.diag(np.abs(dense).sum(1) + 1.0), own


def upper(matrix, own):
    """Its upper triangle in compressed columns, the blocks on the diagonal whole."""
    kept = sp.csc_matrix(np.triu(matrix) + 0.0)
    assert (np.abs(np.triu(own)) > 0).sum() <= kept.nnz
    kept.sort_indices()
    return kept


@pytest.mark.parametrize(
    ("shape", "block"), [("grid", 3), ("line", 1), ("scattered", 6), ("islands", 2), ("one place", 3)]
)
def test_multifrontal_solves(block, shape):
    rng = np.random.default_rng(3)
    at = {
        "grid": np.stack(np.meshgrid(np.arange(9.0), np.arange(7.0)), -1).reshape(-1, 2),
        "line": np.column_stack([np.arange(40.0), np.zeros(40)]),
        "scattered": 8 * rng.random((70, 2)),
        "islands": np.concatenate([rng.random((20, 2)), 1000 + rng.random((25, 2))]),
        "one place": np.zeros((30, 2)),
    }[shape]
    matrix, own = block_matrix(at, block, 1.5 if shape != "one place" else 1.0, rng)
    stored = upper(matrix, own)
    factor = Multifrontal(FrontalPlan(at, stored.indptr.astype(np.int64), stored.indices.astype(np.int64), block))
    right = rng.standard_normal(len(matrix))
    for shift in (0.0, 2.5):
        assert factor.update(stored.data, shift)
        assert np.allclose(
            factor.solve(right), np.linalg.solve(matrix + shift * np.eye(len(matrix)), right), atol=1e-10
        )
    assert not factor.update(stored.data, -2 * np.abs(matrix).max())
    assert not factor.update(stored.data, -np.linalg.eigvalsh(matrix)[0] - 1e-6)
    assert factor.update(stored.data, -np.linalg.eigvalsh(matrix)[0] + 1e-6)


@pytest.fixture(scope="module", params=["tee", "revolute", "jigsaw"])
def program(request):
    """Distances of a small grid, at rest and somewhat beside it."""
    assembly = wr.patterns.grid(3, 2, joint=request.param, gap=0.02)
    ready = prepare_as_drawn(assembly)
    n = len(ready.bodies.fixed)
    a, b = np.triu_indices(n, 1)
    near = near_vertices(ready.bodies, a, b, np.zeros((n, 3)), *np.full((2, len(a)), 0.1), 0.05)
    goal = ready.objective(assembly.goals)
    return build_distances(ready.bodies, near, goal, length=ready.clearance)


@pytest.mark.parametrize(
    ("columns", "rows", "joint", "least"),
    [(14, 13, "tee", 1.268), (11, 12, "jigsaw", 1.297)],
)
def test_large_grids_move_far_and_safely(columns, rows, joint, least):
    assembly = wr.patterns.grid(columns, rows, joint=joint, gap=0.01)
    answer = witness(assembly)
    assert answer.path == "checked"
    assert answer.objective >= least
    # judged apart: no two parts share material at waypoints and in between
    outlines = [shapely.union_all([shapely.Polygon(r.outer, r.holes) for r in part.regions]) for part in assembly.parts]
    for one, other in zip(answer.waypoints[:-1:6], answer.waypoints[1::6], strict=False):
        for share in (0.0, 0.5, 1.0):
            motion = (1 - share) * one + share * other
            moved = np.array(
                [
                    shapely.transform(outline, lambda xy, part=part, m=m: place(xy, np.asarray(part.at) + m))
                    for outline, part, m in zip(outlines, assembly.parts, motion, strict=True)
                ]
            )
            i, j = shapely.STRtree(moved).query(moved, predicate="intersects")
            common = shapely.area(shapely.intersection(moved[i[i < j]], moved[j[i < j]]))
            assert common.max(initial=0.0) < 1e-9


def test_solutions_on_two_threads_are_those_of_the_matrix():
    """Subtrees are solved on threads of their own; what they leave for nodes above is put together."""
    assembly = wr.patterns.grid(24, 20, joint="tee", gap=0.02)
    ready = prepare_as_drawn(assembly)
    program = build_program(ready.bodies, ready.cells, ready.objective(assembly.goals), length=ready.clearance)
    rng = np.random.default_rng(3)
    at = program.linearise(np.zeros(len(program.scale)))
    weight, right = rng.random(program.rows) + 0.1, rng.standard_normal(len(program.scale))
    matrix = factor(program.pattern)
    assert isinstance(matrix, Multifrontal)
    assert matrix.update(at.condensed(weight, np.zeros(program.rows), share=0.0), 1e-3)
    jacobian = at.jacobian()
    whole = jacobian.T @ sp.diags(weight) @ jacobian + 1e-3 * sp.eye(len(right))
    x = matrix.solve(right)
    assert np.abs(whole @ x - right).max() < 1e-9 * np.abs(right).max()
    # rows eliminated in batches on two threads: the same sums as by the Jacobian as a matrix
    s, lam, goal = rng.random((3, program.rows)) + 0.1
    primal = s - at.h
    assert np.allclose(at.eliminated_product(s, lam, goal, 1.0), jacobian.T @ ((lam * primal + goal) / s))
    few = np.where(rng.random(program.rows) < 0.01, goal, 0.0)  # as of a corrector
    assert np.allclose(at.eliminated_product(s, lam, few, 0.0), jacobian.T @ (few / s))
    ds, dlam, far, dfar = at.eliminated_changes(x, s, lam, goal, 1.0)
    assert np.allclose(ds, jacobian @ x - primal)
    assert np.allclose(dlam, (goal - lam * ds) / s)
    assert min(1.0, *(s / -ds)[ds < 0]) == pytest.approx(far)
    assert min(1.0, *(lam / -dlam)[dlam < 0]) == pytest.approx(dfar)


def test_derivatives_of_distances(program):
    rng = np.random.default_rng(6)
    u, v = 0.1 * rng.standard_normal((2, len(program.scale)))
    step = 1e-6
    difference = (program.values(u + step * v) - program.values(u - step * v)) / (2 * step)
    assert np.allclose(program.linearise(u).jacobian_product(v), difference, atol=1e-6)


def test_distances_are_those_of_the_geometry(program):
    u = 0.1 * np.random.default_rng(5).standard_normal(len(program.scale))
    near, shapes = program.cells, program.bodies.shapes
    pose = program.bodies.rest + program.motion(u)
    h = program.values(u) * program.length
    for r in range(0, len(h), 7):
        a, b = near.a[near.pair[r]], near.b[near.pair[r]]
        holder, other = (a, b) if near.kind[r] == A_EDGE else (b, a)
        edge = place(shapes.corner[[near.edge[r], shapes.after[near.edge[r]]]], pose[holder])
        corner = place(shapes.corner[[near.corner[r]]], pose[other])[0]
        assert abs(h[r]) == pytest.approx(shapely.distance(shapely.LineString(edge), shapely.Point(corner)), abs=1e-12)
    # the least of them is the distance of the bodies, where that is within reach
    material = placed(program.bodies, program.motion(u))
    for p in np.flatnonzero(np.diff(near.row)):
        apart = shapely.distance(material[near.a[p]], material[near.b[p]])
        assert h[near.row[p] : near.row[p + 1]].min() == pytest.approx(apart, abs=1e-12)


def test_listed_corners_are_all_that_are_near():
    assembly = wr.patterns.grid(2, 2, joint="tee", gap=0.02)
    ready = prepare_as_drawn(assembly)
    bodies, reach = ready.bodies, 0.15
    a, b = np.triu_indices(4, 1)
    near = near_vertices(bodies, a, b, np.zeros((4, 3)), np.full(len(a), reach), np.full(len(a), 0.06), 0.03)
    known = set(zip(near.pair.tolist(), near.kind.tolist(), near.edge.tolist(), near.corner.tolist(), strict=True))
    shapes = bodies.shapes
    pose = relative_pose(bodies, a, b)
    for p in range(len(a)):
        for v in range(*shapes.first[bodies.shape[b[p]] + np.arange(2)]):
            corner = place(shapes.corner[[v]], pose[p])[0]
            for e in range(*shapes.first[bodies.shape[a[p]] + np.arange(2)]):
                line = shapely.LineString(shapes.corner[[e, shapes.after[e]]])
                ahead = shapes.normal[e] @ (corner - shapes.corner[e])
                along = np.array([-shapes.normal[e, 1], shapes.normal[e, 0]]) @ (corner - shapes.corner[e])
                beyond = max(-along, along - shapes.length[e])
                wanted = shapely.distance(line, shapely.Point(corner)) < reach and beyond < 0.06
                wanted &= ahead > (0 if beyond <= 0 else -0.03)
                assert ((p, 0, e, v) in known) == wanted
