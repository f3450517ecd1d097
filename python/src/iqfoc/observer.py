"""The observer of rotor angle and speed without a sensor, in the firmware's arithmetic."""

from __future__ import annotations

import math
import os
from dataclasses import replace
from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from ._host import Trouble, ffi, lib, over_arrays
from .cycle import Sample
from .functions import IQ24, clarke3, from_float, to_float
from .motor import Motor, motor_of

if TYPE_CHECKING:
    from .drive import Means

REASONS = {1: "angle", 2: "flux", 4: "slow"}


class Observer:
    """The observer of `iqfoc/observer.h` for a motor file, with the gain and the limits that `iqfoc observe` has.

    Currents and voltages are per unit in the stationary frame, angles and speeds turns and turns per cycle, all Q7.24 (docs/units.md). It
    begins at angle 0 and rest, seeking.

    A machine without current whose flux, 0.8933 per unit, turns 0.08 of a turn per cycle; the observer begins with half the speed:

    >>> observer = iqfoc.Observer("data/motors/jarzebowicz2019.toml")
    >>> observer.start(turns=iqfoc.from_float(0.04))
    >>> voltage = np.diff(0.8933 * np.exp(2j * np.pi * 0.08 * np.arange(201)))
    >>> theta, turns, locked = observer.step(iqfoc.from_float(voltage.real), iqfoc.from_float(voltage.imag), 0, 0, 0, 0)
    >>> bool(locked[-1]), iqfoc.to_float(turns[-1]).round(4).item(), observer.lost
    (True, 0.08, ())

    A drive whose controller has no other angle than the observed one, begun 10 degrees off:

    >>> drive = iqfoc.Drive("data/motors/jarzebowicz2019.toml")
    >>> plant, cycle, observer = drive.plant(), iqfoc.Cycle(drive.motor), iqfoc.Observer(drive.motor)
    >>> plant.set_speed(1500.0)
    >>> cycle.reference(0.0, 8.0)
    >>> observer.start(theta=iqfoc.from_float(10 / 360), turns=iqfoc.from_float(1500.0 * drive.motor.T_s / (2 * np.pi)))
    >>> command, mean = (0.5, 0.5, 0.5), None
    >>> for _ in range(1000):
    ...     valley, peak, mean_next = plant.cycle(command)
    ...     seen = valley if mean is None else observer.valley(mean, valley)
    ...     cycle.valley(seen)
    ...     command, mean = cycle.peak(observer.peak(peak)), mean_next
    >>> [round(x, 1) for x in mean.i_dq_A], abs(math.remainder(seen.theta_e_rad - valley.theta_e_rad, 2 * math.pi)) < 1e-4
    ([0.1, 8.0], True)
    """

    def __init__(self, motor: Motor | str | os.PathLike):
        self.motor = motor_of(motor)
        trouble = Trouble()
        self._c = ffi.gc(trouble.check(lib.py_observer_new(self.motor._c, trouble.c)), lib.py_observer_free)
        self._at = self._turns = 0.0  # turns, and turns per cycle, at the last valley

    def start(self, i_ab: tuple[int, int] = (0, 0), theta: int = 0, turns: int = 0, known: bool = False) -> None:
        """Begins at an angle and a speed with the current of this instant, |i| <= 15.9. known: they are true, and it is locked at once;
        otherwise it seeks, from any angle, with a speed of the right sign within 50 %."""
        lib.py_observer_start(self._c, [int(x) for x in i_ab], int(theta), int(turns), known)
        self._at, self._turns = float(to_float(theta)), float(to_float(turns))

    def step(self, u_alpha: ArrayLike, u_beta: ArrayLike, i_mean_alpha: ArrayLike, i_mean_beta: ArrayLike, i_alpha: ArrayLike,
             i_beta: ArrayLike) -> tuple[IQ24, IQ24, IQ24]:
        """(theta, turns, locked) at the end of each cycle, one row a cycle; locked: 0 or 1.

        u: mean voltage that acted in the cycle, |u| <= 2 a component; i_mean: mean current of the cycle; i: current at its end; |i| <= 15.9.
        """
        return over_arrays((u_alpha, u_beta, i_mean_alpha, i_mean_beta, i_alpha, i_beta), 3,
                           lambda n, ins, outs: lib.py_observer_steps(self._c, n, ins, outs))

    def valley(self, before: Means, sample: Sample) -> Sample:
        """A cycle's step at the valley that ends it: the sample with the observed angle and speed in place of the sensor's.

        before: the cycle's means, as `Plant.cycle` returns them: phase voltages and currents.
        """
        i_base, u_base = self.motor.I_base_A, self.motor.u_dc_V
        vectors = [clarke3(*from_float([x / base for x in phases])) for phases, base in
                   ((before.u_V, u_base), (before.i_A, i_base), (sample.i_A, i_base))]
        theta, turns, _ = (to_float(x) for x in self.step(*(x for vector in vectors for x in vector)))
        self._at, self._turns = float(theta), float(turns)
        return self._seen(sample, self._at)

    def peak(self, sample: Sample) -> Sample:
        """The sample at the peak, half a cycle after the last valley, with the observed angle and speed."""
        return self._seen(sample, self._at + 0.5 * self._turns)

    def _seen(self, sample, at):
        return replace(sample, theta_e_rad=math.tau * (at % 1.0), omega_e_rad_s=math.tau * self._turns / self.motor.T_s)

    @property
    def lost(self) -> tuple[str, ...]:
        """Why the lock was lost since the start: `angle`, `flux`, `slow` (iqfoc/observer.h)."""
        status = lib.py_observer_lost(self._c)
        return tuple(word for bit, word in REASONS.items() if status & bit)
