"""The plant: the switching-level drive, under the firmware's code or under a controller of one's own."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ._host import Trouble, ffi, lib, path_bytes, strings, text
from .cycle import Command, Sample
from .motor import Motor, motor_of, text_file, toml_value
from .recording import Recording


class Drive:
    """A drive of a motor file, made to differ from it by effects, as `iqfoc simulate --effect` has them: "dead_time:t_dead=2e-6".

    seed: of the sensors' noise and of random effects.

    >>> drive = iqfoc.Drive("data/motors/jarzebowicz2019.toml", ["dead_time:t_dead=1e-6"])
    >>> recording = drive.run({"run": [{"cycles": 100, "speed_rpm": 3000.0, "i_q_A": 8.0}]})
    >>> recording.rows
    100
    """

    def __init__(self, motor: Motor | str | os.PathLike, effects: Sequence[str] = (), seed: int = 1):
        self.motor = motor_of(motor)
        self.effects = (effects,) if isinstance(effects, str) else tuple(effects)
        self.seed = seed

    def run(self, scenario: str | os.PathLike | Mapping) -> Recording:
        """The firmware's code against this drive, closed loop: what its sensors and its controller saw, as `iqfoc simulate` writes it.

        scenario (docs/scenario.md): a file, or a mapping of its tables. Notes of the firmware's status are in the recording's `notes`.
        """
        if isinstance(scenario, Mapping):
            with text_file("".join(f"{k} = {toml_value(v)}\n" for k, v in scenario.items())) as path:
                return self._run(path, [(path, "scenario")])
        return self._run(scenario, [])

    def _run(self, path, replace):
        trouble = Trouble(replace)
        effects, kept = strings(self.effects)
        notes = ffi.new("char[]", 4096)
        handle = trouble.check(lib.py_recording_simulate(self.motor._c, path_bytes(path), len(self.effects), effects, self.seed, notes, 4096,
                                                         trouble.c))
        del kept
        recording = Recording._from_handle(handle, "simulation")
        recording.notes = text(notes).splitlines()
        return recording

    def plant(self, J_kgm2: float = 0.0, friction_Nms: float = 0.0) -> Plant:
        """The drive for your own controller. J_kgm2: inertia of the shaft; 0: the shaft follows the prescribed speed."""
        return Plant(self, J_kgm2, friction_Nms)


@dataclass(frozen=True)
class Means:
    """True means over a cycle: phase currents, the current seen from the rotor, phase voltages at the machine's terminals.

    >>> plant = iqfoc.Drive("data/motors/jarzebowicz2019.toml").plant()
    >>> valley, peak, mean = plant.cycle((0.6, 0.5, 0.5))
    >>> mean.i_A[0] > 0.0
    True
    """

    duration_s: float
    i_A: tuple[float, float, float]
    i_dq_A: tuple[float, float]
    u_V: tuple[float, float, float]


class Plant:
    """A drive cycle by cycle: `cycle(duties)` lets one PWM period pass. Currents start at zero; sensors are ideal but for effects.

    `Cycle.run(plant, n)` and `TunedControl.run(plant, n)` let n of them pass under the firmware's code.

    >>> drive = iqfoc.Drive("data/motors/jarzebowicz2019.toml")
    >>> plant, cycle = drive.plant(), iqfoc.Cycle(drive.motor)
    >>> cycle.reference(0.0, 5.0)
    >>> command = (0.5, 0.5, 0.5)
    >>> for _ in range(300):
    ...     valley, peak, mean = plant.cycle(command)
    ...     cycle.valley(valley)
    ...     command = cycle.peak(peak)
    >>> round(mean.i_dq_A[1], 1)
    5.0
    """

    def __init__(self, drive: Drive, J_kgm2: float = 0.0, friction_Nms: float = 0.0):
        trouble = Trouble()
        effects, kept = strings(drive.effects)
        self.motor = drive.motor
        self._c = ffi.gc(trouble.check(lib.py_plant_new(drive.motor._c, len(drive.effects), effects, drive.seed, J_kgm2, friction_Nms,
                                                        trouble.c)), lib.py_plant_free)
        del kept
        self._valley, self._peak = ffi.new("py_reading *"), ffi.new("py_reading *")
        self._means, self._now = ffi.new("py_means *"), ffi.new("py_now *")

    def set_speed(self, omega_e_rad_s: float, accel_e_rad_s2: float = 0.0) -> None:
        """Electrical speed from now on and its slope, for a shaft with prescribed speed."""
        lib.py_plant_set_speed(self._c, _finite("omega_e_rad_s", omega_e_rad_s), _finite("accel_e_rad_s2", accel_e_rad_s2))

    def set_load(self, T_load_Nm: float) -> None:
        """Load torque, against positive rotation; of a shaft with inertia."""
        lib.py_plant_set_load(self._c, _finite("T_load_Nm", T_load_Nm))

    def sample(self) -> Sample:
        """What the sensors deliver between two cycles; noise is drawn each time."""
        lib.py_plant_sample(self._c, self._valley)
        return _sample(self._valley)

    def cycle(self, duties: Command | Sequence[float]) -> tuple[Sample, Sample, Means]:
        """Duties of the high sides, 0 to 1, or a Command, from this valley to the next: (sample at the valley, at the peak, true means).

        A Command of six-step by a timer is a state for its `interval_s`: (sample at its start, at its end with `i_mean_A`, true means).

        >>> plant = iqfoc.Drive(iqfoc.Motor("data/motors/jarzebowicz2019.toml")).plant()
        >>> valley, peak, mean = plant.cycle((0.5, 0.5, 0.5))
        >>> plant.cycle((0.5, 0.5, 2))
        Traceback (most recent call last):
        ValueError: duties (0.5, 0.5, 2): expected three numbers from 0 to 1, or a Command
        """
        numbers, m = ffi.new("double[3]", _duties(duties)), self._means
        if isinstance(duties, Command) and duties.interval_s > 0.0:
            lib.py_plant_interval(self._c, numbers, duties.interval_s, self._valley, self._peak, m)
            end = _sample(self._peak, tuple(m.i_A))
        else:
            lib.py_plant_cycle(self._c, numbers, self._valley, self._peak, m)
            end = _sample(self._peak)
        return _sample(self._valley), end, Means(m.duration_s, tuple(m.i_A), tuple(m.i_dq_A), tuple(m.u_V))

    @property
    def now(self) -> dict:
        """The truth at the end of the last cycle: t_s, theta_e_rad, omega_e_rad_s, i_A, i_dq_A, torque_Nm."""
        lib.py_plant_state(self._c, self._now)
        n = self._now
        return {"t_s": n.t_s, "theta_e_rad": n.theta_e_rad, "omega_e_rad_s": n.omega_e_rad_s, "i_A": tuple(n.i_A), "i_dq_A": tuple(n.i_dq_A),
                "torque_Nm": n.torque_Nm}


def _duties(x):
    shares = x.duties if isinstance(x, Command) else x
    try:
        numbers = [float(d) for d in shares]
    except (TypeError, ValueError):
        numbers = []
    if len(numbers) != 3 or not all(0.0 <= d <= 1.0 for d in numbers):
        hint = "; these look like Q7.24: Command.duties has the shares" if any(abs(d) >= 65536.0 for d in numbers) else ""
        raise ValueError(f"duties {shares}: expected three numbers from 0 to 1, or a Command{hint}")
    return numbers


def _finite(name, x):
    if not math.isfinite(x):
        raise ValueError(f"{name} = {x}; expected a finite number")
    return x


def _sample(r, i_mean_A=None):
    return Sample(tuple(r.i_A), r.theta_e_rad, r.omega_e_rad_s, r.u_dc_V, r.t_s, i_mean_A)
