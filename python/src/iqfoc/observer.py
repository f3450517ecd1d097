"""The observer of rotor angle and speed without a sensor, in the firmware's arithmetic."""

from __future__ import annotations

import os

from numpy.typing import ArrayLike

from ._host import Trouble, ffi, lib, over_arrays
from .functions import IQ24
from .motor import Motor, motor_of

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
    """

    def __init__(self, motor: Motor | str | os.PathLike):
        self.motor = motor_of(motor)
        trouble = Trouble()
        self._c = ffi.gc(trouble.check(lib.py_observer_new(self.motor._c, trouble.c)), lib.py_observer_free)

    def start(self, i_ab: tuple[int, int] = (0, 0), theta: int = 0, turns: int = 0, known: bool = False) -> None:
        """Begins at an angle and a speed with the current of this instant, |i| <= 15.9. known: they are true, and it is locked at once;
        otherwise it seeks, from any angle, with a speed of the right sign within 50 %."""
        lib.py_observer_start(self._c, [int(x) for x in i_ab], int(theta), int(turns), known)

    def step(self, u_alpha: ArrayLike, u_beta: ArrayLike, i_mean_alpha: ArrayLike, i_mean_beta: ArrayLike, i_alpha: ArrayLike,
             i_beta: ArrayLike) -> tuple[IQ24, IQ24, IQ24]:
        """(theta, turns, locked) at the end of each cycle, one row a cycle; locked: 0 or 1.

        u: mean voltage that acted in the cycle, |u| <= 2 a component; i_mean: mean current of the cycle; i: current at its end; |i| <= 15.9.
        """
        return over_arrays((u_alpha, u_beta, i_mean_alpha, i_mean_beta, i_alpha, i_beta), 3,
                           lambda n, ins, outs: lib.py_observer_steps(self._c, n, ins, outs))

    @property
    def lost(self) -> tuple[str, ...]:
        """Why the lock was lost since the start: `angle`, `flux`, `slow` (iqfoc/observer.h)."""
        status = lib.py_observer_lost(self._c)
        return tuple(word for bit, word in REASONS.items() if status & bit)
