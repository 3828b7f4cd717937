"""Multifrontal Cholesky factorisation of matrices that consist of small dense blocks, one for each vertex of a graph in the plane.

Each node of the elimination tree gathers its own rows and what its children leave over in one dense front, and LAPACK does the work
there. Independent parts of the tree run on both cores. Source: Duff and Reid 1983; Liu 1992.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import types
from numba.extending import get_cython_function_address, intrinsic
from numpy.typing import NDArray
from threadpoolctl import ThreadpoolController

from wiggleroom.compiled.jit_options import NO_ALLOCATION, OPTIONS, njit
from wiggleroom.compiled.scipy_extensions import BLAS, LAPACK, without_packages
from wiggleroom.compiled.vector_operations import BYTES, add_four, add_one
from wiggleroom.parallel.batches import THREADS, in_parallel
from wiggleroom.program.nested_dissection import EliminationTree, dissect

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Indices = NDArray[np.int32] | NDArray[np.int64]

SUBTREE_DEPTH = 3
"""Nodes at this depth are the roots of independent subtrees."""
MIN_THREADED_FRONT = 1500
"""From this many rows in the largest front on, the linear-algebra library may use its own threads for the last fronts."""


class FrontalPlan:
    """What a factorisation does, whatever the numbers are: elimination tree, and where everything lies.

    Parameters
    ----------
    at : (V, 2) float64
        Where the vertices lie.
    indptr, indices : (C + 1,) and (E,) int32 or int64
        Upper triangle of the matrix in compressed columns; the variables of a vertex follow each other.
    block : int
        Variables of a vertex.
    """

    def __init__(self, at: Floats, indptr: Indices, indices: Indices, block: int) -> None:
        column, indices = np.repeat(np.arange(len(indptr) - 1), np.diff(indptr)), indices.astype(np.int64)
        self.tree = tree = dissect(at, *_neighbours(indices // block, column // block, len(at)))
        nodes = len(tree.parent)
        self.block = block
        self.panel, target, owner = _targets(
            tree.first, tree.border_start, tree.border, tree.place, np.repeat(np.arange(nodes), np.diff(tree.first)),
            indices, column, block,
        )  # fmt: skip
        source = np.argsort(owner, kind="stable").astype(np.int32)
        entry = np.concatenate([[0], np.cumsum(np.bincount(owner, minlength=nodes))])
        in_parent, run_end = _places_in_parent(tree.first, tree.border_start, tree.border, tree.parent)
        self.shares, region = _shares(tree)
        place, self.stack = _stack_places(tree.border_start, tree.child, tree.sibling, region, len(self.shares), block)
        self.assembly = (
            tree.first, tree.border_start, tree.child, tree.sibling, in_parent, run_end, self.panel, place, entry, target[source],
            source, block,
        )  # fmt: skip
        high = block * np.diff(tree.border_start)
        self.leftovers = [int(high[nodes].max(initial=0)) ** 2 for nodes in self.shares]
        self.order = (block * tree.order[:, None] + np.arange(block)).ravel()
        self.widest = block * int((np.diff(tree.first) + np.diff(tree.border_start)).max())

    @property
    def operations(self) -> float:
        """Floating-point operations of one factorisation."""
        wide = self.block * np.diff(self.tree.first).astype(float)
        high = self.block * np.diff(self.tree.border_start).astype(float)
        return float((wide**3 / 3 + wide**2 * high + wide * high**2).sum())


class Multifrontal:
    """Cholesky factor of a symmetric matrix of blocks, whose pattern stays the same while its numbers change.

    Parameters
    ----------
    plan : FrontalPlan
        Of its pattern; several factors may share it.
    """

    def __init__(self, plan: FrontalPlan) -> None:
        self._plan, self._factor = plan, np.empty(plan.panel[-1])
        self._work = *plan.assembly, self._factor, np.empty(plan.stack), *_ADDRESSES
        self._libraries = _libraries()

    def update(self, data: Floats, shift: float) -> bool:
        """Factorise with `shift` added to the diagonal; False where the matrix is not positive definite."""
        *subtrees, top = zip(self._plan.shares, self._plan.leftovers, strict=True)

        def done(share: tuple[Ints, int]) -> bool:
            nodes, most = share
            return _factorise(nodes, *self._work, data, shift, np.empty(most), np.empty(8, np.int32))

        with self._libraries.limit(limits=1):  # fronts are small: threads of a library would cost more than they save
            fine = all(in_parallel(subtrees, done))
        with self._libraries.limit(limits=1 if self._plan.widest < MIN_THREADED_FRONT else None):
            return fine and done(top)

    def solve(self, right: Floats) -> Floats:
        """Solution of the factorised system."""
        plan, tree = self._plan, self._plan.tree
        *subtrees, top = plan.shares
        x, out, longest = right[plan.order], np.empty(len(right)), plan.widest
        table = tree.first, tree.border_start, tree.border, plan.panel, plan.block, self._factor
        groups = [subtrees[k::THREADS] for k in range(THREADS)]

        def forward(group: list[Ints]) -> Floats:
            above = np.zeros(len(x))  # what nodes of other shares are told; each thread has its own
            for nodes in group:
                _forward(nodes, *table, x, above, np.empty(longest))
            return above

        def backward(group: list[Ints]) -> None:
            for nodes in group:
                _backward(nodes, *table, x, np.empty(longest))

        for above in in_parallel(groups, forward):
            x += above
        _forward(top, *table, x, x, np.empty(longest))
        _backward(top, *table, x, np.empty(longest))
        in_parallel(groups, backward)
        out[plan.order] = x
        return out


@cache
def _libraries() -> ThreadpoolController:
    """The linear-algebra libraries that are loaded."""
    return ThreadpoolController()


def _neighbours(i: Ints, j: Ints, count: int) -> tuple[Ints, Ints]:
    """Neighbours of each of `count` vertices, from entries (i, j) of a matrix of blocks."""
    key = np.unique(np.where(i < j, i * count + j, -1))
    key = key[key >= 0]
    one, other = np.concatenate([key // count, key % count]), np.concatenate([key % count, key // count])
    order = np.argsort(one, kind="stable")
    return np.concatenate([[0], np.cumsum(np.bincount(one, minlength=count))]), other[order]


def _shares(tree: EliminationTree) -> tuple[list[Ints], Ints]:
    """Nodes of the independent subtrees, the largest first, then those above them; and the share (T,) that each node is in."""
    nodes = len(tree.parent)
    roots = np.flatnonzero(tree.depth == SUBTREE_DEPTH)
    begin = _first_below(tree.parent)
    shares = sorted((np.arange(begin[r], r + 1) for r in roots), key=len, reverse=True)
    region = np.full(nodes, len(shares))
    for k, some in enumerate(shares):
        region[some] = k
    return [*shares, np.flatnonzero(region == len(shares))], region


@njit(**OPTIONS)
def _first_below(parent):
    """First node of the subtree below each node."""
    first = np.arange(len(parent))
    for t in range(len(parent)):
        if parent[t] >= 0:
            first[parent[t]] = min(first[parent[t]], first[t])
    return first


@njit(**OPTIONS)
def _targets(first, border_start, border, place, node_of, row, column, block):
    """Where the panel of each node begins, and in which node, and where in its panel, each entry of the matrix is gathered."""
    nodes = len(first) - 1
    panel = np.zeros(nodes + 1, np.int64)
    for t in range(nodes):
        width, high = first[t + 1] - first[t], border_start[t + 1] - border_start[t]
        panel[t + 1] = panel[t] + block * block * width * (width + high)
    target, owner = np.empty(len(row), np.int32), np.empty(len(row), np.int32)
    for k in range(len(row)):
        i = block * place[row[k] // block] + row[k] % block
        j = block * place[column[k] // block] + column[k] % block
        if i < j:
            i, j = j, i
        t = node_of[j // block]
        width, high = first[t + 1] - first[t], border_start[t + 1] - border_start[t]
        if i < block * first[t + 1]:
            down = i - block * first[t]
        else:
            some = border[border_start[t] : border_start[t + 1]]
            down = block * (width + np.searchsorted(some, i // block)) + i % block
        target[k] = (j - block * first[t]) * block * (width + high) + down
        owner[k] = t
    return panel, target, owner


@njit(**OPTIONS)
def _places_in_parent(first, border_start, border, parent):
    """Place of every border vertex in the front of its node's parent, and where the run of places that follow each other ends."""
    places, run_end = np.empty(len(border), np.int64), np.empty(len(border), np.int64)
    for t in range(len(parent)):
        p = parent[t]
        if p < 0:
            continue
        q = border_start[p]
        for k in range(border_start[t], border_start[t + 1]):
            v = border[k]
            if v < first[p + 1]:
                places[k] = v - first[p]
            else:
                while border[q] < v:
                    q += 1
                places[k] = first[p + 1] - first[p] + q - border_start[p]
        end = border_start[t + 1]
        for k in range(end - 1, border_start[t] - 1, -1):
            if k + 1 < end and places[k + 1] != places[k] + 1:
                end = k + 1
            run_end[k] = end - border_start[t]
    return places, run_end


