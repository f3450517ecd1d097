"""motulator (pip install iqfoc[motulator]): the library's cycle on motulator's plant, and motulator's controllers on ours.

`Firmware(cycle, i_d_A, i_q_A)` is a control system for motulator.drive.model.Simulation; `drive_plant(control, plant, cycles)` lets one of
motulator's control systems drive a `Plant`; `machine_parameters(motor)` is a motor file in motulator's words.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from types import SimpleNamespace

import numpy as np

from .cycle import Cycle, Sample
from .drive import Plant
from .motor import Motor


def machine_parameters(motor: Motor):
    """motulator.drive.utils.SynchronousMachinePars of a motor file; its extensions are not taken over."""
    from motulator.drive.utils import SynchronousMachinePars

    return SynchronousMachinePars(n_p=motor.pole_pairs, R_s=motor.R_ohm, L_d=motor.L_d_H, L_q=motor.L_q_H, psi_f=motor.psi_f_Wb)


class Firmware:
    """The library's control cycle as a control system of motulator.

    motulator calls it for each half of the carrier period, with its model's default delay of one call; its model's `pwm` must be a new
    CarrierComparison, so that the first half rises. Each even call is the carrier's valley, each odd one its peak. The command of a peak
    then acts in both halves that follow the next valley, as on a target. i_d_A, i_q_A: references, peak A, as functions of the time in s.
    `data` has an array for each of t, i_d_A, i_q_A (the mean or sample that the controller is fed with) and status.
    """

    def __init__(self, cycle: Cycle, i_d_A: Callable[[float], float], i_q_A: Callable[[float], float]):
        self.cycle, self._i_d_A, self._i_q_A = cycle, i_d_A, i_q_A
        self._at_peak, self._duties, self._rows = False, (0.5, 0.5, 0.5), []
        self.data = SimpleNamespace()

    def __call__(self, mdl) -> tuple[float, list[float]]:
        """(half the carrier period, duty ratios for the half after the coming one)."""
        sample = _sample_of(mdl, self.cycle.motor.pole_pairs)
        if self._at_peak:
            command = self.cycle.peak(sample)
            if not command.gates:
                raise RuntimeError(f"the firmware stopped the drive at {mdl.t0:.6f} s: {self.cycle.state['status']}")
            self._duties = command.duties
            state = self.cycle.state
            base_A = self.cycle.motor.I_base_A / 2 ** 24
            self._rows.append((mdl.t0, state["i_dq"][0] * base_A, state["i_dq"][1] * base_A, state["status"]))
        else:
            self.cycle.reference(self._i_d_A(mdl.t0), self._i_q_A(mdl.t0))
            self.cycle.valley(sample)
        self._at_peak = not self._at_peak
        return 0.5 * self.cycle.motor.T_s, list(self._duties)

    def post_process(self) -> None:
        """motulator calls it at the end of a simulation."""
        columns = list(zip(*self._rows, strict=True)) or [()] * 4
        for name, values in zip(("t", "i_d_A", "i_q_A", "status"), columns, strict=True):
            setattr(self.data, name, np.array(values))


def _sample_of(mdl, pole_pairs):
    return Sample(tuple(float(x) for x in mdl.machine.meas_currents()), pole_pairs * float(mdl.mechanics.meas_position()),
                  pole_pairs * float(mdl.mechanics.meas_speed()), float(mdl.converter.meas_dc_voltage()), float(mdl.t0))


def drive_plant(control, plant: Plant, cycles: int, delay: int = 1) -> dict[str, np.ndarray]:
    """Lets a control system of motulator drive a plant for so many control cycles.

    control: its sampling period must be the plant's carrier period; it is called at each valley, and what it asks for acts `delay` cycles
    later. A column of one number a cycle for each of t_s, i_d_A, i_q_A (the true mean over the cycle, seen from the rotor),
    omega_e_rad_s, d_a, d_b, d_c (in force in the cycle).
    """
    motor = plant.motor
    if not math.isclose(control.T_s, motor.T_s, rel_tol=1e-9):
        raise ValueError(f"the control system samples every {control.T_s:g} s, the drive's carrier has {motor.T_s:g} s")
    if delay < 1:
        raise ValueError(f"delay = {delay}; expected a cycle at least: what a valley's sample is answered by cannot act in its own cycle")
    pending, rows = [(0.5, 0.5, 0.5)] * delay, []
    for _ in range(cycles):
        duties = pending.pop(0)
        valley, _, means = plant.cycle(duties)
        _, asked = control(_Measured(valley, motor.pole_pairs))
        pending.append(tuple(float(d) for d in asked))
        rows.append((valley.t_s, *means.i_dq_A, valley.omega_e_rad_s, *duties))
    if hasattr(control, "post_process"):
        control.post_process()
    return dict(zip(("t_s", "i_d_A", "i_q_A", "omega_e_rad_s", "d_a", "d_b", "d_c"), np.array(rows).T, strict=True))


class _Measured:
    """What motulator's control systems ask of a model: measurements at a valley of our plant."""

    def __init__(self, sample, pole_pairs):
        self.t0 = sample.t_s
        self.converter = SimpleNamespace(meas_dc_voltage=lambda: sample.u_dc_V)
        self.machine = SimpleNamespace(meas_currents=lambda: np.array(sample.i_A))
        self.mechanics = SimpleNamespace(meas_speed=lambda: sample.omega_e_rad_s / pole_pairs,
                                         meas_position=lambda: sample.theta_e_rad / pole_pairs)
