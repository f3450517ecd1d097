"""The library's functions over numpy arrays: the very C, called once for each element, so that the bits are the firmware's.

Numbers are IQ24 (Q7.24): int32 that stand for integer / 2^24, from -128 to 128 - 2^-24; `from_float` and `to_float` convert.
Currents are per unit of the peak rated current, voltages of the nominal DC link, angles in turns, speeds in turns per control cycle
(docs/units.md). Arguments broadcast; results have their common shape. 1 LSB is 2^-24. Errors and ranges are those that the headers in
include/iqfoc state, where tests enforce them; outside its range a result wraps.
"""

from __future__ import annotations

import threading

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._host import Error, each, ffi, iq24_array, lib

__all__ = ["IQ24", "ONE", "TURNS_MAX", "atan2", "clarke2", "clarke3", "clarke_inverse", "div", "from_float", "golden", "mean_correct",
           "mean_correct_steady", "modulate", "modulate_nearest", "modulated_voltage", "mul", "park", "park_inverse", "rotor", "sincos",
           "six_step_state", "six_step_voltage", "sqrt", "steady_gain", "to_float"]

IQ24 = NDArray[np.int32]

_ONE_AT_A_TIME = threading.Lock()

ONE = 1 << 24
"""1.0 in Q7.24."""

TURNS_MAX = 5592405
"""The largest speed, Q7.24 turns per control cycle: a third of a turn. A larger one is taken as this one."""


def from_float(x: ArrayLike) -> IQ24:
    """x to the nearest Q7.24 (ties to even), held to its ends. Not-a-number is refused.

    >>> iqfoc.from_float([0.5, -1.0]).tolist()
    [8388608, -16777216]
    """
    a = np.array(x, np.float64, order="C")
    if np.isnan(a).any():
        raise ValueError("not-a-number has no Q7.24")
    result = np.empty(a.shape, np.int32)
    lib.py_from_float(a.size, ffi.cast("double *", a.ctypes.data), ffi.cast("int32_t *", result.ctypes.data))
    return result[()]


def to_float(iq: ArrayLike) -> NDArray[np.float64]:
    """Q7.24 as float64, exactly.

    >>> float(iqfoc.to_float(8388608))
    0.5
    """
    return iq24_array(iq) / float(ONE)


def mul(a: ArrayLike, b: ArrayLike) -> IQ24:
    """a b to nearest, ties up, saturated. Error 0.5 LSB.

    >>> float(iqfoc.to_float(iqfoc.functions.mul(*iqfoc.from_float([0.5, 0.25]))))
    0.125
    """
    return each("mul", a, b)


def div(a: ArrayLike, b: ArrayLike) -> IQ24:
    """a / b to nearest, saturated; a / 0 saturates by the sign of a, 0 / 0 is 0. Error 0.5 LSB.

    >>> float(iqfoc.to_float(iqfoc.functions.div(*iqfoc.from_float([0.5, 0.25]))))
    2.0
    """
    return each("div", a, b)


def sqrt(x: ArrayLike) -> IQ24:
    """Square root, 0 for x <= 0. Error 0.63 LSB.

    >>> float(iqfoc.to_float(iqfoc.functions.sqrt(iqfoc.from_float(0.25))))
    0.5
    """
    return each("sqrt", x)


def atan2(y: ArrayLike, x: ArrayLike) -> IQ24:
    """Angle of the vector (x, y) in turns, -0.5 to below 0.5. Error 0.64 LSB.

    >>> float(iqfoc.to_float(iqfoc.functions.atan2(*iqfoc.from_float([0.5, 0.0]))))
    0.25
    """
    return each("atan2", y, x)


def sincos(turns: ArrayLike) -> tuple[IQ24, IQ24]:
    """Sine and cosine of an angle in turns; whole turns drop out. Error 0.51 LSB.

    >>> iqfoc.to_float(iqfoc.functions.sincos(iqfoc.from_float(0.25))).tolist()
    [1.0, 0.0]
    """
    return each("sincos", turns)


def clarke2(a: ArrayLike, b: ArrayLike) -> tuple[IQ24, IQ24]:
    """(alpha, beta) of two phase values of a floating star point; amplitude invariant. |a|, |b| <= 32 per unit; 0.7 LSB.

    >>> iqfoc.to_float(iqfoc.functions.clarke2(*iqfoc.from_float([1.0, -0.5]))).tolist()
    [1.0, 0.0]
    """
    return each("clarke2", a, b)


