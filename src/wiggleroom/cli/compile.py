"""Compile the numerical kernels now, so that the first question does not wait: `python -m wiggleroom.cli.compile`."""

from __future__ import annotations


def main() -> None:
    """Answer a tiny question by every model and one about many bodies; what these compile is kept beside the package."""
    from wiggleroom.assembly import patterns
    from wiggleroom.disassembly.interlock import check
    from wiggleroom.maximise import flex

    for model in ("walls", "hull", "halfplane"):
        flex(patterns.chain(2), model=model)
    flex(patterns.grid(19, 19), search=0)
    check(patterns.chain(2, joint="swallowtail", gap=0.08))


if __name__ == "__main__":
    main()
