"""The firmware and the plant, whole and step by step."""

import subprocess

import numpy as np
import pytest

import iqfoc


def test_run_is_the_programs(program, root, tmp_path, motor):
    scenario = root / "scenarios" / "jarzebowicz2019_8000rpm.toml"
    subprocess.run([program, "simulate", "--motor", root / "motors" / "jarzebowicz2019.toml", "--scenario", scenario, "--effect",
                    "dead_time:t_dead=1e-6", "--seed", "5", "-o", tmp_path / "p.csv"], check=True, capture_output=True)
    run = iqfoc.Drive(motor, "dead_time:t_dead=1e-6", seed=5).run(scenario)
    run.write(tmp_path / "r.csv")
    rows = [[line for line in (tmp_path / name).read_text().splitlines() if not line.startswith("#")] for name in ("p.csv", "r.csv")]
    assert rows[0] == rows[1]


@pytest.mark.parametrize("feedback", ["midpoint", "corrected_mean", "quasi_discrete_mean"])
def test_steps_are_the_run(motor, feedback):
    """Cycle and Plant, each stepped from here, make the recording of Drive.run, bit for bit."""
    scenario = {"control": {"feedback": feedback}, "log": {"duties": True},
                "run": [{"cycles": 60, "settle_cycles": 20, "speed_rpm": 3000.0, "i_d_A": -1.0, "i_q_A": 8.0}]}
    run = iqfoc.Drive(motor).run(scenario)
    plant, cycle = iqfoc.Drive(motor).plant(), iqfoc.Cycle(motor, feedback=feedback)
    plant.set_speed(3000.0 / 60.0 * 2.0 * 3.141592653589793 * motor.pole_pairs)
    cycle.reference(-1.0, 8.0)
    duties, seen = (0.5, 0.5, 0.5), []
    for _ in range(80):
        # A controller sees the peak before the cycle is over; what the plant does then does not depend on its answer.
        valley, peak, _ = plant.cycle(duties)
        seen.append((*valley.i_A, *duties, *peak.i_A, valley.theta_e_rad))
        cycle.valley(valley)
        duties = cycle.peak(peak).duties
    names = ("i_a_A", "i_b_A", "i_c_A", "d_a", "d_b", "d_c", "i_a_mid_A", "i_b_mid_A", "i_c_mid_A", "theta_e_rad")
    for name, column in zip(names, np.array(seen[20:]).T, strict=True):
        assert (column == run[name]).all(), name
    assert cycle.state["status"] in ("none", "NO_INTERVAL")


def test_cycle_regulates_its_mean(motor):
    means = {}
    for feedback, model in (("midpoint", "quasi_discrete"), ("quasi_discrete_mean", "quasi_discrete"), ("exact_mean", "exact")):
        plant, cycle = iqfoc.Drive(motor).plant(), iqfoc.Cycle(motor, feedback=feedback, model=model)
        plant.set_speed(2500.0)
        cycle.reference(0.0, 10.0)
        duties = (0.5, 0.5, 0.5)
        for _ in range(600):
            valley, peak, mean = plant.cycle(duties)
            cycle.valley(valley)
            duties = cycle.peak(peak).duties
        means[feedback] = abs(complex(*mean.i_dq_A) - 10.0j)
    assert means["quasi_discrete_mean"] < 0.15 * means["midpoint"] and means["exact_mean"] < 0.15 * means["midpoint"]


def test_a_trip_stops_the_drive(motor):
    cycle = iqfoc.Cycle(motor)
    sample = iqfoc.Sample((5 * motor.I_base_A, 0.0, -5 * motor.I_base_A), 0.0, 0.0, motor.u_dc_V, 0.0)
    cycle.valley(sample)
    assert not cycle.peak(iqfoc.Sample((0.0, 0.0, 0.0), 0.0, 0.0, motor.u_dc_V, 1e-4)).gates
    assert cycle.state["tripped"] and "OVERCURRENT" in cycle.state["status"]
    cycle.clear()
    assert not cycle.state["tripped"]


def test_shaft_follows_the_torque(motor):
    plant = iqfoc.Drive(motor).plant(J_kgm2=1e-3, friction_Nms=1e-4)
    plant.set_load(-1.0)
    for _ in range(100):
        plant.cycle((0.5, 0.5, 0.5))
    assert plant.now["omega_e_rad_s"] > 1.0


def test_refusals(motor):
    with pytest.raises(iqfoc.InputError, match="dead_tme"):
        iqfoc.Drive(motor, ["dead_tme"]).run({"run": [{"cycles": 10}]})
    with pytest.raises(iqfoc.InputError, match=r"^scenario:\d+:\d+: .*"):
        iqfoc.Drive(motor).run({"run": [{"cycles": 10, "speed": 3.0}]})
    with pytest.raises(ValueError, match="midpoint"):
        iqfoc.Cycle(motor, feedback="middle")
    with pytest.raises(ValueError, match="exact_mean"):
        iqfoc.Cycle(motor, feedback="exact_mean")
    with pytest.raises(iqfoc.InputError):
        iqfoc.Drive(motor).plant(J_kgm2=1.0, friction_Nms=-1.0)
