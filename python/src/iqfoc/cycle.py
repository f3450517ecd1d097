"""Controllers of the firmware, step by step or for many cycles with a plant."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ._host import Trouble, _pointers, ffi, lib, text
from .functions import ONE, from_float
from .motor import Motor, motor_of

if TYPE_CHECKING:
    from .drive import Plant
    from .recorder import Recorder

MODELS = ("quasi_discrete", "exact", None, None, "euler")
FEEDBACKS = ("midpoint", "corrected_mean", "quasi_discrete_mean", "exact_mean")
CONTROLS = ("pi", "deadbeat", "deadbeat_observer")
MODULATIONS = ("pwm", "six_step", "over")
TICKS_PER_S = 100_000_000


@dataclass(frozen=True)
class Sample:
    """What the converters deliver at a valley or a peak. Physical values; `Cycle` makes the firmware's integers of them.

    i_mean_A: means of the phases over an interval of six-step by a timer, at its end.

    >>> iqfoc.Sample(i_A=(1.0, -0.5, -0.5), theta_e_rad=0.0, omega_e_rad_s=2500.0, u_dc_V=24.0, t_s=0.0).i_A
    (1.0, -0.5, -0.5)
    """

    i_A: tuple[float, float, float]
    theta_e_rad: float
    omega_e_rad_s: float
    u_dc_V: float
    t_s: float
    i_mean_A: tuple[float, float, float] | None = None


@dataclass(frozen=True)
class Command:
    """What the inverter does from the next valley on. `Plant.cycle` takes it.

    duty: of the high sides, integers in Q7.24; duties: the same as floats, 0 to 1. scale: Q7.24 factor by which the modulator shortened
    the voltage. interval_s: 0 for the duties of a PWM period; else the duties are an inverter state of six-step, for so long.

    >>> iqfoc.Command((8388608, 4194304, 0), 16777216, True).duties
    (0.5, 0.25, 0.0)
    """

    duty: tuple[int, int, int]
    scale: int
    gates: bool
    interval_s: float = 0.0

    @property
    def duties(self) -> tuple[float, float, float]:
        """The duties as floats, exactly."""
        return tuple(d / ONE for d in self.duty)


class Firmware:
    """What `Cycle` and `TunedControl` have in common: the reference, both steps, and `run`."""

    motor: Motor

    def _begin(self, motor, firmware):
        self.motor, self._f = motor, firmware
        self._command = ffi.new("py_command *")

    def reference(self, i_d_A: float, i_q_A: float) -> None:
        """Sets the reference of the current: rotor frame, peak A."""
        d, q = from_float([i_d_A / self.motor.I_base_A, i_q_A / self.motor.I_base_A])
        lib.py_firmware_reference(self._f, int(d), int(q))

    def valley(self, sample: Sample) -> None:
        """At the carrier's valley: the prediction's error, the next prediction, the mean."""
        lib.py_firmware_valley(self._f, self._integers(sample, 0))

    def peak(self, sample: Sample, output_mid: float = 1.5) -> Command:
        """At the carrier's peak: control and modulation. output_mid: the middle of the time in which the command acts, cycles after the
        valley; of a Cycle only."""
        lib.py_firmware_peak(self._f, self._integers(sample, ONE // 2), int(from_float(output_mid)), self._command)
        return _command(self._command)

    def run(self, plant: Plant, cycles: int, recorder: Recorder | None = None) -> dict[str, NDArray[np.float64]]:
        """So many control cycles with a plant, in C: columns of one number a cycle.

        Names and units are those of a recording, so that `Recording(...)` takes them. In addition: the true means `i_d_mean_A` and
        `i_q_mean_A`, and `torque_Nm` at the cycle's end. Raises Error if the firmware stops the drive. recorder: takes each cycle.

        In six-step by a timer a row is an inverter state: `t_s` and the sampled columns are at its start, `duration_s` is its length.
        """
        timer = self._timer
        if plant.motor.T_s != self.motor.T_s:
            raise ValueError(f"the controller's cycle is {self.motor.T_s:g} s, the plant's is {plant.motor.T_s:g} s")
        if cycles < 0:
            raise ValueError(f"cycles = {cycles}; expected 0 or more")
        if timer and recorder is not None:
            raise ValueError("a recorder takes PWM cycles; this controller runs by the timer")
        columns = {name: np.empty(cycles) for name in _run_columns()}
        trouble = Trouble()
        trouble.check(lib.py_run(self._f, plant._c, ffi.NULL if recorder is None else recorder._c, cycles,
                                 _pointers(columns.values(), "double"), trouble.c))
        return {n: c for n, c in columns.items() if not (n.endswith("_mid_A") if timer else n == "duration_s")}

    _timer = False

    def _integers(self, s, at):
        m = self.motor
        numbers = from_float([*(x / m.I_base_A for x in s.i_A), math.remainder(s.theta_e_rad / math.tau, 1.0),
                              s.omega_e_rad_s * m.T_s / math.tau, s.u_dc_V / m.u_dc_V])
        i, (theta, speed, u_dc) = [int(x) for x in numbers[:3]], [int(x) for x in numbers[3:]]
        mean = {} if s.i_mean_A is None else {"has_mean": True, "i_mean": [int(x) for x in from_float([x / m.I_base_A for x in s.i_mean_A])]}
        return ffi.new("py_sample *", {"i": i, "theta": theta, "speed": speed, "u_dc": u_dc, "instant": at, **mean,
                                       "time": round(s.t_s * TICKS_PER_S) % 2 ** 32,
                                       "clipped": max(abs(x) for x in s.i_A) > 15.9 * m.I_base_A})


class Cycle(Firmware):
    """The library's control cycle as a port's interrupts call it: `valley(sample)`, then `peak(sample)`, which gives the command.

    motor: a Motor or its file. control: `pi`, `deadbeat` (from the model's prediction; feedback and bandwidth are not used) or
    `deadbeat_observer` (with a disturbance observer of `observer_gain`, 0 to 1). feedback: `midpoint`, `corrected_mean` (2016 (10)),
    `quasi_discrete_mean` (2019 (10)) or `exact_mean` (which needs the exact model). model: `quasi_discrete` (2019 (12)), `exact`, `euler`.
    modulation: `pwm`, `six_step`, `over`. bandwidth_Hz: of the PI control; 0 is the firmware's own choice. extended: correct what the
    motor file's extensions state.

    >>> drive = iqfoc.Drive(iqfoc.Motor("data/motors/jarzebowicz2019.toml"))
    >>> plant, cycle = drive.plant(), iqfoc.Cycle(drive.motor, control="deadbeat", model="exact")
    >>> plant.set_speed(2500.0)
    >>> cycle.reference(0.0, 5.0)
    >>> rows = cycle.run(plant, 200)
    >>> round(float(rows["i_q_mean_A"][-1]), 1)
    5.0
    """

    def __init__(self, motor: Motor | str | os.PathLike, feedback: str = "midpoint", model: str = "quasi_discrete", modulation: str = "pwm",
                 bandwidth_Hz: float = 0.0, extended: bool = False, control: str = "pi", observer_gain: float = 0.1):
        motor = motor_of(motor)
        if feedback == "exact_mean" and model != "exact":
            raise ValueError("feedback exact_mean is the exact model's; give model='exact'")
        if bandwidth_Hz < 0.0 or not math.isfinite(bandwidth_Hz):
            raise ValueError(f"bandwidth_Hz = {bandwidth_Hz}; expected a number >= 0")
        if not 0.0 <= observer_gain <= 1.0:
            raise ValueError(f"observer_gain = {observer_gain}; expected 0 to 1")
        how = ffi.new("py_methods *", {"model": _index(MODELS, "model", model), "feedback": _index(FEEDBACKS, "feedback", feedback),
                                       "modulation": _index(MODULATIONS, "modulation", modulation),
                                       "control": _index(CONTROLS, "control", control), "bandwidth_Hz": bandwidth_Hz,
                                       "observer_gain": observer_gain, "extended": extended})
        trouble = Trouble()
        self._c = ffi.gc(trouble.check(lib.py_cycle_new(motor._c, how, trouble.c)), lib.py_cycle_free)
        self._begin(motor, lib.py_cycle_firmware(self._c))
        lib.py_cycle_enable(self._c, True)

    def to_timer(self, sample: Sample, bandwidth_Hz: float = 10.0, angle_turns: float | None = None,
                 limits_turns: tuple[float, float] | None = None) -> Command:
        """Six-step by a timer from the instant of this sample on (iqfoc/cycle_six_step.h): the first inverter state.

        From now on `peak(sample)` is the end of a state, with its `i_mean_A`, and returns the next one; `Plant.cycle` and `run` take them
        as they take PWM's. The angle of the voltage ahead of the d axis controls i_q, with this bandwidth (slow against R/L) and between
        these limits; angle_turns: at the start. None: the angle of the last requested voltage, a quarter turn if there was none, and the
        limits 0 and half a turn, of the sign of the speed.

        >>> motor = iqfoc.Motor("data/motors/jarzebowicz2019.toml").replace(u_dc_V=540.0)
        >>> plant, cycle = iqfoc.Drive(motor).plant(), iqfoc.Cycle(motor)
        >>> plant.set_speed(2513.0)
        >>> first = cycle.to_timer(plant.sample())
        >>> cycle.reference(0.0, 7.0)
        >>> rows = cycle.run(plant, 2400)
        >>> round(float(rows["i_q_mean_A"][-600:].mean()), 1)
        7.0
        """
        sign = -1.0 if sample.omega_e_rad_s < 0.0 else 1.0
        if bandwidth_Hz <= 0.0 or not math.isfinite(bandwidth_Hz):
            raise ValueError(f"bandwidth_Hz = {bandwidth_Hz}; expected a number > 0")
        low, high = (min(0.0, 0.5 * sign), max(0.0, 0.5 * sign)) if limits_turns is None else map(float, limits_turns)
        if not -0.5 <= low < high <= 0.5:
            raise ValueError(f"limits_turns = {limits_turns}; expected two rising numbers from -0.5 to 0.5")
        m = self.motor
        # i_q answers to the angle by U/(omega L_q) per radian, U = (2/pi) u_dc, and a state lasts a sixth of a turn: no speed is left.
        gain = math.tau * bandwidth_Hz * m.L_q_H * m.I_base_A / (6.0 * 2.0 / math.pi * m.u_dc_V)
        if gain > 1.0:
            raise ValueError(f"bandwidth_Hz = {bandwidth_Hz}; expected at most {bandwidth_Hz / gain:.3g}")
        asked = any(self.state["u_dq"])
        begin = 0.25 * sign if angle_turns is None else float(angle_turns)
        trouble = Trouble()
        trouble.check(lib.py_cycle_to_timer(self._c, self._integers(sample, 0), ffi.new("double[3]", [gain, low, high]), begin,
                                            angle_turns is None and asked, self._command, trouble.c))
        return _command(self._command)

    def to_carrier(self) -> Command:
        """Ends six-step by a timer at the end of a state: PWM again, for PI control with modulation `over`. The next state serves as the
        first PWM period."""
        trouble = Trouble()
        trouble.check(lib.py_cycle_to_carrier(self._c, self._command, trouble.c))
        return _command(self._command)

    @property
    def _timer(self):
        return lib.py_cycle_timer(self._c, ffi.new("double *"))

    def enable(self, enabled: bool = True) -> None:
        """Off: the safe output, integrators held at zero."""
        lib.py_cycle_enable(self._c, enabled)

    def clear(self) -> None:
        """Ends a trip: status bits, integrators and the memory of earlier samples."""
        lib.py_cycle_clear(self._c)

    @property
    def state(self) -> dict:
        """The firmware's state: Q7.24, currents and voltages per unit; `status` in words; `timer_angle_turns`: of the voltage in six-step
        by a timer, else None."""
        s = ffi.new("py_state *")
        lib.py_cycle_state(self._c, s)
        words = ffi.new("char[160]")
        lib.py_status_text(s.status, words, 160)
        vectors = ("i_ref_dq", "i_dq", "u_dq", "u_ab", "i_valley", "i_next", "error", "i_corrected_dq")
        angle = ffi.new("double *")
        timer = lib.py_cycle_timer(self._c, angle)
        return {"status": text(words), "enabled": s.enabled, "tripped": s.tripped, "corrected": s.corrected,
                "timer_angle_turns": angle[0] if timer else None,
                **{v: tuple(getattr(s, v)) for v in vectors}}


def _command(c):
    return Command(tuple(c.duty), c.scale, c.gates, c.interval_s)


def _run_columns():
    names = []
    while (name := lib.py_run_column_name(len(names))) != ffi.NULL:
        names.append(text(name))
    return names


def _index(words, what, word):
    if word is None or word not in words:
        raise ValueError(f"no {what} {word!r}; there are {', '.join(w for w in words if w)}")
    return words.index(word)
