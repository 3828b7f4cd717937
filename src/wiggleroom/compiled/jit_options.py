"""How functions are compiled, and when what was compiled is stale.

What was compiled is kept beside the package. numba looks whether the file of a function has changed; what the function calls in
other files is compiled into it unseen. So here the name of its cache holds a hash of the sources of all modules that its own
module imports, and theirs.

A wheel carries the functions that Python calls as machine code for the least processor of its kind, so that the first answer does
not wait for a compiler. It is taken where nothing better was compiled here, and only if sources, signature, Python, numba and
platform are the same.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable
from functools import cache, cached_property, partial
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm
import numba
from numba.core.caching import CompileResultCacheImpl, FunctionCache, IndexDataCacheFile
from numba.core.environment import Environment, lookup_environment
from numba.core.runtime import rtsys

OPTIONS = {"cache": True, "nogil": True, "error_model": "numpy"}
"""For functions that make arrays."""
NO_ALLOCATION = {**OPTIONS, "no_cfunc_wrapper": True, "_nrt": False}
"""For functions that only fill the arrays they are given: without the counting of references they compile much quicker."""
COMPILED_CALLERS_ONLY = {**NO_ALLOCATION, "no_cpython_wrapper": True}
"""For functions that moreover only compiled code calls."""
INLINED = {**COMPILED_CALLERS_ONLY, "inline": "always"}
"""For long functions with one caller: compiled as part of it, not twice."""

SHIPPED = Path(__file__).with_name("kernels")
"""Where a wheel carries machine code."""
_caches: list[KernelCache] = []
_ROOT = Path(__file__).parents[1]
_IMPORT = re.compile(r"^from wiggleroom\.([\w.]+) import", re.MULTILINE)


class KernelCacheFile(IndexDataCacheFile):
    """Cache of a function; what it does not hold may be in the wheel.

    Parameters are those of numba's class.
    """

    def load(self, key: Any) -> Any:
        """Compiled function of this signature, processor and byte code; None where there is none."""
        found = super().load(key)
        if found is not None or not SHIPPED.is_dir():
            return found
        try:
            return self._load_data(self._shipped(SHIPPED, key))
        except FileNotFoundError:
            return None

    def ship(self, folder: Path) -> int:
        """Copy what is kept into a folder that a wheel carries; how many files.

        The listing of inferred types is left out: nothing reads it, and it names the folder of the build.
        """
        overloads = self._load_index()
        for key, name in overloads.items():
            kept = tuple("" if isinstance(item, str) else item for item in self._load_data(name))
            self._shipped(folder, key).write_bytes(self._dump(kept))
        return len(overloads)

    def _shipped(self, folder: Path, key: Any) -> Path:
        """File of a signature, for any processor of the platform."""
        signature, (platform, *_), code = key
        said = repr((signature, platform, code, numba.__version__))
        return folder / f"{self._index_name.removesuffix('.nbi')}.{hashlib.sha256(said.encode()).hexdigest()[:16]}.nbc"


class KernelForm(CompileResultCacheImpl):
    """What is kept of a compiled function, in a form that is quick to load.

    numba parses the intermediate code, which only a function that is compiled later links with, to learn which symbols the machine
    code defines, and imports the modules of all functions that were compiled into it. Here the names of the symbols are kept too,
    intermediate code is parsed where it is linked with, and environments know their module by name: only interpreted code would
    look into it.
    """

    def reduce(self, compiled: Any) -> tuple:
        """Compiled function as it is kept."""
        module = compiled.library._get_module_for_linking()
        symbols = sorted(
            one.name for kind in (module.functions, module.global_variables) for one in kind if not one.is_declaration
        )
        *kept, environments = super().reduce(compiled)
        return *kept, [(one.globals["__name__"], one.consts, one.env_name) for one in environments], symbols

    def rebuild(self, target_context: Any, kept: tuple) -> Any:
        """Compiled function, from what is kept of it."""
        (name, kind, (machine_code, bitcode)), *rest, environments, symbols = kept
        target_context.codegen()._engine._defined_symbols.update(symbols)
        found = super().rebuild(
            target_context,
            ((name, kind, (machine_code, _no_bitcode())), *rest, tuple(_environment(*one) for one in environments)),
        )
        found.library._get_module_for_linking = cache(partial(llvm.parse_bitcode, bitcode))
        return found


@cache
def _no_bitcode() -> bytes:
    return llvm.parse_assembly("").as_bitcode()


def _environment(module: str, consts: list, name: str) -> Environment:
    """Constants of a function that was compiled into another one."""
    found = lookup_environment(name)
    if found is None:
        found = Environment({"__name__": module})
        found.consts[:] = consts
        found.env_name = name
        Environment._memo[name] = found
    return found


class KernelCache(FunctionCache):
    """What is kept of a function; the tables of the compiler are filled only where something must be compiled.

    It is sought when the function is first called: numba writes a trial file for each one, and most are not called.

    Parameters
    ----------
    function : callable
    """

    _impl_class = KernelForm

    def __init__(self, function: Callable) -> None:
        self._py_func = function
        self._name = repr(function)
        # of the sources as they are when the function is defined: they may have changed when it is called
        self._source_key = source_key(Path(function.__code__.co_filename))[:16]
        self.enable()

    @cached_property
    def _impl(self) -> KernelForm:
        return KernelForm(self._py_func)

    @cached_property
    def _cache_path(self) -> str:
        return self._impl.locator.get_cache_path()

    @cached_property
    def _cache_file(self) -> KernelCacheFile:  # type: ignore[override]
        # numba has no public way to say what a cached function depends on; an index of other sources must not even be opened, because
        # it names types that may be gone
        name = f"{self._impl.filename_base}.{self._source_key}"
        return KernelCacheFile(self._cache_path, name, self._impl.locator.get_source_stamp())

    def ship(self, folder: Path) -> int:
        """Copy what is kept into a folder that a wheel carries; how many files."""
        return self._cache_file.ship(folder)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Compiled function of a signature; None where there is none."""
        rtsys.initialize(target_context)
        with self._guard_against_spurious_io_errors():
            found = self._load_overload(sig, target_context)
        if found is None:
            target_context.refresh()
        return found


