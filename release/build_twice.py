"""Build the source distribution and the wheel, twice, and compare: `python -m release.build_twice FOLDER`.

The time in the archives is `SOURCE_DATE_EPOCH`, by default that of the last commit. The wheel is built from the source distribution,
without compiled kernels: numba's machine code is not the same twice.
"""

from __future__ import annotations

import gzip
import hashlib
import io
import os
import shutil
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

TOP = Path(__file__).parents[1]
ARGUMENTS = ("--no-isolation", "--skip-dependency-check")


def epoch() -> int:
    """Time of everything in the archives [s since 1970]."""
    said = os.environ.get("SOURCE_DATE_EPOCH")
    if said is None:
        said = subprocess.run(
            ["git", "log", "-1", "--format=%ct"], cwd=TOP, capture_output=True, text=True, check=True
        ).stdout
    return int(said)


def build(folder: Path, when: int) -> list[Path]:
    """Build both in a place of its own; the archives."""
    here = os.environ | {"SOURCE_DATE_EPOCH": str(when), "WIGGLEROOM_KERNELS": "none"}
    here.pop("PYTHONPATH", None)
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as place:
        copy = Path(place) / "source"
        listed = subprocess.run(
            ["git", "ls-files", "--cached", "--others", "--exclude-standard", "-z"],
            cwd=TOP,
            capture_output=True,
            text=True,
            check=True,
        )
        for name in listed.stdout.split("\0"):
            if name and (TOP / name).is_file():
                (copy / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(TOP / name, copy / name)
        run = (sys.executable, "-m", "build", *ARGUMENTS, "--outdir", str(folder))
        subprocess.run([*run, "--sdist", str(copy)], env=here, cwd=place, check=True, stdout=subprocess.DEVNULL)
        (sdist,) = folder.glob("*.tar.gz")
        plain(sdist, when)
        with tarfile.open(sdist) as archive:
            archive.extractall(place, filter="data")
        unpacked = Path(place) / sdist.name.removesuffix(".tar.gz")
        subprocess.run([*run, "--wheel", str(unpacked)], env=here, cwd=place, check=True, stdout=subprocess.DEVNULL)
    return [sdist, *folder.glob("*.whl")]


def plain(sdist: Path, when: int) -> None:
    """Write an archive anew: in order, of nobody, all at one time."""
    with tarfile.open(sdist) as archive:
        files = [(m, None if m.isdir() else archive.extractfile(m).read()) for m in archive]  # type: ignore[union-attr]
    packed = io.BytesIO()
    with tarfile.open(fileobj=packed, mode="w", format=tarfile.PAX_FORMAT) as archive:
        for member, data in sorted(files, key=lambda file: file[0].name):
            made = tarfile.TarInfo(member.name)
            made.type, made.mtime = member.type, when
            made.mode = 0o755 if member.isdir() or member.mode & 0o100 else 0o644
            made.size = 0 if data is None else len(data)
            archive.addfile(made, None if data is None else io.BytesIO(data))
    with sdist.open("wb") as target, gzip.GzipFile(filename="", mode="wb", fileobj=target, mtime=when) as packing:
        packing.write(packed.getvalue())


def digest(path: Path) -> str:
    """SHA-256 of a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def main() -> int:
    """Build twice; the exit code is 1 where they differ."""
    folder, when = Path(sys.argv[1]).resolve(), epoch()
    shutil.rmtree(folder, ignore_errors=True)
    first = build(folder, when)
    with tempfile.TemporaryDirectory() as place:
        second = {path.name: digest(path) for path in build(Path(place), when)}
    wrong = [path.name for path in first if second.get(path.name) != digest(path)]
    for path in first:
        print(f"{digest(path)}  {path.name}")
    for name in wrong:
        print(f"{name}: differs when it is built again", file=sys.stderr)
    return 1 if wrong or len(first) != 2 else 0


if __name__ == "__main__":
    sys.exit(main())
