"""The design of a current controller with margins, as `iqfoc tune` makes it, and that controller on a plant."""

from __future__ import annotations

import functools
import json
import os
import pathlib
from collections.abc import Sequence

import numpy as np

from ._host import Trouble, ffi, lib, path_bytes, text, written
from .cycle import Firmware
from .diagnosis import Diagnosis, figure_of
from .functions import ONE
from .motor import Motor, motor_of, text_file

METHODS = ("pi", "deadbeat")


class TunedControl(Firmware):
    """The controller of a design (iqfoc/tuned_control.h), with its change detector (iqfoc/watch.h) if `watched`.

    `Tune.control()` makes it. Steps and `run` are those of a Cycle.

    >>> design = iqfoc.tune("data/motors/jarzebowicz2019.toml", drives=1)
    >>> control = design.control(watched=True, noise_A=0.03)
    >>> plant = iqfoc.Drive(design.motor).plant()
    >>> control.reference(0.0, 5.0)
    >>> rows = control.run(plant, 200)
    >>> control.state["alarm"]
    False
    """

    def __init__(self, design: Tune, watched: bool = False, noise_A: float = 0.0):
        trouble = Trouble()
        self._c = ffi.gc(trouble.check(lib.py_tuned_new(design._c, watched, noise_A, trouble.c)), lib.py_tuned_free)
        self._begin(design.motor, lib.py_tuned_firmware(self._c))

    @property
    def state(self) -> dict:
        """alarm: the detector reports a change; group: the changed parameter, once it is named (512 to 2048 cycles later); amount: the
        change in the sizes of iqfoc/watch.h; since_s: its time; i_dq_A at the last valley; drift_dq_A: the disturbance estimate a cycle."""
        s = ffi.new("py_watched *")
        lib.py_tuned_state(self._c, s)
        named = s.group != ffi.NULL
        unit = self.motor.I_base_A / ONE
        return {"alarm": s.alarm, "group": text(s.group) if named else None, "amount": s.amount if named else None,
                "since_s": s.since * self.motor.T_s if named else None, "i_dq_A": tuple(x * unit for x in s.i_dq),
                "drift_dq_A": tuple(x * unit for x in s.drift_dq)}


class Tune:
    """What `tune` designed. `motor`: what it is for; `data`: the JSON of `iqfoc tune --json`; str(): the command's text.

    >>> design = iqfoc.tune("data/motors/jarzebowicz2019.toml", drives=1)
    >>> min(p["disk_margin"] for p in design.points) >= 0.999 * 0.5
    True
    """

    def __init__(self, handle):
        self._c = ffi.gc(handle, lib.py_design_free)
        self.json: str = written(lib.py_design_json, self._c)
        self.data: dict = json.loads(self.json)
        self.motor = Motor._from_handle(lib.py_design_motor(self._c), self.data["motor"])
        self.bandwidth_rad_s: float = self.data["bandwidth_rad_s"]
        self.points: list[dict] = self.data["points"]
        self.observer: dict | None = self.data["observer"]
        self.speed: dict | None = self.data["speed"]

    def control(self, watched: bool = False, noise_A: float = 0.0) -> TunedControl:
        """The controller. watched: with the change detector, for the noise of one current sample, A; 0: the diagnosis' noise."""
        return TunedControl(self, watched, noise_A)

    def page(self, directory: str | os.PathLike) -> pathlib.Path:
        """Writes what `iqfoc tune -o DIR` writes: index.html and the firmware's iqfoc_tuned.h; the page."""
        if not self.data["comparison"]["loops"]:
            raise ValueError("the page compares controllers; give tune(compare=True)")
        trouble = Trouble()
        trouble.check(lib.py_design_report(self._c, path_bytes(directory), trouble.c))
        return pathlib.Path(directory) / "index.html"

    def plot(self):
        """A matplotlib Figure: margins over the speed, and the step of i_q at half the top speed on the nominal machine."""
        figure = figure_of(10.0, 3.4)
        margins, step = figure.subplots(1, 2)
        rpm = [p["rpm"] for p in self.points]
        margins.plot(rpm, [p["disk_margin"] for p in self.points], label="worst of the uncertainty set")
        margins.plot(rpm, [p["nominal"]["disk_margin"] for p in self.points], label="nominal machine")
        margins.axhline(self.data["disk_margin_wanted"], color="k", linewidth=0.8, linestyle=":", label="required")
        margins.set(xlabel="speed in rpm", ylabel="disk margin", ylim=(0.0, None))
        margins.legend()
        t_ms, i_q_A, reference_A = self._step
        step.step(t_ms, reference_A, where="post", color="k", linewidth=0.8, label="reference")
        step.step(t_ms, i_q_A, where="post", label="mean of each cycle")
        step.set(xlabel="t in ms", ylabel="i_q in A")
        step.legend()
        return figure

    @functools.cached_property
    def _step(self):
        from .drive import Drive
        plant, control, m = Drive(self.motor).plant(), self.control(), self.motor
        plant.set_speed(0.5 * m.n_max_rpm / 60.0 * 2.0 * np.pi * m.pole_pairs)
        levels, columns = (0.1 * m.I_base_A, 0.3 * m.I_base_A), []
        for level, cycles in zip(levels, (200, 40), strict=True):
            control.reference(0.0, level)
            columns.append(control.run(plant, cycles)["i_q_mean_A"])
        before = 5
        i_q_A = np.concatenate([columns[0][-before:], columns[1]])
        t_ms = 1e3 * m.T_s * (np.arange(i_q_A.size) - before)
        return t_ms, i_q_A, np.where(t_ms < 0.0, *levels)

    def __str__(self):
        return written(lib.py_design_text, self._c)

    def __repr__(self):
        return f"<Tune of {self.motor.name!r}: bandwidth {self.bandwidth_rad_s:.0f} rad/s, limited by {self.data['limited_by']}>"


