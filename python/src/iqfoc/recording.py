"""Recordings (docs/interfaces.md, "The recording: CSV") as columns of numpy arrays."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from ._host import InputError, Trouble, doubles, ffi, lib, path_bytes, text


class Recording(Mapping):
    """Columns by name, each a float64 array of one number a control cycle; units stand in the names.

    `Recording("REC.csv")` reads a file (gzip too), `Recording(columns)` takes a mapping of columns or a data frame. What a recording
    needs is checked as the command checks it, and refused by an InputError with the line, or the row, and what was expected. Columns
    that are no recording's are ignored.
    """

    def __init__(self, source: str | os.PathLike | Mapping, label: str = "recording"):
        trouble = Trouble()
        if isinstance(source, (str, os.PathLike)):
            handle, label = trouble.check(lib.py_recording_read(path_bytes(source), trouble.c)), str(source)
        else:
            names, values, rows, kept = doubles(_columns_of(source))
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
        self.columns: dict[str, NDArray[np.float64]] = {}
        column = 0
        while (name := lib.py_recording_column_name(column)) != ffi.NULL:
            values = np.empty(self.rows)
            if lib.py_recording_column(self._c, column, ffi.cast("double *", values.ctypes.data)):
                values.flags.writeable = False
                self.columns[text(name)] = values
            column += 1

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        return self.columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.columns)

    def to_dict(self) -> dict[str, NDArray[np.float64]]:
        """The columns; pandas.DataFrame and polars.DataFrame take it as it is."""
        return dict(self.columns)

    def write(self, path: str | os.PathLike, comment: str | None = None) -> None:
        """Writes the CSV, with enough digits that reading gives the same numbers."""
        trouble = Trouble()
        trouble.check(lib.py_recording_write(self._c, path_bytes(path), ffi.NULL if comment is None else path_bytes(comment), trouble.c))

    def __reduce__(self):
        return (Recording, (self.columns, self.label))

    def __repr__(self):
        return f"<Recording {self.label!r}: {self.rows} rows of {self.T_s:g} s, columns {', '.join(self.columns)}>"

    def _repr_html_(self):
        from ._html import table
        return table(("column", "least", "mean", "most"), [(n, c.min(), c.mean(), c.max()) for n, c in self.columns.items()])


def _columns_of(source):
    """Of a mapping, a data frame (its columns) or a structured array."""
    names = getattr(getattr(source, "dtype", None), "names", None)
    if names:
        return {n: source[n] for n in names}
    if isinstance(source, Mapping):
        return source
    if hasattr(source, "columns"):
        return {str(n): np.asarray(source[n]) for n in source.columns}
    raise InputError(f"a recording is a file, a mapping of columns or a data frame, not {type(source).__name__}")


def recording_of(x) -> Recording:
    """A Recording, or what one can be made of."""
    return x if isinstance(x, Recording) else Recording(x)
