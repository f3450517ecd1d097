"""The diagnosis: from a recording and a motor file to the model's error, its causes, and the error reduction."""

from __future__ import annotations

import functools
import json
import os
import pathlib
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np
from numpy.typing import NDArray

from ._host import Trouble, _pointers, ffi, lib, path_bytes, strings, written
from ._html import table
from .motor import Motor, motor_of
from .recording import Recording, recording_of


@dataclass(frozen=True)
class Parameter:
    """One number of a cause: in the motor file, as found, and its 95 % interval."""

    name: str
    unit: str
    nominal: float | None
    value: float | None
    ci95: tuple[float, float] | None


@dataclass(frozen=True)
class Cause:
    """A named cause (docs/diagnosis_reference.md lists them)."""

    id: str
    parameters: tuple[Parameter, ...]
    gain: float
    """The one-cycle error before it was added over the error after."""
    probability: float
    confused_with: tuple[str, ...]
    trades_with: tuple[str, ...]

    def __getitem__(self, name: str) -> Parameter:
        for parameter in self.parameters:
            if parameter.name == name:
                return parameter
        raise KeyError(f"{self.id} has no {name}; it has {', '.join(p.name for p in self.parameters)}")


@dataclass(frozen=True)
class Errors:
    """Errors of one-cycle prediction and open-loop simulation, percent of the current, on held-out rows."""

    metric: str
    nominal: float
    extended: float
    noise_floor: float
    gain: float
    free_run_nominal: float | None
    free_run_extended: float | None


class Diagnosis:
    """What `diagnose` found.

    verdict: clean, explained, partly or unexplained. causes: ordered by their error reduction. `data` is the JSON of
    `iqfoc diagnose --json` (docs/diagnosis_reference.md), `json` its text, digit by digit; `series` the errors row by row; str() the command's text.
    Two diagnoses are equal if their JSON is. One that is unpickled is computed again, from recording and motor.
    """

    def __init__(self, handle, recording: Recording, motor: Motor, skip: tuple[str, ...] = ()):
        self._skip = skip
        self._c = ffi.gc(handle, lib.py_diagnosis_free)
        self.recording, self.motor = recording, motor  # C looks into both
        self.json: str = written(lib.py_diagnosis_json, self._c)
        self.data: dict = json.loads(self.json)
        self.verdict: str = self.data["verdict"]
        self.summary: str = self.data["summary"]
        self.causes: tuple[Cause, ...] = tuple(_cause(c) for c in self.data["causes"])
        self.error = Errors(**{k: self.data["error"].get(k) for k in Errors.__dataclass_fields__})

    def __reduce__(self):
        return (diagnose, (self.recording, self.motor, self._skip))

    def __eq__(self, other):
        return self.json == other.json if isinstance(other, Diagnosis) else NotImplemented

    def __hash__(self):
        return hash(self.json)

    @functools.cached_property
    def series(self) -> dict[str, NDArray[np.float64]]:
        """A number a row: `t_s`; alpha and beta of `error_nominal`, `error_extended` (one cycle, A) and of `free_nominal`, `free_extended`
        (the current of the open-loop simulation, A), nan where there is no prediction; `held_out`, 1 where the row was not fitted."""
        names = [f"{n}_{x}_A" for n in ("error_nominal", "error_extended", "free_nominal", "free_extended") for x in ("alpha", "beta")]
        columns = {n: np.empty(self.recording.rows) for n in [*names, "held_out"]}
        lib.py_diagnosis_series(self._c, _pointers([columns[n] for n in names], "double"),
                                ffi.cast("double *", columns["held_out"].ctypes.data))
        return {"t_s": self.recording["t_s"], **columns}

    @property
    def tables(self) -> dict[str, list[dict]]:
        """Rows for a data frame: `causes` (a row a parameter), `estimates`, `runs`."""
        causes = [{"cause": c.id, "gain": c.gain, "probability": c.probability, **vars(p)} for c in self.causes for p in c.parameters]
        return {"causes": causes, "estimates": self.data["estimates"], "runs": self.data["runs"]}

    def to_motor(self) -> Motor:
        """The motor file with what was found; every command takes it."""
        return Motor._from_handle(lib.py_diagnosis_motor(self._c), f"{self.motor.label}, extended")

    def page(self, directory: str | os.PathLike) -> pathlib.Path:
        """Writes what `iqfoc diagnose -o DIR` writes (report.html, motor_extended.toml, iqfoc_extension.h, diagnosis.json); the page."""
        trouble = Trouble()
        trouble.check(lib.py_diagnosis_report(self._c, path_bytes(directory), trouble.c))
        return pathlib.Path(directory) / "report.html"

    def plot(self):
        """A matplotlib Figure: the one-cycle error over time and of each run, with the motor file and with the extended model."""
        figure = figure_of(10.0, 3.4)
        in_time, by_run = figure.subplots(1, 2, width_ratios=(2, 1))
        for name, colour in (("nominal", "tab:red"), ("extended", "tab:blue")):
            size = np.hypot(self.series[f"error_{name}_alpha_A"], self.series[f"error_{name}_beta_A"])
            in_time.plot(self.series["t_s"], size, color=colour, linewidth=0.5, label=name)
            by_run.plot([r["run"] for r in self.data["runs"]], [r[name] for r in self.data["runs"]], "o", color=colour, label=name)
        in_time.set(xlabel="t in s", ylabel="one-cycle error in A")
        by_run.set(xlabel="run", ylabel="one-cycle error in %", yscale="log")
        in_time.legend()
        return figure

    def __str__(self):
        return written(lib.py_diagnosis_text, self._c)

    def __repr__(self):
        return f"<Diagnosis of {self.recording.label!r}: {self.verdict}; {', '.join(c.id for c in self.causes) or 'no cause'}>"

    def _repr_html_(self):
        causes = [(f"{c.id}: {p.name}", p.nominal, p.value, "" if p.ci95 is None else f"{p.ci95[0]:.4g} … {p.ci95[1]:.4g}", p.unit,
                   c.probability) for c in self.causes for p in c.parameters]
        e = self.error
        errors = [("one cycle", e.nominal, e.extended, e.noise_floor), ("open-loop simulation", e.free_run_nominal, e.free_run_extended, "")]
        return (f"<p><b>{escape(self.verdict)}</b>: {escape(self.summary)}</p>" +
                (table(("cause", "motor file", "found", "95 %", "unit", "probability"), causes) if causes else "") +
                table(("error in %", "motor file", "extended", "noise floor"), errors))


