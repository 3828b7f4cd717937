"""How far loose interlocking flat parts can move, whether they come apart, and whose gap is to blame.

>>> import wiggleroom as wr
>>> assembly = wr.patterns.chain(3, joint="tee", gap=0.02)
>>> answer = wr.flex(assembly, wr.Pull("b3", (0, 1)))
>>> str(answer.verdict)
'optimal'
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wiggleroom.analysis.answer import Answer, Contact
    from wiggleroom.analysis.flex import flex
    from wiggleroom.analysis.prepare import Prepared, prepare
    from wiggleroom.analysis.tight import TightVerdict, tight_verdict
    from wiggleroom.assembly import patterns
    from wiggleroom.assembly.build import assemble, read
    from wiggleroom.assembly.model import Assembly
    from wiggleroom.drawing.model import Drawing, JointGap, Part, Pull, Region, Turn, W
    from wiggleroom.errors import InputError, MissingExtraError, TouchingError, WiggleroomError
    from wiggleroom.freespace.space import FreeSpace, free_space
    from wiggleroom.solve.verdict import Verdict

_HOME = {
    "Answer": "analysis.answer",
    "Assembly": "assembly.model",
    "Contact": "analysis.answer",
    "Drawing": "drawing.model",
    "FreeSpace": "freespace.space",
    "InputError": "errors",
    "JointGap": "drawing.model",
    "MissingExtraError": "errors",
    "Part": "drawing.model",
    "Prepared": "analysis.prepare",
    "Pull": "drawing.model",
    "Region": "drawing.model",
    "TightVerdict": "analysis.tight",
    "TouchingError": "errors",
    "Turn": "drawing.model",
    "Verdict": "solve.verdict",
    "W": "drawing.model",
    "WiggleroomError": "errors",
    "assemble": "assembly.build",
    "flex": "analysis.flex",
    "free_space": "freespace.space",
    "patterns": "assembly",
    "prepare": "analysis.prepare",
    "read": "assembly.build",
    "tight_verdict": "analysis.tight",
}

__all__ = [
    "Answer",
    "Assembly",
    "Contact",
    "Drawing",
    "FreeSpace",
    "InputError",
    "JointGap",
    "MissingExtraError",
    "Part",
    "Prepared",
    "Pull",
    "Region",
    "TightVerdict",
    "TouchingError",
    "Turn",
    "Verdict",
    "W",
    "WiggleroomError",
    "assemble",
    "flex",
    "free_space",
    "patterns",
    "prepare",
    "read",
    "tight_verdict",
]


def __getattr__(name: str) -> object:
    """Import a public name when it is first used, so that `import wiggleroom` stays quick."""
    if name not in _HOME:
        message = f"module 'wiggleroom' has no attribute {name!r}"
        raise AttributeError(message)
    module = import_module(f"wiggleroom.{_HOME[name]}")
    value = import_module("wiggleroom.assembly.patterns") if name == "patterns" else getattr(module, name)
    globals()[name] = value
    return value