def clarke3(a: ArrayLike, b: ArrayLike, c: ArrayLike) -> tuple[IQ24, IQ24]:
    """(alpha, beta) of three phase values; what they have in common is dropped. Each <= 31.9 per unit; 0.7 LSB.

    >>> iqfoc.to_float(iqfoc.functions.clarke3(*iqfoc.from_float([1.0, -0.5, -0.5]))).tolist()
    [1.0, 0.0]
    """
    return each("clarke3", a, b, c)


def clarke_inverse(alpha: ArrayLike, beta: ArrayLike) -> tuple[IQ24, IQ24, IQ24]:
    """(a, b, c) of a vector; their sum is exactly 0. Each <= 64 per unit; 1.2 LSB.

    >>> iqfoc.to_float(iqfoc.functions.clarke_inverse(*iqfoc.from_float([1.0, 0.0]))).tolist()
    [1.0, -0.5, -0.5]
    """
    return each("clarke_inverse", alpha, beta)


def park(alpha: ArrayLike, beta: ArrayLike, theta: ArrayLike) -> tuple[IQ24, IQ24]:
    """(d, q) of a stationary vector; theta: electrical angle in turns. Each <= 64 per unit; 0.5 LSB with the sine as given.

    >>> iqfoc.to_float(iqfoc.functions.park(*iqfoc.from_float([0.0, 1.0, 0.25]))).tolist()
    [1.0, 0.0]
    """
    return each("park", alpha, beta, theta)


def park_inverse(d: ArrayLike, q: ArrayLike, theta: ArrayLike) -> tuple[IQ24, IQ24]:
    """(alpha, beta) of a rotor-frame vector; theta: electrical angle in turns. Ranges and error as `park`.

    >>> iqfoc.to_float(iqfoc.functions.park_inverse(*iqfoc.from_float([1.0, 0.0, 0.25]))).tolist()
    [0.0, 1.0]
    """
    return each("park_inverse", d, q, theta)


def rotor(turns: ArrayLike) -> tuple[IQ24, IQ24, IQ24, IQ24, IQ24, IQ24]:
    """(turns, phi, s1, s2, phi s1, phi s2) of a speed in turns per cycle, held to +-TURNS_MAX.

    phi = 2 pi turns in rad, s1 = sin(phi/2)/(phi/2), s2 = (2 sin(phi/2) - phi cos(phi/2))/phi^2. Error 0.6 LSB.

    >>> iqfoc.to_float(iqfoc.functions.rotor(iqfoc.from_float(0.1))).round(6).tolist()
    [0.1, 0.628319, 0.983632, 0.051845, 0.618034, 0.032575]
    """
    return each("rotor", turns)


def steady_gain(turns: ArrayLike) -> IQ24:
    """2016 (9): s1 + 2 tan(phi/2) s2, what a mean is multiplied by in steady state. 1 to 1.3677; 0.8 LSB.

    >>> round(float(iqfoc.to_float(iqfoc.functions.steady_gain(iqfoc.from_float(0.1)))), 6)
    1.017323
    """
    return each("steady_gain", turns)


def mean_correct(i_alpha: ArrayLike, i_beta: ArrayLike, delta_alpha: ArrayLike, delta_beta: ArrayLike, theta_mid: ArrayLike,
                 turns: ArrayLike) -> tuple[IQ24, IQ24]:
    """2016 (10): the mean (d, q) current of a cycle from the mean phase currents.

    i: mean of the stationary current over the cycle, delta: its change over it, per unit, each <= 48; theta_mid: angle at the middle,
    turns; turns: speed, turns per cycle. Exact for currents that change linearly; 1.3 LSB.

    >>> iqfoc.to_float(iqfoc.functions.mean_correct(*iqfoc.from_float([0.5, 0.0, 0.1, 0.0, 0.0, 0.1]))).round(6).tolist()
    [0.491816, -0.005184]
    """
    return each("mean_correct", i_alpha, i_beta, delta_alpha, delta_beta, theta_mid, turns)