def figure_of(width, height):
    """An empty matplotlib Figure, inches."""
    try:
        from matplotlib.figure import Figure
    except ImportError as none:
        raise ImportError("plots need matplotlib: pip install iqfoc[plot]") from none
    return Figure(figsize=(width, height), layout="constrained")


def _cause(c):
    parameters = tuple(Parameter(p["name"], p["unit"], p["nominal"], p["value"], None if p["ci95"] is None else tuple(p["ci95"]))
                       for p in c["parameters"])
    return Cause(c["id"], parameters, c["gain"], c["probability"], tuple(c["confused_with"]), tuple(c["trades_with"]))


def diagnose(recording, motor: Motor | str | os.PathLike, skip: Sequence[str] = ()) -> Diagnosis:
    """What a recording shows the model to get wrong, as `iqfoc diagnose` finds it, to the last digit.

    recording: a Recording, a CSV file, a mapping of columns or a data frame. motor: a Motor or its file, as the user has it. skip: causes
    to be left out of the search. Raises InputError, with the command's one line, if the recording cannot be used.

    >>> found = iqfoc.diagnose("data/recordings/dead_time.csv.gz", "data/recordings/dead_time.toml")
    >>> [cause.id for cause in found.causes]
    ['dead_time']
    >>> found.causes[0]["v_dead"].unit
    'V'
    """
    recording, motor = recording_of(recording), motor_of(motor)
    trouble = Trouble()
    skip = (skip,) if isinstance(skip, str) else tuple(skip)
    words, kept = strings(skip)
    handle = trouble.check(lib.py_diagnose(recording._c, motor._c, len(words), words, trouble.c))
    del kept
    return Diagnosis(handle, recording, motor, skip)
