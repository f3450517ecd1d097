"""Motor files (docs/interfaces.md, "The motor file"): what a drive is said to be."""

from __future__ import annotations

import contextlib
import os
import pathlib
import tempfile
import tomllib
from collections.abc import Iterator, Mapping

from ._host import InputError, Trouble, ffi, lib, path_bytes

_MOTOR = ("pole_pairs", "R_ohm", "L_d_H", "L_q_H", "psi_f_Wb", "I_rated_A_rms", "n_max_rpm")
_INVERTER = ("f_pwm_Hz", "u_dc_V")


@contextlib.contextmanager
def text_file(text: str, suffix: str = ".toml") -> Iterator[str]:
    """A file that holds a text for as long as C reads it."""
    with tempfile.NamedTemporaryFile("w", suffix=suffix, encoding="utf-8", delete=False) as file:
        file.write(text)
    try:
        yield file.name
    finally:
        os.unlink(file.name)


def toml_value(x) -> str:
    """A number, flag, text, list or mapping as TOML; mappings stand inline."""
    if isinstance(x, Mapping):
        return "{ " + ", ".join(f"{k} = {toml_value(v)}" for k, v in x.items()) + " }"
    if isinstance(x, str):
        escaped = x.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
        return f'"{escaped}"'
    if isinstance(x, bool):
        return "true" if x else "false"
    if isinstance(x, int):
        return str(x)
    if hasattr(x, "__iter__"):
        return "[" + ", ".join(toml_value(v) for v in x) + "]"
    return repr(float(x))


class Motor:
    """A motor file: machine, inverter, and what a diagnosis added to them. Unchangeable; `replace` makes another.

    `Motor("M.toml")` reads a file; `Motor(R_ohm=0.75, ...)` makes one of values (all of pole_pairs, R_ohm, L_d_H, L_q_H, psi_f_Wb,
    I_rated_A_rms, n_max_rpm, f_pwm_Hz, u_dc_V; `name` and `extension`, a mapping of tables, may be left out). The values are attributes,
    the tables of extensions are in `extension`. Refused values raise InputError with file, line and column.

    >>> motor = iqfoc.Motor("data/motors/jarzebowicz2019.toml")
    >>> motor.replace(R_ohm=0.95).R_ohm
    0.95
    """

    def __init__(self, path: str | os.PathLike | None = None, **values):
        if (path is None) == (not values):
            raise TypeError("Motor: expected a file, or values by name")
        if path is not None:
            trouble = Trouble()
            self._take(trouble.check(lib.py_motor_read(path_bytes(path), ffi.NULL, trouble.c)), str(path))
        else:
            self._from_text(_text_of(values), "motor")

    @classmethod
    def from_toml(cls, text: str, label: str = "motor") -> Motor:
        """A motor file's text; `label` is what messages and diagnoses call it."""
        made = cls.__new__(cls)
        made._from_text(text, label)
        return made

    @classmethod
    def _from_handle(cls, handle, label):
        made = cls.__new__(cls)
        made._take(handle, label)
        return made

    def _from_text(self, text, label):
        with text_file(text) as path:
            trouble = Trouble([(path, label)])
            self._take(trouble.check(lib.py_motor_read(path_bytes(path), path_bytes(label), trouble.c)), label)

    def _take(self, handle, label):
        self._c = ffi.gc(handle, lib.py_motor_free)
        self.label = label
        table = tomllib.loads(self.to_toml())
        self.name: str = table["name"]
        self._values = {**table["motor"], **table["inverter"]}
        self.extension: dict[str, dict[str, float]] = table.get("extension", {})

    def __getattr__(self, key):
        values = self.__dict__.get("_values", {})
        if key in values:
            return values[key]
        raise AttributeError(f"a motor has no {key}; it has {', '.join(_MOTOR + _INVERTER)}, name, extension")

    @property
    def T_s(self) -> float:
        """The control cycle, s."""
        return 1.0 / self.f_pwm_Hz

    @property
    def I_base_A(self) -> float:
        """The current base: the peak of the rated current, A."""
        return 2.0 ** 0.5 * self.I_rated_A_rms

    def to_toml(self) -> str:
        """The motor file's text; reading it gives the same values."""
        with text_file("") as path:
            self.write(path)
            return pathlib.Path(path).read_text(encoding="utf-8")

    def write(self, path: str | os.PathLike, comment: str | None = None) -> None:
        """Writes the motor file; it appears whole or not at all."""
        trouble = Trouble()
        trouble.check(lib.py_motor_write(self._c, path_bytes(path), ffi.NULL if comment is None else path_bytes(comment), trouble.c))

    def replace(self, **values) -> Motor:
        """Another motor, with these values in place of its own."""
        own = {"name": self.name, **self._values, "extension": self.extension}
        unknown = set(values) - set(own)
        if unknown:
            raise InputError(f"a motor has no {', '.join(sorted(unknown))}; it has {', '.join(own)}")
        return Motor(**{**own, **values})

    def __reduce__(self):
        return (Motor.from_toml, (self.to_toml(), self.label))

    def __eq__(self, other):
        return isinstance(other, Motor) and self.to_toml() == other.to_toml()

    __hash__ = None

    def __repr__(self):
        return f"<Motor {self.name!r}: {', '.join(f'{k} = {v:g}' for k, v in self._values.items())}" + (
            f", extended by {', '.join(self.extension)}>" if self.extension else ">")

    def _repr_html_(self):
        from ._html import table
        return table(("", self.name), list(self._values.items()) + [(f"{e}.{k}", v) for e, t in self.extension.items() for k, v in t.items()])


def _text_of(values):
    values = dict(values)
    extension = values.pop("extension", {})
    name = values.pop("name", "motor")
    lines = [f"name = {toml_value(name)}", "[motor]"]
    lines += [f"{k} = {toml_value(values.pop(k))}" for k in _MOTOR if k in values]
    lines += ["[inverter]"] + [f"{k} = {toml_value(values.pop(k))}" for k in _INVERTER if k in values]
    if values:
        raise InputError(f"a motor has no {', '.join(sorted(values))}; it has {', '.join(_MOTOR + _INVERTER)}, name, extension")
    for cause, table in extension.items():
        lines += [f"[extension.{cause}]"] + [f"{k} = {toml_value(v)}" for k, v in table.items()]
    return "\n".join(lines) + "\n"


def motor_of(x) -> Motor:
    """A Motor, or the file of one."""
    return x if isinstance(x, Motor) else Motor(x)
