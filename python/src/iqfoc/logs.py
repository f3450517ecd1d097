"""Logs of other programs: read by the libraries that know their formats, and made a recording by the map of `iqfoc import`."""

from __future__ import annotations

import importlib
import json
import math
import os
import pathlib
import tomllib
from collections.abc import Callable, Mapping

import numpy as np

from ._host import InputError, MissingFileError, Trouble, doubles, ffi, lib, path_bytes
from .motor import Motor, motor_of, text_file, toml_value
from .recording import Recording, columns_of


def read_log(log: str | os.PathLike | Mapping, map: str | os.PathLike | Mapping | None = None, preset: str | None = None,
             motor: Motor | str | os.PathLike | None = None) -> Recording:
    """A recording of another program's log.

    log: a file, by its ending: .xlsx (openpyxl), .mat (scipy), .mcap (mcap), .parquet or .feather (pyarrow), .h5 or .hdf5 (h5py), .mf4, .mdf
    or .dat (asammdf), anything else a text table or packed binary rows, as `iqfoc import` reads them; or a mapping of columns, or a data frame. map: the map's file (docs/own-log.md) or a mapping of its tables;
    or preset: the name of one. motor: the motor file, where something is mechanical. Raises InputError with what was expected.

    >>> run = iqfoc.Drive("data/motors/jarzebowicz2019.toml").run({"run": [{"cycles": 50, "speed_rpm": 500.0}]})
    >>> log = {"time": run["t_s"], "angle": run["theta_e_rad"], "Ia": 1e3 * run["i_a_A"], "Ib": 1e3 * run["i_b_A"],
    ...        "Ua": run["u_a_V"], "Ub": run["u_b_V"], "Uc": run["u_c_V"]}
    >>> columns = {"t_s": "time", "theta_e_rad": "angle", "i_a_A": {"from": "Ia", "scale": 1e-3}, "i_b_A": {"from": "Ib", "scale": 1e-3},
    ...            "u_a_V": "Ua", "u_b_V": "Ub", "u_c_V": "Uc"}
    >>> iqfoc.read_log(log, map={"columns": columns}).rows
    50
    """
    if (map is None) == (preset is None):
        raise TypeError("read_log: expected a map or a preset")
    motor = None if motor is None else motor_of(motor)
    if not isinstance(log, (str, os.PathLike)):
        label, columns = "log", columns_of(log)
    else:
        label = str(log)
        read = None if _is_packed(map) else READERS.get(pathlib.Path(log).suffix.lower())
        columns = None if read is None else _read(read, label)
    if isinstance(map, Mapping):
        with text_file("".join(f"{k} = {toml_value(v)}\n" for k, v in map.items())) as path:
            return _import(label, columns, path, None, motor, [(path, "map")])
    return _import(label, columns, map, preset, motor, [])


def _is_packed(map):
    """The map describes packed binary rows, whatever the log's name ends with."""
    try:
        tables = map if isinstance(map, Mapping) else {} if map is None else tomllib.loads(pathlib.Path(map).read_text(encoding="utf-8"))
        return tables.get("format", {}).get("type") == "binary"
    except (OSError, ValueError, AttributeError):  # the reader of the map says what is wrong
        return False


def _import(label, columns, map, preset, motor, replace):
    trouble = Trouble(replace)
    names, values, rows, kept = ffi.NULL, ffi.NULL, 0, None
    if columns is not None:
        numbers = {n: c for n, c in columns.items() if np.asarray(c).dtype.kind in "biuf" and np.ndim(c) == 1}
        if not numbers:
            raise InputError(f"{label}: no column of numbers")
        names, values, rows, kept = doubles(numbers)
    handle = trouble.check(lib.py_recording_import(
        path_bytes(label), ffi.NULL if map is None else path_bytes(map), ffi.NULL if preset is None else path_bytes(preset),
        ffi.NULL if motor is None else motor._c, rows, 0 if columns is None else len(names), names, values, trouble.c))
    del kept
    return Recording._from_handle(handle, label)


def _read(read, path):
    if not os.path.exists(path):
        raise MissingFileError(f"{path}: there is no such file")
    try:
        return read(path)
    except (InputError, ImportError):
        raise
    except Exception as why:  # each library has its own
        raise InputError(f"{path}: {type(why).__name__}: {str(why).splitlines()[0] if str(why) else 'cannot be read'}") from why


def _library(name, extra):
    try:
        return importlib.import_module(name)
    except ImportError as none:
        raise ImportError(f"this format needs {name}: pip install iqfoc[{extra}]") from none


def _mat(path):
    """Vectors of numbers; those of a struct as "struct.field". Files of MATLAB 7.3 are HDF5."""
    io = _library("scipy.io", "mat")
    try:
        found = io.loadmat(path, squeeze_me=True, struct_as_record=True)
    except NotImplementedError:
        return _hdf5(path)
    columns = {}
    for name, x in found.items():
        if name.startswith("__"):
            continue
        x = np.asarray(x)
        if x.dtype.names:
            columns |= {f"{name}.{field}": np.asarray(x[field].item()) for field in x.dtype.names}
        else:
            columns[name] = x
    return columns


def _table(t):
    return {n: t.column(n).to_numpy() for n in t.column_names}


def _parquet(path):
    return _table(_library("pyarrow.parquet", "parquet").read_table(path))