def mean_correct_steady(i_alpha: ArrayLike, i_beta: ArrayLike, theta_mid: ArrayLike, turns: ArrayLike) -> tuple[IQ24, IQ24]:
    """2016 (9): the same in steady state, from the mean alone. Each <= 32 per unit; 1.3 LSB.

    >>> iqfoc.to_float(iqfoc.functions.mean_correct_steady(*iqfoc.from_float([0.5, 0.0, 0.0, 0.1]))).round(6).tolist()
    [0.508661, 0.0]
    """
    return each("mean_correct_steady", i_alpha, i_beta, theta_mid, turns)


def modulate(u_alpha: ArrayLike, u_beta: ArrayLike, u_dc_inverse: ArrayLike = ONE,
             span_max: ArrayLike = ONE) -> tuple[IQ24, IQ24, IQ24, IQ24]:
    """(duty a, b, c, scale) of a voltage, by min/max zero sequence.

    u: per unit, |u| <= 32; u_dc_inverse: 1/u_dc per unit, above 0 to 2; span_max: largest difference of two duties, above 0 to 1. Duties
    are 0 to 1; scale is 1, or what a voltage beyond the hexagon was shortened by. 3 LSB within the hexagon.

    >>> iqfoc.to_float(iqfoc.functions.modulate(*iqfoc.from_float([0.25, 0.0]))).round(6).tolist()
    [0.6875, 0.3125, 0.3125, 1.0]
    """
    _within("u_dc_inverse", u_dc_inverse, 1, 2 * ONE)
    _within("span_max", span_max, 1, ONE)
    return each("modulate", u_alpha, u_beta, u_dc_inverse, span_max)


def modulate_nearest(u_alpha: ArrayLike, u_beta: ArrayLike, u_dc_inverse: ArrayLike = ONE) -> tuple[IQ24, IQ24, IQ24, IQ24]:
    """The same, but a voltage beyond the hexagon goes to its nearest point.

    >>> iqfoc.to_float(iqfoc.functions.modulate_nearest(*iqfoc.from_float([0.25, 0.0]))).round(6).tolist()
    [0.6875, 0.3125, 0.3125, 1.0]
    """
    _within("u_dc_inverse", u_dc_inverse, 1, 2 * ONE)
    return each("modulate_nearest", u_alpha, u_beta, u_dc_inverse)


def modulated_voltage(duty_a: ArrayLike, duty_b: ArrayLike, duty_c: ArrayLike, u_dc: ArrayLike = ONE) -> tuple[IQ24, IQ24]:
    """(alpha, beta) of the mean voltage that duties of 0 to 1 make of u_dc, 0 to 2 per unit. 1.9 LSB.

    >>> iqfoc.to_float(iqfoc.functions.modulated_voltage(*iqfoc.from_float([0.75, 0.25, 0.25]))).round(6).tolist()
    [0.333333, 0.0]
    """
    return each("modulated_voltage", duty_a, duty_b, duty_c, u_dc)


def six_step_state(angle: ArrayLike) -> IQ24:
    """The active inverter state, 0 to 5, nearest to a voltage's angle in turns. A plain integer; exact.

    >>> int(iqfoc.functions.six_step_state(iqfoc.from_float(1 / 6)))
    1
    """
    return each("six_step_state", angle)


def six_step_voltage(state: ArrayLike, u_dc: ArrayLike = ONE) -> tuple[IQ24, IQ24]:
    """(alpha, beta) of an inverter state 0 to 5, 0 of another; u_dc per unit, <= 64. 0.7 LSB.

    >>> iqfoc.to_float(iqfoc.functions.six_step_voltage(0)).round(6).tolist()
    [0.666667, 0.0]
    """
    return each("six_step_voltage", state, u_dc)


def golden() -> str:
    """The hash over all golden vectors: every function of the library and every configuration of its cycle over 100,000 inputs each, as
    `iqfoc golden` prints it. Raises Error where it is not the one of this version. Takes a second or two.

    >>> len(iqfoc.golden())
    16
    """
    expected = ffi.new("uint64_t *")
    with _ONE_AT_A_TIME:
        found = lib.py_golden(expected)
    if found != expected[0]:
        raise Error(f"golden: {found:016x}, expected {expected[0]:016x}: this build of the library computes something else")
    return f"{found:016x}"


def __dir__():
    return __all__


def _within(name, x, low, high):
    a = iq24_array(x)
    if a.size and (a.min() < low or a.max() > high):
        raise ValueError(f"{name} is outside {low / ONE:.9g} ... {high / ONE:.9g} (Q7.24: {low} ... {high})")
