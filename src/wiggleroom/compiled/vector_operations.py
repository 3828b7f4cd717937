"""Operations on several numbers at a time where the compiler does not come upon them by itself."""

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic

BYTES = 8
"""Of a number."""


@intrinsic
def larger(_: Any, one: Any, other: Any) -> Any:  # noqa: ARG001 (typed by name)
    """The larger of two numbers, neither of which is nan; with Python's `max` the largest of a vector is found one by one."""

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:  # noqa: ARG001
        real = ir.DoubleType()
        maximum = builder.module.declare_intrinsic("llvm.maxnum", [real], ir.FunctionType(real, [real, real]))
        return builder.call(maximum, arguments, fastmath=("nnan", "nsz"))

    return types.float64(types.float64, types.float64), code


def _adder(count: int) -> Any:
    """Intrinsic that adds so many numbers that stand at one address to those at another; loops over a few are else one by one."""

    @intrinsic
    def add(_: Any, into: Any, more: Any) -> Any:  # noqa: ARG001 (typed by name)
        def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:  # noqa: ARG001
            kind = ir.VectorType(ir.DoubleType(), count).as_pointer()
            place, other = (builder.inttoptr(one, kind) for one in arguments)
            total = builder.fadd(builder.load(place, align=BYTES), builder.load(other, align=BYTES))
            builder.store(total, place, align=BYTES)
            return context.get_dummy_value()

        return types.void(types.int64, types.int64), code

    return add


add_one, add_four = _adder(1), _adder(4)