def tune(motor: Motor | str | os.PathLike, diagnosis: Diagnosis | str | os.PathLike | None = None, method: str = "pi", margin: float = 0.5,
         ratio: float = 0.0, tolerance: Sequence[float] = (0.3, 0.3, 0.05), drives: int = 50, seed: int = 1, compare: bool = False,
         run_up_s: float = 1.0, inertia_kgm2: float = 0.0) -> Tune:
    """Designs the controller of iqfoc/tuned_control.h with the highest bandwidth that keeps a disk margin, as `iqfoc tune`.

    diagnosis: a Diagnosis or its JSON file, for the machine with its uncertainty. method: `pi` or `deadbeat`. ratio: SFFR at n_max to
    design for; 0: the motor's f_pwm_Hz. tolerance: of R, L and psi_f, shares, without a diagnosis. drives: of the uncertainty set, to
    simulate. compare: with the library's other controllers, which takes a few seconds and which the page needs. run_up_s: fastest run-up
    from standstill to n_max, which sets the bandwidth of the observer. inertia_kgm2: of rotor and load, for the speed control; 0: none.

    >>> design = iqfoc.tune("data/motors/jarzebowicz2019.toml", drives=5)
    >>> design.data["trial"]["unstable"]
    0
    >>> design.observer["trial"]["lost"]
    0
    >>> iqfoc.tune("data/motors/jarzebowicz2019.toml", drives=1, inertia_kgm2=1e-3).speed["trial"][1]["lost"]
    False
    >>> plant, control = iqfoc.Drive(design.motor).plant(), design.control()
    >>> plant.set_speed(2500.0)
    >>> control.reference(0.0, 5.0)
    >>> round(float(control.run(plant, 300)["i_q_mean_A"][-100:].mean()), 1)
    5.0
    """
    if method not in METHODS:
        raise ValueError(f"no method {method!r}; there are {', '.join(METHODS)}")
    shares = [float(x) for x in tolerance]
    for name, x, low, high in (("margin", margin, 0.05, 1.5), ("run_up_s", run_up_s, 1e-4, 1e6), ("drives", drives, 1, 100000), *(("tolerance", x, 0.0, 0.9) for x in shares)):
        if not low <= x <= high:
            raise ValueError(f"{name} = {x}; expected {low} to {high}")
    if inertia_kgm2 != 0.0 and not 1e-9 <= inertia_kgm2 <= 1e9:
        raise ValueError(f"inertia_kgm2 = {inertia_kgm2}; expected 1e-9 to 1e9, or 0")
    if len(shares) != 3:
        raise ValueError(f"tolerance: expected three shares, of R, L and psi_f, not {len(shares)}")
    if ratio != 0.0 and not 3.0 <= ratio <= 1000.0:
        raise ValueError(f"ratio = {ratio}; expected 3 to 1000, or 0")
    if isinstance(diagnosis, Diagnosis):
        with text_file(diagnosis.json, ".json") as path:
            return _tune(motor_of(motor), path, [(path, "diagnosis")], method, margin, ratio, shares, drives, seed, compare, run_up_s, inertia_kgm2)
    return _tune(motor_of(motor), diagnosis, [], method, margin, ratio, shares, drives, seed, compare, run_up_s, inertia_kgm2)


def _tune(motor, path, replace, method, margin, ratio, shares, drives, seed, compare, run_up_s, inertia_kgm2):
    trouble = Trouble(replace)
    choice = ffi.new("py_tune_choice *", {"ratio": ratio, "deadbeat": method == "deadbeat", "margin": margin, "tolerance": shares,
                                          "drives": drives, "seed": seed, "compares": compare, "run_up_s": run_up_s, "inertia_kgm2": inertia_kgm2})
    return Tune(trouble.check(lib.py_tune(motor._c, choice, ffi.NULL if path is None else path_bytes(path), trouble.c)))
