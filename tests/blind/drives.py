#!/usr/bin/env python3
"""Mistakes that no column of a good recording can be edited to: another drive, which the project's own plant simulates, and a motor file
that knows nothing of it. Each must get its name, with its value, and no other cause.

mistakes.py and edited.py write theirs into recordings of another plant; these are the rest of what has led a diagnosis astray: registers
that load at the peak, drops of real devices, a filter ahead of the converter, a speed that lags, what warms up, iron that saturates, one axis
that is never excited.

Usage: tests/blind/drives.py [--iqfoc PATH] [-k WORD]
"""

import json
import pathlib
import subprocess
import sys
import tempfile
import tomllib
import typing
import unittest

import edited

ROOT = pathlib.Path(__file__).resolve().parents[2]
MOTOR = ROOT / "motors" / "compressor_salient.toml"
SCENARIO = ROOT / "scenarios" / "identification.toml"


def motor_text(**percent):
    """The motor with so many percent more of some of its values: R_ohm=-15."""
    with open(MOTOR, "rb") as file:
        motor = tomllib.load(file)
    for key, more in percent.items():
        motor["motor"][key] *= 1.0 + 0.01 * more
    lines = [f'name = "{motor["name"]}"']
    for table in ("motor", "inverter"):
        lines += [f"[{table}]"] + [f"{key} = {value!r}" for key, value in motor[table].items()]
    return "\n".join(lines) + "\n"


# Standstill, and current along d alone.
ONE_AXIS = """
name = "one axis"
[sensors]
current_bits = 12
current_full_scale_A = 25
current_noise_A = 0.025
[log]
duties = true
[[run]]
duration_s = 1.2
i_d_A = { value = 3, square = { amplitude = 1.0, period_s = 0.023 } }
"""


class Drive(typing.NamedTuple):
    title: str
    effects: list
    file: dict        # percent by which values of the motor file are off
    named: set
    values: dict = {}  # cause: parameter: (true value, tolerance)
    scenario: str = None
    not_excited: tuple = ()