@njit(**OPTIONS)
def _stack_places(border_start, child, sibling, region, regions, block):
    """Where each node's left-over, a lower triangle, lies on the stack of its share, over its children's; and the size of all stacks."""
    nodes = len(region)
    place = np.empty(nodes, np.int64)
    height, most = np.zeros(regions, np.int64), np.zeros(regions, np.int64)
    for t in range(nodes):
        r = region[t]
        place[t] = height[r]
        c = child[t]
        while c >= 0:
            if region[c] == r:
                place[t] = min(place[t], place[c])
            c = sibling[c]
        high = block * (border_start[t + 1] - border_start[t])
        height[r] = place[t] + high * (high + 1) // 2
        most[r] = max(most[r], height[r])
    base = 0
    for r in range(regions):
        for t in range(nodes):
            if region[t] == r:
                place[t] += base
        base += most[r]
    return place, base


def _called(count: int) -> Any:
    """Intrinsic that calls the routine at an address with so many pointers; an address that is an argument lets the caller be cached."""

    @intrinsic
    def call(_, address, pointers):  # noqa: ARG001 (typed by name)
        def code(context, builder, signature, arguments):  # noqa: ARG001
            kind = ir.FunctionType(ir.VoidType(), [ir.IntType(64)] * count)
            routine = builder.inttoptr(arguments[0], kind.as_pointer())
            builder.call(routine, [builder.extract_value(arguments[1], k) for k in range(count)])
            return context.get_dummy_value()

        return types.void(types.int64, types.UniTuple(types.int64, count)), code

    return call


