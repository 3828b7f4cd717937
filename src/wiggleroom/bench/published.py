"""Figures as their authors published them: from Mind the Gap (2026), measured on their machine.

Row 2 of its Table 1 adds up to 99.93 %, and the diagonals of rows 2 and 3 to 97.26 and 99.03 %, not 97.32 and 99.02 %. In Table 2
preparing and solving the revolute joints add up to 91.86 s, not 91.82 s.
"""

from __future__ import annotations

from wiggleroom.bench.result import Record

PAPER = "Mind the Gap †"
PUZZLEFLEX = "PuzzleFlex †"

_TABLE_1 = (
    # right, not free and said so, unsafe, lost, free and said so; PuzzleFlex right
    (94.66, 55.89, 0.44, 4.90, 38.77, 69.11),
    (97.32, 42.03, 0.38, 2.29, 55.23, 61.25),
    (99.02, 31.89, 0.48, 0.49, 67.14, 49.56),
    (84.24, 46.94, 1.35, 14.41, 37.30, 75.61),
)
CONFUSION_CELLS = ("invalid_invalid_percent", "invalid_valid_percent", "valid_invalid_percent", "valid_valid_percent")

_TABLE_2 = (
    # parts, joint, preprocess, solve, total, PuzzleFlex total [s]
    (30, "tee", 1.20, 0.01, 1.21, 0.38),
    (182, "tee", 1.20, 0.04, 1.24, 1.65),
    (675, "tee", 1.20, 0.16, 1.36, 6.03),
    (1890, "tee", 1.20, 20.1, 21.3, 381.0),
    (4096, "tee", 1.20, 127.0, 128.2, 1130.0),
    (4096, "dovetail", 0.64, 44.3, 44.94, 462.2),
    (4096, "swallowtail", 1.40, 64.7, 66.1, 1342.1),
    (4096, "revolute", 0.66, 91.2, 91.82, 2356.4),
)
IMAGES = {1669: 17.76, 532: 6.27}
"""Fig. 8b: seconds by the number of tee blocks."""


def _accuracy() -> tuple[Record, ...]:
    rows: list[Record] = []
    for k, (right, *cells, theirs) in enumerate(_TABLE_1, 1):
        lost = 100 * cells[2] / (cells[2] + cells[3])
        pair = f"Table 1, row {k}"
        rows.append(
            {"pair": pair, "method": PAPER, "published": True, "accuracy_percent": right}
            | dict(zip(CONFUSION_CELLS, cells, strict=True))
            | {"lost_of_free_percent": lost}
        )
        rows.append({"pair": pair, "method": PUZZLEFLEX, "published": True, "accuracy_percent": theirs})
    return tuple(rows)


ACCURACY: tuple[Record, ...] = _accuracy()
"""Table 1."""


def published_speed(parts: int, joint: str) -> list[Record]:
    """Rows of Table 2, and of Fig. 8b, for an assembly; none where it has none."""
    base = {"parts": parts, "joint": joint, "published": True}
    found: list[Record] = []
    for n, name, preprocess, solve, total, theirs in _TABLE_2:
        if (n, name) == (parts, joint):
            times = {"preprocess_seconds": preprocess, "solve_seconds": solve, "total_seconds": total}
            found += [{**base, "method": PAPER, **times}, {**base, "method": PUZZLEFLEX, "total_seconds": theirs}]
    if joint == "image" and parts in IMAGES:
        found.append({**base, "method": PAPER, "total_seconds": IMAGES[parts]})
    return found


INTERLOCK: tuple[Record, ...] = (
    {"property": "handles convex and concave shapes", "blocking graphs": True, "infinitesimal": True, "ours": True},
    {"property": "direction independent complexity", "blocking graphs": False, "infinitesimal": True, "ours": True},
    {"property": "supports simultaneous separation", "blocking graphs": False, "infinitesimal": True, "ours": True},
    {"property": "supports tolerance", "blocking graphs": False, "infinitesimal": False, "ours": True},
)
"""Table 3: what each kind of method can do; "ours" stands for PuzzleFlex and Mind the Gap. All in 2D, the first two in 3D as well."""
