"""The modulator of optimal pulse patterns, in the firmware's arithmetic, with a table as `iqfoc patterns` computes it."""

from __future__ import annotations

import math
import os
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._host import Trouble, _pointers, ffi, iq24_array, lib
from .cycle import _run_columns
from .functions import IQ24
from .motor import Motor, motor_of

if TYPE_CHECKING:
    from .drive import Plant

EDGES_MAX = 16


class Edges(NamedTuple):
    """Each leg in each cycle: arrays with the shape of the arguments, then the legs a, b, c.

    level: at the start, 1 or -1. edges: their number; each changes the level. at: their times, 16 places, Q7.24 cycles from the start, 0
    in unused places. high: share of the cycle that the leg is high, Q7.24.

    >>> pattern = iqfoc.Pattern("data/motors/jarzebowicz2019.toml", pulses=5)
    >>> pattern.step(0, iqfoc.from_float(0.1), iqfoc.from_float(0.8)).at.shape
    (3, 16)
    """

    level: NDArray[np.int32]
    edges: NDArray[np.int32]
    at: IQ24
    high: IQ24


class Pattern:
    """The modulator of `iqfoc/pattern.h` for a motor file, with the pattern of least current distortion for so many pulses a turn.

    pulses: of a leg in an electrical turn, 3 to 15, odd. on_time_s and dead_time_s: the least time between two edges of a leg is their sum.

    >>> motor = iqfoc.Motor("data/motors/jarzebowicz2019.toml")
    >>> plant, pattern = iqfoc.Drive(motor).plant(), iqfoc.Pattern(motor, pulses=7)
    >>> plant.set_speed(2000.0)
    >>> rows = pattern.run(plant, 2000, index=0.72, ahead_turns=0.27)
    >>> round(float(rows["i_q_mean_A"][-500:].mean()))
    5
    """

    def __init__(self, motor: Motor | str | os.PathLike, pulses: int = 7, on_time_s: float = 0.0, dead_time_s: float = 0.0):
        if pulses not in range(3, 16, 2):
            raise ValueError(f"pulses = {pulses}; expected an odd number from 3 to 15")
        for name, x in (("on_time_s", on_time_s), ("dead_time_s", dead_time_s)):
            if not 0.0 <= x <= 1e-3:
                raise ValueError(f"{name} = {x}; expected 0 to 0.001")
        self.motor = motor_of(motor)
        trouble = Trouble()
        self._c = ffi.gc(trouble.check(lib.py_pattern_new(self.motor._c, pulses, on_time_s, dead_time_s, trouble.c)), lib.py_pattern_free)
        low, high = ffi.new("double *"), ffi.new("double *")
        lib.py_pattern_range(self._c, low, high)
        self.index_range: tuple[float, float] = (low[0], high[0])

    def clear(self) -> None:
        """All legs low, without a recent edge."""
        lib.py_pattern_clear(self._c)

    def step(self, angle: ArrayLike, turns: ArrayLike, index: ArrayLike) -> Edges:
        """The edges of each cycle, one row a cycle: angle of the voltage's fundamental at its start, its movement in the cycle (turns, at
        most 1/8), and the modulation index (the fundamental over that of six-step); Q7.24."""
        whole = np.broadcast_arrays(*[iq24_array(x) for x in (angle, turns, index)])
        ins, shape = [np.ascontiguousarray(a).reshape(-1) for a in whole], whole[0].shape
        n = ins[0].size
        level, edges, high = (np.empty((n, 3), np.int32) for _ in range(3))
        at = np.empty((n, 3, EDGES_MAX), np.int32)
        lib.py_pattern_steps(self._c, n, _pointers(ins, "int32_t"), *_pointers((level, edges, at, high), "int32_t"))
        return Edges(level.reshape(*shape, 3), edges.reshape(*shape, 3), at.reshape(*shape, 3, EDGES_MAX), high.reshape(*shape, 3))

    def run(self, plant: Plant, cycles: int, index: float, ahead_turns: float) -> dict[str, NDArray[np.float64]]:
        """So many control cycles on a plant, in C, without a controller: a voltage of this index, its angle so far ahead of the d axis.
        Columns as of Cycle.run; the speed is at most 1/8 turn a cycle."""
        if cycles < 0:
            raise ValueError(f"cycles = {cycles}; expected 0 or more")
        if not 0.0 <= index <= 1.0 or not math.isfinite(ahead_turns):
            raise ValueError(f"index = {index}, ahead_turns = {ahead_turns}; expected 0 to 1, and a number")
        columns = {name: np.empty(cycles) for name in _run_columns()}
        lib.py_pattern_run(self._c, plant._c, index, ahead_turns, cycles, _pointers(columns.values(), "double"))
        return {n: c for n, c in columns.items() if not n.endswith("_mid_A")}
