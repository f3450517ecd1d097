"""The C interface: python/host/interface.h, read by cffi, for the library in this file's folder."""

import errno
import os
import pathlib
import tempfile

import cffi
import numpy as np

_HERE = pathlib.Path(__file__).parent
_NO_FILE = os.strerror(errno.ENOENT)  # how the C library ends its message

ffi = cffi.FFI()
ffi.cdef("".join(line for line in (_HERE / "interface.h").open(encoding="utf-8") if not line.startswith("#")))
lib = ffi.dlopen(str(_HERE / "libiqfoc_host.so"))


class Error(Exception):
    """What iqfoc has to complain of, in the one line that the command would print."""


class InputError(Error, ValueError):
    """Input that cannot be used: where, and what was expected."""


class MissingFileError(InputError, FileNotFoundError):
    """A file that is not there."""


class Trouble:
    """The C functions' last argument; `check` raises what it holds."""

    def __init__(self, replace=()):
        self.c = ffi.gc(lib.py_error_new(), lib.py_error_free)
        self._replace = replace

    def check(self, ok):
        """`ok` itself, unless it says that the call failed."""
        if ok is True or (ok is not False and ok != ffi.NULL):
            return ok
        words = text(lib.py_error_text(self.c))
        for old, new in self._replace:
            words = words.replace(old, new)
        if words.endswith(_NO_FILE):
            raise MissingFileError(words)
        raise (InputError if lib.py_error_status(self.c) == 2 else Error)(words)


def text(c_text):
    """A C string as str."""
    return ffi.string(c_text).decode("utf-8", "replace")


def path_bytes(path):
    """A path, or a label, for C."""
    return str(path).encode("utf-8", "surrogateescape")


def written(write, handle):
    """The text that a C function writes into a file."""
    with tempfile.TemporaryDirectory() as folder:
        path, trouble = pathlib.Path(folder, "text"), Trouble()
        trouble.check(write(handle, path_bytes(path), trouble.c))
        return path.read_text(encoding="utf-8")


def strings(words):
    """(array of char *, what must be kept alive with it)."""
    kept = [ffi.new("char[]", path_bytes(w)) for w in words]
    return ffi.new("char *[]", kept), kept


def _pointers(arrays, c_type):
    return ffi.new(f"{c_type} *[]", [ffi.cast(f"{c_type} *", a.ctypes.data) for a in arrays])


def iq24_array(x):
    """Integers in Q7.24 as int32; anything else is a mistake that must not pass for a number."""
    a = np.asarray(x)
    if a.dtype.kind not in "iu":
        raise TypeError(f"expected integers in Q7.24 (int32), not {a.dtype}; iqfoc.from_float makes them")
    if a.dtype != np.int32:
        if a.size and (a.min() < -(2 ** 31) or a.max() > 2 ** 31 - 1):
            raise OverflowError("an integer does not fit Q7.24 (int32)")
        a = a.astype(np.int32)
    return a


def over_arrays(arguments, outs, call):
    """Broadcasts the arguments, has `call(n, in, out)` fill `outs` arrays of that shape, and returns them."""
    whole = np.broadcast_arrays(*[iq24_array(x) for x in arguments])
    shape = whole[0].shape
    ins = [np.ascontiguousarray(a).reshape(-1) for a in whole]
    results = [np.empty(ins[0].size, np.int32) for _ in range(outs)]
    call(ins[0].size, _pointers(ins, "int32_t"), _pointers(results, "int32_t"))
    results = tuple(r.reshape(shape)[()] for r in results)
    return results[0] if outs == 1 else results


def _functions():
    count = ffi.new("size_t *")
    first = lib.py_functions(count)
    return {text(first[k].name): first[k] for k in range(count[0])}


FUNCTIONS = _functions()


def each(name, *arguments):
    """A function of the library's table over arrays."""
    f = FUNCTIONS[name]
    if len(arguments) != f.ins:
        raise TypeError(f"{name} takes {f.ins} arguments, not {len(arguments)}")
    return over_arrays(arguments, f.outs, f.each)


def doubles(columns):
    """(names, values, rows, kept) of a mapping of columns for C; one-dimensional, all of one length."""
    arrays = {str(name): np.ascontiguousarray(x, np.float64) for name, x in columns.items()}
    lengths = {a.shape for a in arrays.values()}
    if any(a.ndim != 1 for a in arrays.values()) or len(lengths) > 1:
        raise InputError("columns: expected one-dimensional ones of one length, got " + ", ".join(f"{n} {a.shape}" for n, a in arrays.items()))
    names, kept = strings(arrays)
    return names, _pointers(arrays.values(), "double"), next(iter(lengths), (0,))[0], (kept, arrays)