def _feather(path):
    return _table(_library("pyarrow.feather", "parquet").read_table(path))


def _hdf5(path):
    """Data sets of one dimension (or one row or column) by their path in the file, "group/name"."""
    h5py = _library("h5py", "hdf5")
    columns = {}

    def take(name, item):
        if isinstance(item, h5py.Dataset):
            if item.dtype.names and item.ndim == 1:
                columns.update({f"{name}/{field}" if len(item.dtype.names) > 1 else name: item[field] for field in item.dtype.names})
            elif item.size == max(item.shape, default=0):
                columns[name] = item[()].reshape(-1)

    with h5py.File(path, "r") as file:
        file.visititems(take)
    return columns


def _mdf(path):
    """The channels of the largest group with its "t_s", and those of other groups at its times, each with its last value."""
    asammdf = _library("asammdf", "mdf")
    with asammdf.MDF(path) as file:
        groups = []
        for n, group in enumerate(file.groups):
            signals = file.select([(None, n, k) for k in range(len(group.channels))], raw=False)
            found = [s for s in signals if s.samples.dtype.kind in "biuf" and s.samples.ndim == 1 and len(s.samples)]
            if found:
                groups.append((found[0].timestamps, {s.name: s.samples for s in found}))
    return _at_the_times_of_the_largest(groups)


def _at_the_times_of_the_largest(groups):
    """Columns of groups (times, {name: values}) with different times."""
    if not groups:
        return {}
    lead = max(groups, key=lambda g: (len(g[0]), len(g[1])))
    t_s = lead[0]
    columns = {"t_s": t_s, **{n: c for n, c in lead[1].items() if n != "t_s"}}
    for times, group in groups:
        if times is not lead[0]:
            at = np.clip(np.searchsorted(times, t_s, side="right") - 1, 0, None)
            for name, values in group.items():
                columns.setdefault(name, values[at])
    return columns


def _mcap(path):
    """Numbers in JSON messages as "topic.field", the largest topic's time since its first message as "t_s", and other topics at its times,
    each with its last value."""
    reader = _library("mcap.reader", "mcap")
    topics, other = {}, {}
    with open(path, "rb") as file:
        for _, channel, message in reader.make_reader(file).iter_messages(log_time_order=True):
            if channel.message_encoding == "json":
                row = dict(_numbers(json.loads(message.data), channel.topic))
                times, rows = topics.setdefault((channel.topic, tuple(row)), ([], []))
                times.append(message.log_time)
                rows.append(tuple(row.values()))
            else:
                other[channel.topic] = channel.message_encoding
    if not topics:
        found = ", ".join(f"{topic}: {encoding}" for topic, encoding in other.items())
        raise InputError(f"{path}: expected messages in JSON, found {found or 'none'}")
    first = min(times[0] for times, _ in topics.values())
    return _at_the_times_of_the_largest([((np.array(times) - first) * 1e-9, dict(zip(names, np.array(rows, np.float64).T, strict=True)))
                                         for (_, names), (times, rows) in topics.items() if names])


def _numbers(x, name):
    if isinstance(x, dict):
        for key, value in x.items():
            yield from _numbers(value, f"{name}.{key}")
    elif isinstance(x, (int, float)):
        yield name, x


def _xlsx(path):
    """The first sheet with a row of numbers: columns by the row of names above it (a row of units may be between)."""
    openpyxl = _library("openpyxl", "xlsx")
    book = openpyxl.load_workbook(path, read_only=True, data_only=True)
    try:
        for sheet in book.worksheets:
            rows = [[None if isinstance(x, str) and not x.strip() else x for x in row] for row in sheet.iter_rows(values_only=True)]
            first = next((n for n, row in enumerate(rows) if _mostly_numbers(row)), None)
            if first is not None:
                return _sheet(path, sheet.title, rows, first)
    finally:
        book.close()
    return {}


def _is_number(x):
    return isinstance(x, (int, float)) and not isinstance(x, bool)


def _mostly_numbers(row):
    return 2 * sum(map(_is_number, row)) > sum(x is not None for x in row)


def _sheet(path, title, rows, first):
    """Texts directly above the numbers: one row is the names; of two that are alike full, the upper one, and the lower one the units."""
    full = [sum(isinstance(x, str) for x in row) for row in rows[max(0, first - 2):first]]
    if not full or full[-1] == 0:
        raise InputError(f"{path}: sheet {title!r}, row {first + 1}: numbers without a row of names above them")
    names = rows[first - 2] if len(full) == 2 and full[0] >= full[1] else rows[first - 1]
    data = rows[first:]
    while data and all(x is None for x in data[-1]):
        data.pop()
    columns = {}
    for k, name in enumerate(names):
        values = [row[k] for row in data]
        if name is not None and any(map(_is_number, values)):
            # An empty cell or a text is refused with its row, if the map uses the column.
            columns[str(name).strip()] = np.array([x if _is_number(x) else math.nan for x in values], np.float64)
    return columns


READERS: dict[str, Callable] = {".mat": _mat, ".parquet": _parquet, ".feather": _feather, ".h5": _hdf5, ".hdf5": _hdf5, ".mf4": _mdf,
                                ".mdf": _mdf, ".dat": _mdf, ".mcap": _mcap, ".xlsx": _xlsx, ".xlsm": _xlsx}