_call5, _call10, _call11 = _called(5), _called(10), _called(11)
with without_packages(BLAS, LAPACK):
    _ADDRESSES = (
        get_cython_function_address(LAPACK, "dpotrf"),
        get_cython_function_address(BLAS, "dtrsm"),
        get_cython_function_address(BLAS, "dsyrk"),
    )


@njit(**OPTIONS)
def _factorise(
    nodes, first, border_start, child, sibling, in_parent, run_end, panel, place, entry, target, source, block, factor, stack, dpotrf,
    dtrsm, dsyrk, data, shift, room, number,
):  # fmt: skip
    """Factorise some nodes, in order, with `room` for the largest left-over of one; False where a pivot is not positive."""
    real = np.array([1.0, -1.0, 0.0])
    letter = np.array([76, 78, 82, 84], np.int8)  # L N R T
    L, N, R, T = letter.ctypes.data, letter.ctypes.data + 1, letter.ctypes.data + 2, letter.ctypes.data + 3
    one, minus, at = real.ctypes.data, real.ctypes.data + 8, number.ctypes.data
    for t in nodes:
        width, high = block * (first[t + 1] - first[t]), block * (border_start[t + 1] - border_start[t])
        tall = width + high
        A = factor[panel[t] : panel[t + 1]]
        A[:] = 0.0
        for k in range(entry[t], entry[t + 1]):
            A[target[k]] += data[source[k]]
        for c in range(width):
            A[c * tall + c] += shift
        C = room[: high * high]
        c = child[t]
        kept = one if c >= 0 else real.ctypes.data + 16  # without children nothing stands there yet
        if c >= 0:
            C[:] = 0.0
        while c >= 0:
            some = slice(border_start[c], border_start[c + 1])
            _gather(A, C, stack, place[c], in_parent[some], run_end[some], block, width, high, tall)
            c = sibling[c]
        if width > 0:
            number[0], number[1], number[2], number[3] = width, high, tall, max(high, 1)
            a = A.ctypes.data
            _call5(dpotrf, (L, at, a, at + 8, at + 16))
            if number[4] != 0:
                return False
            if high > 0:
                _call11(dtrsm, (R, L, T, N, at + 4, at, one, a, at + 8, a + 8 * width, at + 8))
                _call10(dsyrk, (L, N, at + 4, at, minus, a + 8 * width, at + 8, kept, C.ctypes.data, at + 12))
        at_stack = place[t]
        for c in range(high):  # its lower triangle, column by column
            for k in range(c * high + c, (c + 1) * high):
                stack[at_stack] = C[k]
                at_stack += 1
    return True


