"""Logs of other programs: read by the libraries that know their formats, and made a recording by the map of `iqfoc import`."""

from __future__ import annotations

import importlib
import os
import pathlib
from collections.abc import Callable, Mapping

import numpy as np

from ._host import InputError, MissingFileError, Trouble, doubles, ffi, lib, path_bytes
from .motor import Motor, motor_of, text_file, toml_value
from .recording import Recording, columns_of


def read_log(log: str | os.PathLike | Mapping, map: str | os.PathLike | Mapping | None = None, preset: str | None = None,
             motor: Motor | str | os.PathLike | None = None) -> Recording:
    """A recording of another program's log.

    log: a file, by its ending: .mat (scipy), .parquet or .feather (pyarrow), .h5 or .hdf5 (h5py), .mf4, .mdf or .dat (asammdf), anything
    else a text table as `iqfoc import` reads it; or a mapping of columns, or a data frame. map: the map's file (docs/own-log.md) or a mapping of its tables;
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
        read = READERS.get(pathlib.Path(log).suffix.lower())
        columns = None if read is None else _read(read, label)
    if isinstance(map, Mapping):
        with text_file("".join(f"{k} = {toml_value(v)}\n" for k, v in map.items())) as path:
            return _import(label, columns, path, None, motor, [(path, "map")])
    return _import(label, columns, map, preset, motor, [])


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
            groups.append([s for s in signals if s.samples.dtype.kind in "biuf" and s.samples.ndim == 1 and len(s.samples)])
    lead = max(groups, key=lambda g: (max((len(s.samples) for s in g), default=0), len(g)), default=[])
    if not lead:
        return {}
    t_s = lead[0].timestamps
    columns = {"t_s": t_s}
    for group in [lead] + [g for g in groups if g is not lead]:
        for signal in group:
            at = np.clip(np.searchsorted(signal.timestamps, t_s, side="right") - 1, 0, None)
            columns.setdefault(signal.name, signal.samples[at] if group is not lead else signal.samples)
    return columns


READERS: dict[str, Callable] = {".mat": _mat, ".parquet": _parquet, ".feather": _feather, ".h5": _hdf5, ".hdf5": _hdf5, ".mf4": _mdf,
                                ".mdf": _mdf, ".dat": _mdf}
