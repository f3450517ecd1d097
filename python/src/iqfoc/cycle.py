"""The control cycle of the firmware, step by step."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass

from ._host import Trouble, ffi, lib, text
from .functions import ONE, from_float
from .motor import Motor, motor_of

MODELS = ("quasi_discrete", "exact", None, None, "euler")
FEEDBACKS = ("midpoint", "corrected_mean", "quasi_discrete_mean", "exact_mean")
MODULATIONS = ("pwm", "six_step", "over")
TICKS_PER_S = 100_000_000


@dataclass(frozen=True)
class Sample:
    """What the converters deliver at a valley or a peak. Physical values; `Cycle` makes the firmware's integers of them."""

    i_A: tuple[float, float, float]
    theta_e_rad: float
    omega_e_rad_s: float
    u_dc_V: float
    t_s: float


@dataclass(frozen=True)
class Command:
    """What the inverter is to do from the next valley on. Q7.24: duties 0 to 1 of the high sides; scale, what the voltage was cut by."""

    duty: tuple[int, int, int]
    scale: int
    gates: bool

    @property
    def duties(self) -> tuple[float, float, float]:
        """The duties as floats, exactly."""
        return tuple(d / ONE for d in self.duty)


class Cycle:
    """The library's control cycle as a port's interrupts call it: `valley(sample)`, then `peak(sample)`, which gives the command.

    motor: a Motor or its file. feedback: `midpoint`, `corrected_mean` (2016 (10)), `quasi_discrete_mean` (2019 (10)) or `exact_mean`
    (which needs the exact model). model: `quasi_discrete` (2019 (12)), `exact`, `euler`. modulation: `pwm`, `six_step`, `over`.
    bandwidth_Hz: of the current control; 0 is the firmware's own choice. extended: put right what the motor file's extensions say.

    `reference(i_d_A, i_q_A)` sets what is asked for; `state` is the firmware's state, integers in Q7.24.
    """

    def __init__(self, motor: Motor | str | os.PathLike, feedback: str = "midpoint", model: str = "quasi_discrete", modulation: str = "pwm",
                 bandwidth_Hz: float = 0.0, extended: bool = False):
        self.motor = motor_of(motor)
        if feedback == "exact_mean" and model != "exact":
            raise ValueError("feedback exact_mean is the exact model's; give model='exact'")
        if bandwidth_Hz < 0.0 or not math.isfinite(bandwidth_Hz):
            raise ValueError(f"bandwidth_Hz = {bandwidth_Hz}; expected a number >= 0")
        how = ffi.new("py_methods *", {"model": _index(MODELS, "model", model), "feedback": _index(FEEDBACKS, "feedback", feedback),
                                       "modulation": _index(MODULATIONS, "modulation", modulation), "bandwidth_Hz": bandwidth_Hz,
                                       "extended": extended})
        trouble = Trouble()
        self._c = ffi.gc(trouble.check(lib.py_cycle_new(self.motor._c, how, trouble.c)), lib.py_cycle_free)
        self._command = ffi.new("py_command *")
        lib.py_cycle_enable(self._c, True)

    def enable(self, enabled: bool = True) -> None:
        """Off: the safe output, integrators held at zero."""
        lib.py_cycle_enable(self._c, enabled)

    def clear(self) -> None:
        """Ends a trip: status bits, integrators and the memory of earlier samples."""
        lib.py_cycle_clear(self._c)

    def reference(self, i_d_A: float, i_q_A: float) -> None:
        """The current asked for, rotor frame, peak A."""
        d, q = from_float([i_d_A / self.motor.I_base_A, i_q_A / self.motor.I_base_A])
        lib.py_cycle_reference(self._c, int(d), int(q))

    def valley(self, sample: Sample) -> None:
        """At the carrier's valley: the prediction's error, the next prediction, the mean."""
        lib.py_cycle_valley(self._c, self._integers(sample, 0))

    def peak(self, sample: Sample, output_mid: float = 1.5) -> Command:
        """At the carrier's peak: control and modulation. output_mid: the middle of the span in which the command acts, cycles after the
        valley."""
        lib.py_cycle_peak(self._c, self._integers(sample, ONE // 2), int(from_float(output_mid)), self._command)
        c = self._command
        return Command(tuple(c.duty), c.scale, c.gates)

    @property
    def state(self) -> dict:
        """The firmware's state: Q7.24, currents and voltages per unit; `status` in words."""
        s = ffi.new("py_state *")
        lib.py_cycle_state(self._c, s)
        words = ffi.new("char[160]")
        lib.py_status_text(s.status, words, 160)
        vectors = ("i_ref_dq", "i_dq", "u_dq", "u_ab", "i_valley", "i_next", "error", "i_corrected_dq")
        return {"status": text(words), "enabled": s.enabled, "tripped": s.tripped, "corrected": s.corrected,
                **{v: tuple(getattr(s, v)) for v in vectors}}

    def _integers(self, s, at):
        m = self.motor
        numbers = from_float([*(x / m.I_base_A for x in s.i_A), math.remainder(s.theta_e_rad / math.tau, 1.0),
                              s.omega_e_rad_s * m.T_s / math.tau, s.u_dc_V / m.u_dc_V])
        i, (theta, turns, u_dc) = [int(x) for x in numbers[:3]], [int(x) for x in numbers[3:]]
        return ffi.new("py_sample *", {"i": i, "theta": theta, "turns": turns, "u_dc": u_dc, "at": at,
                                       "time": round(s.t_s * TICKS_PER_S) % 2 ** 32,
                                       "clipped": max(abs(x) for x in s.i_A) > 15.9 * m.I_base_A})


def _index(words, what, word):
    if word is None or word not in words:
        raise ValueError(f"no {what} {word!r}; there are {', '.join(w for w in words if w)}")
    return words.index(word)