DRIVES = [
    Drive("registers that load at the peak, R and L off", ["voltage_delay:cycles=0.5"], {"R_ohm": -15, "L_d_H": 8, "L_q_H": 8},
          {"voltage_delay", "resistance", "inductance"}, {"voltage_delay": {"cycles": (0.5, 0.02)}, "resistance": {"R": (0.9, 0.02)}}),
    Drive("dead time, and drops of the devices", ["dead_time:t_dead=2e-6,v_switch=1.2,v_diode=1.2"], {}, {"dead_time"},
          {"dead_time": {"v_dead": (5.72, 0.15)}}),
    Drive("a diode's drop unlike the switch's", ["dead_time:t_dead=2e-6,v_switch=1.8,v_diode=0.9"], {}, {"dead_time"},
          {"dead_time": {"v_dead": (5.87, 0.2)}}),
    Drive("dead time that is compensated twice over", ["dead_time:t_dead=2e-6,compensation=9.04"], {}, {"dead_time"},
          {"dead_time": {"v_dead": (-4.52, 0.06)}}),
    Drive("currents through a filter of 15 us", ["sensor_lag:tau=15e-6"], {}, {"sensor_lag"}, {"sensor_lag": {"tau": (15e-6, 5e-7)}}),
    Drive("a filter of 15 us beside a dead time", ["sensor_lag:tau=15e-6", "dead_time:t_dead=2e-6"], {}, {"sensor_lag", "dead_time"},
          {"sensor_lag": {"tau": (15e-6, 8e-7)}, "dead_time": {"v_dead": (4.52, 0.1)}}),
    Drive("a filter of 15 us beside iron", ["sensor_lag:tau=15e-6", "iron_loss:R_fe=200,tau_fe=1e-4"], {}, {"sensor_lag", "iron_loss"},
          {"sensor_lag": {"tau": (15e-6, 8e-7)}, "iron_loss": {"R_fe": (200.0, 12.0)}}),
    Drive("a filter of 15 us, the voltage a cycle late", ["sensor_lag:tau=15e-6", "voltage_delay:cycles=1"], {},
          {"sensor_lag", "voltage_delay"}, {"sensor_lag": {"tau": (15e-6, 8e-7)}, "voltage_delay": {"cycles": (1.0, 0.0)}}),
    Drive("samples 5 us late", ["sensor_lag:tau=-5e-6"], {}, {"angle_delay"}),
    Drive("a speed that is filtered", ["speed_lag:tau=0.01"], {}, {"speed_lag"}, {"speed_lag": {"tau": (0.01, 4e-4)}}),
    Drive("inductance of one phase", ["phase_inductance:dL_a=5e-4"], {}, {"phase_inductance"},
          {"phase_inductance": {"dL_a": (5e-4, 5e-5)}}),
    Drive("updates that are missed", ["missed_update:share=0.01"], {}, {"missed_update"}, {"missed_update": {"share": (0.01, 3e-3)}}),
    Drive("what warms up, logged", ["temperature:alpha_R=0.0039,alpha_psi=-0.0011,heating=60,tau=1.5,reference=39"], {}, {"temperature"},
          {"temperature": {"alpha_R": (0.0039, 4e-4), "alpha_psi": (-0.0011, 1e-4)}}),
    Drive("a link that swings", ["dc_link_ripple:frequency=300,share=0.02"], {}, {"dc_link_ripple"},
          {"dc_link_ripple": {"frequency": (300.0, 0.3), "share": (0.02, 6e-4)}}),
    Drive("a loose contact", ["sensor_fault:phase=2,probability=0.002"], {}, {"sensor_fault"}, {"sensor_fault": {"phase": (2, 0)}}),
    Drive("saturation of a salient machine", ["saturation:L_0=0.0095,I_sat=20"], {}, {"saturation"},
          {"saturation": {"I_sat": (20.0, 0.5)}}),
    Drive("a flux map", ["saturation_dq:w_dqq=-2e-5,w_qqqq=-1.5e-6"], {}, {"saturation_dq"}),
    Drive("current along d alone", [], {}, set(), {}, ONE_AXIS, ("L_q", "psi_f")),
    Drive("current along d alone, both inductances off", [], {"L_d_H": 10, "L_q_H": 10}, {"inductance"}, {}, ONE_AXIS, ("L_q", "psi_f")),
]


class Drives(unittest.TestCase):
    def diagnose(self, drive, folder):
        (folder / "motor.toml").write_text(motor_text(**drive.file), encoding="utf-8")
        scenario = SCENARIO
        if drive.scenario:
            scenario = folder / "scenario.toml"
            scenario.write_text(drive.scenario, encoding="utf-8")
        more = [word for effect in drive.effects for word in ("--effect", effect)]
        for command in (["simulate", "--motor", str(MOTOR), "--scenario", str(scenario), "-o", "rec.csv", "--seed", "11", *more],
                        ["diagnose", "rec.csv", "--motor", "motor.toml", "--json", "out.json"]):
            done = subprocess.run([str(edited.IQFOC), *command], cwd=folder, check=False, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads((folder / "out.json").read_text(encoding="utf-8"))

    def test_each_gets_its_name(self):
        for drive in DRIVES:
            with self.subTest(drive.title), tempfile.TemporaryDirectory() as name:
                result = self.diagnose(drive, pathlib.Path(name))
                found = {cause["id"]: {p["name"]: p["value"] for p in cause["parameters"]} for cause in result["causes"]}
                self.assertEqual(set(found), drive.named)
                self.assertEqual(result["verdict"], "explained" if drive.named else "clean")
                self.assertEqual([e["name"] for e in result["estimates"] if not e["excited"] and e["name"] in drive.not_excited],
                                 list(drive.not_excited))
                for cause, parameters in drive.values.items():
                    for parameter, (value, tolerance) in parameters.items():
                        self.assertLessEqual(abs(found[cause][parameter] - value), tolerance, f"{cause} {parameter}")


if __name__ == "__main__":
    if "--iqfoc" in sys.argv:
        at = sys.argv.index("--iqfoc")
        edited.IQFOC = pathlib.Path(sys.argv[at + 1]).resolve()
        del sys.argv[at:at + 2]
    unittest.main(argv=sys.argv, verbosity=1)