@njit(**NO_ALLOCATION)
def _gather(A, C, stack, begin, places, run_end, block, width, high, tall):
    """Add what a child leaves over to the front of its parent, lower triangles only, one run of places after the other."""
    count, more = len(places), stack.ctypes.data + BYTES * begin
    pivots, rest = A.ctypes.data, C.ctypes.data
    for J in range(count):
        for j in range(block):
            right = block * places[J] + j
            top = pivots + BYTES * right * tall if right < width else rest + BYTES * ((right - width) * high - width)
            k, skipped = J, j
            while k < count:
                end = run_end[k]
                into = top + BYTES * (block * places[k] + skipped)
                last = more + BYTES * (block * (end - k) - skipped)
                while last - more >= 4 * BYTES:
                    add_four(into, more)
                    into, more = into + 4 * BYTES, more + 4 * BYTES
                while more < last:
                    add_one(into, more)
                    into, more = into + BYTES, more + BYTES
                k, skipped = end, 0


@njit(fastmath=True, **NO_ALLOCATION)
def _forward(nodes, first, border_start, border, panel, block, factor, x, above, room):
    """Solve with the factor in place for some nodes in order; what is left for nodes beyond the last of them goes to `above`."""
    if len(nodes) == 0:
        return
    end = block * first[nodes[-1] + 1]
    for t in nodes:
        width, high = block * (first[t + 1] - first[t]), block * (border_start[t + 1] - border_start[t])
        tall, at = width + high, block * first[t]
        below = room[:high]
        below[:] = 0.0
        for c in range(width):
            column = factor[panel[t] + c * tall : panel[t] + (c + 1) * tall]
            v = x[at + c] / column[c]
            x[at + c] = v
            for r in range(c + 1, width):
                x[at + r] -= column[r] * v
            for r in range(high):
                below[r] += column[width + r] * v
        for k in range(high // block):
            q = block * border[border_start[t] + k]
            target = x if q < end else above
            for i in range(block):
                target[q + i] -= below[block * k + i]


@njit(fastmath=True, **NO_ALLOCATION)
def _backward(nodes, first, border_start, border, panel, block, factor, x, room):
    """Solve with the transposed factor in place for some nodes, the last one first."""
    for n in range(len(nodes) - 1, -1, -1):
        t = nodes[n]
        width, high = block * (first[t + 1] - first[t]), block * (border_start[t + 1] - border_start[t])
        tall, at = width + high, block * first[t]
        below = room[:high]
        for k in range(high // block):
            q = block * border[border_start[t] + k]
            for i in range(block):
                below[block * k + i] = x[q + i]
        front = factor[panel[t] : panel[t + 1]]
        for c in range(width):  # what needs no other variable of the node: memory is read in order
            column, total = front[c * tall + width : (c + 1) * tall], 0.0
            for r in range(high):
                total += column[r] * below[r]
            x[at + c] -= total
        for c in range(width - 1, -1, -1):
            column, total = front[c * tall : c * tall + width], 0.0
            for r in range(c + 1, width):
                total += column[r] * x[at + r]
            x[at + c] = (x[at + c] - total) / column[c]
