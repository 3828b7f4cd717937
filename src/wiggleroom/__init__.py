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
    from wiggleroom.analysis.allowable_gap import AllowableGap, allowable_gap
    from wiggleroom.analysis.answer import Answer, Bound, Contact
    from wiggleroom.analysis.blocking import Blocking, blocking
    from wiggleroom.analysis.flex import flex
    from wiggleroom.analysis.interlock import Escape, Interlock, check
    from wiggleroom.analysis.largest_gap import LargestGap, largest_gap
    from wiggleroom.analysis.live import Live
    from wiggleroom.analysis.lots import Spread
    from wiggleroom.analysis.prepare import Prepared, prepare
    from wiggleroom.analysis.prove import prove
    from wiggleroom.analysis.rank import Ranking, rank
    from wiggleroom.analysis.sample import Sample, sample
    from wiggleroom.analysis.shot import Mode, Shot
    from wiggleroom.analysis.sweep import Sweep, sweep
    from wiggleroom.analysis.tight import TightVerdict, tight_verdict
    from wiggleroom.analysis.tighten import Tightening, tighten
    from wiggleroom.assembly import coupon, patterns
    from wiggleroom.assembly.build import assemble, read
    from wiggleroom.assembly.model import Assembly
    from wiggleroom.drawing.model import Closer, Drawing, JointGap, Part, Pull, Region, Towards, Translation, Turn, W
    from wiggleroom.errors import InputError, MissingExtraError, StoppedError, TouchingError, WiggleroomError
    from wiggleroom.freespace.models import HalfPlane, Hull
    from wiggleroom.freespace.polyhedron import Polyhedron
    from wiggleroom.freespace.space import FreeSpace, free_space
    from wiggleroom.report.film import film
    from wiggleroom.solve.verdict import Verdict

_HOME = {
    "AllowableGap": "analysis.allowable_gap",
    "Answer": "analysis.answer",
    "Assembly": "assembly.model",
    "Blocking": "analysis.blocking",
    "Bound": "analysis.answer",
    "Closer": "drawing.model",
    "Contact": "analysis.answer",
    "Drawing": "drawing.model",
    "Escape": "analysis.interlock",
    "FreeSpace": "freespace.space",
    "HalfPlane": "freespace.models",
    "Hull": "freespace.models",
    "InputError": "errors",
    "Interlock": "analysis.interlock",
    "JointGap": "drawing.model",
    "LargestGap": "analysis.largest_gap",
    "Live": "analysis.live",
    "MissingExtraError": "errors",
    "Mode": "analysis.shot",
    "Part": "drawing.model",
    "Polyhedron": "freespace.polyhedron",
    "Prepared": "analysis.prepare",
    "Pull": "drawing.model",
    "Ranking": "analysis.rank",
    "Region": "drawing.model",
    "Sample": "analysis.sample",
    "Shot": "analysis.shot",
    "Spread": "analysis.lots",
    "StoppedError": "errors",
    "Sweep": "analysis.sweep",
    "Tightening": "analysis.tighten",
    "TightVerdict": "analysis.tight",
    "TouchingError": "errors",
    "Towards": "drawing.model",
    "Translation": "drawing.model",
    "Turn": "drawing.model",
    "Verdict": "solve.verdict",
    "W": "drawing.model",
    "WiggleroomError": "errors",
    "allowable_gap": "analysis.allowable_gap",
    "assemble": "assembly.build",
    "blocking": "analysis.blocking",
    "check": "analysis.interlock",
    "coupon": "assembly",
    "film": "report.film",
    "flex": "analysis.flex",
    "free_space": "freespace.space",
    "largest_gap": "analysis.largest_gap",
    "patterns": "assembly",
    "prepare": "analysis.prepare",
    "prove": "analysis.prove",
    "rank": "analysis.rank",
    "read": "assembly.build",
    "sample": "analysis.sample",
    "sweep": "analysis.sweep",
    "tighten": "analysis.tighten",
    "tight_verdict": "analysis.tight",
}

__all__ = [
    "AllowableGap",
    "Answer",
    "Assembly",
    "Blocking",
    "Bound",
    "Closer",
    "Contact",
    "Drawing",
    "Escape",
    "FreeSpace",
    "HalfPlane",
    "Hull",
    "InputError",
    "Interlock",
    "JointGap",
    "LargestGap",
    "Live",
    "MissingExtraError",
    "Mode",
    "Part",
    "Polyhedron",
    "Prepared",
    "Pull",
    "Ranking",
    "Region",
    "Sample",
    "Shot",
    "Spread",
    "StoppedError",
    "Sweep",
    "TightVerdict",
    "Tightening",
    "TouchingError",
    "Towards",
    "Translation",
    "Turn",
    "Verdict",
    "W",
    "WiggleroomError",
    "allowable_gap",
    "assemble",
    "blocking",
    "check",
    "coupon",
    "film",
    "flex",
    "free_space",
    "largest_gap",
    "patterns",
    "prepare",
    "prove",
    "rank",
    "read",
    "sample",
    "sweep",
    "tight_verdict",
    "tighten",
]


def __getattr__(name: str) -> object:
    """Import a public name when it is first used, so that `import wiggleroom` stays quick."""
    if name not in _HOME:
        message = f"module 'wiggleroom' has no attribute {name!r}"
        raise AttributeError(message)
    module = import_module(f"wiggleroom.{_HOME[name]}")
    is_module = name in ("coupon", "patterns")
    value = import_module(f"wiggleroom.assembly.{name}") if is_module else getattr(module, name)
    globals()[name] = value
    return value
