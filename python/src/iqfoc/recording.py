"""Recordings (docs/interfaces.md, "The recording: CSV") as columns of numpy arrays."""

from __future__ import annotations

import os
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ._host import InputError, Trouble, doubles, ffi, lib, path_bytes, text


class Recording(dict):
    """Columns by name, each a float64 array of one number a control cycle; names have the units.

    `Recording("REC.csv")` reads a file (gzip too), `Recording(columns)` takes a mapping of columns or a data frame. What a recording
    needs is checked as the command checks it, and refused by an InputError with the line, or the row, and what was expected. Columns
    that are no recording's are ignored. It is a dict, so that pandas.DataFrame(recording) has its columns, but cannot be changed.

    >>> recording = iqfoc.Recording("data/recordings/dead_time.csv.gz")
    >>> recording.rows, recording["i_a_A"].shape
    (14880, (14880,))
    """

    def __init__(self, source: str | os.PathLike | Mapping, label: str = "recording"):
        trouble = Trouble()
        if isinstance(source, (str, os.PathLike)):
            handle, label = trouble.check(lib.py_recording_read(path_bytes(source), trouble.c)), str(source)
        else:
            names, values, rows, kept = doubles(columns_of(source))
            handle = trouble.check(lib.py_recording_make(path_bytes(label), rows, len(names), names, values, trouble.c))
            del kept
        self._take(handle, label)

    @classmethod
    def _from_handle(cls, handle, label):
        made = cls.__new__(cls)
        made._take(handle, label)
        return made

    def _take(self, handle, label):
        self._c = ffi.gc(handle, lib.py_recording_free)
        self.label = label
        self.rows: int = lib.py_recording_rows(self._c)
        self.T_s: float = lib.py_recording_T_s(self._c)
        self.notes: list[str] = []
        column = 0
        while (name := lib.py_recording_column_name(column)) != ffi.NULL:
            values = np.empty(self.rows)
            if lib.py_recording_column(self._c, column, ffi.cast("double *", values.ctypes.data)):
                values.flags.writeable = False
                super().__setitem__(text(name), values)
            column += 1

    def _unchangeable(self, *_, **__):
        raise TypeError("a recording cannot be changed; to_dict() is a dict of its columns, Recording(columns) makes another")

    __setitem__ = __delitem__ = __ior__ = clear = pop = popitem = setdefault = update = _unchangeable

    @property
    def columns(self) -> dict[str, NDArray[np.float64]]:
        """The columns as a dict."""
        return dict(self)

    def __eq__(self, other):
        return list(self) == list(other) and all(np.array_equal(self[n], other[n], equal_nan=True) for n in self) if isinstance(
            other, Recording) else NotImplemented

    def __ne__(self, other):
        return not self == other

    __hash__ = None

    def to_dict(self) -> dict[str, NDArray[np.float64]]:
        """The columns; pandas.DataFrame and polars.DataFrame take it as it is."""
        return dict(self)

    def write(self, path: str | os.PathLike, comment: str | None = None) -> None:
        """Writes the CSV, with enough digits that reading gives the same numbers."""
        trouble = Trouble()
        trouble.check(lib.py_recording_write(self._c, path_bytes(path), ffi.NULL if comment is None else path_bytes(comment), trouble.c))

    def __reduce__(self):
        return (Recording, (dict(self), self.label))

    def __repr__(self):
        return f"<Recording {self.label!r}: {self.rows} rows of {self.T_s:g} s, columns {', '.join(self)}>"

    def _repr_html_(self):
        from ._html import table
        return table(("column", "least", "mean", "most"), [(n, c.min(), c.mean(), c.max()) for n, c in self.items()])


def columns_of(source):
    """Of a mapping, a data frame (its columns) or a structured array."""
    names = getattr(getattr(source, "dtype", None), "names", None)
    if names:
        return {n: source[n] for n in names}
    if isinstance(source, Mapping):
        return source
    if hasattr(source, "columns"):
        return {str(n): np.asarray(source[n]) for n in source.columns}
    raise InputError(f"expected a file, a mapping of columns or a data frame, not {type(source).__name__}")


def recording_of(x) -> Recording:
    """A Recording, or what one can be made of."""
    return x if isinstance(x, Recording) else Recording(x)