def ship(folder: Path) -> int:
    """Copy all functions that Python calls and that were compiled into a folder that a wheel carries; how many files."""
    folder.mkdir(parents=True, exist_ok=True)
    return sum(one.ship(folder) for one in _caches)


def njit(**options: Any) -> Callable[[Callable], Any]:
    """Compile a function as `numba.njit` does, and anew whenever a source below it has changed."""

    def compiled(function: Callable) -> Any:
        made = numba.njit(**{**options, "cache": False})(function)
        if options.get("cache"):
            made._cache = KernelCache(function)
            if "no_cpython_wrapper" not in options:  # callable from Python
                _caches.append(made._cache)
        return made

    return compiled


@cache
def source_key(path: Path) -> str:
    """Hash of a module's source and of the sources of all modules of the package that it imports, directly or not."""
    digest = hashlib.sha256()
    for file in sorted(_below(path)):
        digest.update(_source(file))
    return digest.hexdigest()


def _below(path: Path) -> set[Path]:
    found: set[Path] = set()
    waiting = [path]
    while waiting:
        file = waiting.pop()
        if file in found:
            continue
        found.add(file)
        waiting += _imported(file)
    return found


@cache
def _imported(file: Path) -> tuple[Path, ...]:
    """Files of the package that one imports from."""
    names = _IMPORT.findall(_source(file).decode())
    files = ((_ROOT / name.replace(".", "/")).with_suffix(".py") for name in names)
    return tuple(f for f in files if f.exists())


@cache
def _source(path: Path) -> bytes:
    return path.read_bytes()
