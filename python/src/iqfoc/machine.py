"""A machine's one-cycle predictions, in the firmware's arithmetic, over arrays."""

from __future__ import annotations

import os

from numpy.typing import ArrayLike

from ._host import Trouble, ffi, lib, over_arrays
from .functions import IQ24
from .motor import Motor, motor_of

METHODS = ("euler", "quasi_discrete", "exact", "salient", "flux", "flux_map", "quasi_discrete_mean", "exact_mean", "salient_mean")


class Machine:
    """The per-unit constants of a motor file, as the host's port makes them for a firmware, and the predictions by them.

    `k_u`, `k_r`, `k_psi` are the predictor's constants, Q7.24 (docs/units.md).

    >>> machine = iqfoc.Machine("data/motors/jarzebowicz2019.toml")
    >>> numbers = iqfoc.from_float([0.5, 0.0, 0.1, 0.0, 0.0, 0.02])
    >>> iqfoc.to_float(machine.predict(*numbers, method="exact")).round(4).tolist()
    [0.6908, -0.2144]
    """

    def __init__(self, motor: Motor | str | os.PathLike):
        self.motor = motor_of(motor)
        trouble = Trouble()
        self._c = ffi.gc(trouble.check(lib.py_machine_new(self.motor._c, trouble.c)), lib.py_machine_free)
        three = ffi.new("int32_t[3]")
        lib.py_machine_constants(self._c, three)
        self.k_u, self.k_r, self.k_psi = three

    def predict(self, i_alpha: ArrayLike, i_beta: ArrayLike, u_alpha: ArrayLike, u_beta: ArrayLike, theta: ArrayLike, turns: ArrayLike,
                method: str = "quasi_discrete") -> tuple[IQ24, IQ24]:
        """(alpha, beta) of the current a control cycle later, or of its mean over the cycle; all Q7.24, per unit and turns.

        i: at the cycle's start, |i| <= 8; u: the mean voltage that acts in the cycle, <= 2; theta: at its start, turns; turns: speed,
        turns per cycle, held to a third. method: `euler` 2019 (3), `quasi_discrete` 2019 (12), `exact` predictor_exact.h, `salient`
        predictor_salient.h, `flux` flux_predictor.h, `flux_map` flux_map.h (both take the motor file's extensions);
        `quasi_discrete_mean` 2019 (10), `exact_mean`, `salient_mean`: the mean over the cycle. Errors are in those headers: 0.5 to 4 LSB for the motors of data/motors/.
        """
        if method not in METHODS:
            raise ValueError(f"no method {method!r}; there are {', '.join(METHODS)}")
        return over_arrays((i_alpha, i_beta, u_alpha, u_beta, theta, turns), 2,
                           lambda n, ins, outs: lib.py_machine_predict(self._c, method.encode(), n, ins, outs))
