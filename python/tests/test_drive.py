"""The firmware and the plant, whole and step by step."""

import subprocess

import numpy as np
import pytest

import iqfoc


def test_run_is_the_programs(program, root, tmp_path, motor):
    scenario = root / "data" / "scenarios" / "jarzebowicz2019_8000rpm.toml"
    subprocess.run([program, "simulate", "--motor", root / "data" / "motors" / "jarzebowicz2019.toml", "--scenario", scenario, "--effect",
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


def _held(motor, firmware, cycles=1500, i_q_A=5.0):
    """Mean i_q of the last 200 cycles at a reference."""
    plant = iqfoc.Drive(motor).plant()
    plant.set_speed(2500.0)
    firmware.reference(0.0, i_q_A)
    return firmware.run(plant, cycles)["i_q_mean_A"][-200:].mean()


def test_run_is_the_steps(motor):
    """Cycle.run in C and the steps from Python make the same rows, bit for bit, whichever comes first."""
    rows = {}
    for steps_first in (True, False):
        plant, cycle = iqfoc.Drive(motor, seed=3).plant(), iqfoc.Cycle(motor, feedback="quasi_discrete_mean")
        plant.set_speed(1500.0)
        cycle.reference(-1.0, 6.0)
        command, seen = (0.5, 0.5, 0.5), []
        if not steps_first:
            first = cycle.run(plant, 30)
            seen = list(zip(*(first[n] for n in ("i_a_A", "i_b_mid_A", "d_c")), strict=True))
        else:
            for _ in range(30):
                valley, peak, _ = plant.cycle(command)
                cycle.valley(valley)
                seen.append((valley.i_A[0], peak.i_A[1], command.duties[2] if isinstance(command, iqfoc.Command) else command[2]))
                command = cycle.peak(peak)
        last = cycle.run(plant, 30)
        rows[steps_first] = seen + list(zip(*(last[n] for n in ("i_a_A", "i_b_mid_A", "d_c")), strict=True))
    assert rows[True] == rows[False]


@pytest.mark.parametrize("choice", [dict(control="deadbeat", model="exact"), dict(control="deadbeat_observer", model="exact"),
                                    dict(feedback="exact_mean", model="exact"), dict(modulation="over")])
def test_controllers_hold_their_current(motor, choice):
    assert _held(motor, iqfoc.Cycle(motor, **choice)) == pytest.approx(5.0, abs=0.15)


def test_six_step_turns_the_drive(motor):
    """Six-step has one voltage; its current is near the reference only on average over the states."""
    plant, cycle = iqfoc.Drive(motor).plant(), iqfoc.Cycle(motor, modulation="six_step")
    plant.set_speed(2500.0)
    cycle.reference(0.0, 5.0)
    rows = cycle.run(plant, 300)
    duties = np.array([rows[n] for n in ("d_a", "d_b", "d_c")])
    assert set(np.unique(duties[:, 5:])) == {0.0, 1.0}


U_SIX_STEP_V = 540.0  # at 2513 rad/s this link needs six-step (sim_host/loops/six_step_loop.h)


def test_six_step_by_a_timer(motor):
    """The mean of i_q is the reference, states last a sixth of a turn, and steps from here are the run in C, bit for bit."""
    motor = motor.replace(u_dc_V=U_SIX_STEP_V)
    rows = {}
    for steps in (True, False):
        plant, cycle = iqfoc.Drive(motor, seed=2).plant(), iqfoc.Cycle(motor)
        plant.set_speed(2513.0)
        command = cycle.to_timer(plant.sample())
        assert command.interval_s > 0.0 and set(command.duties) <= {0.0, 1.0}
        cycle.reference(0.0, 7.0)
        if steps:
            seen = []
            for _ in range(300):
                start, end, _ = plant.cycle(command)
                seen.append((start.t_s, start.i_A[0], *command.duties))
                command = cycle.peak(end)
            rows[steps] = np.array(seen).T
        else:
            run = cycle.run(plant, 300)
            assert "i_a_mid_A" not in run
            rows[steps] = np.array([run[n] for n in ("t_s", "i_a_A", "d_a", "d_b", "d_c")])
    assert (rows[True] == rows[False]).all()
    last = cycle.run(plant, 2400)
    assert last["i_q_mean_A"][-600:].mean() == pytest.approx(7.0, abs=0.05)
    assert last["duration_s"][-600:].mean() == pytest.approx(2.0 * np.pi / 2513.0 / 6.0, rel=1e-3)
    assert 0.0 < cycle.state["timer_angle_turns"] < 0.5 and cycle.state["status"] == "none"


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_from_pwm_to_the_timer_and_back(motor, sign):
    motor = motor.replace(u_dc_V=U_SIX_STEP_V)
    plant, cycle = iqfoc.Drive(motor).plant(), iqfoc.Cycle(motor, modulation="over")
    plant.set_speed(sign * 2200.0)
    cycle.reference(-2.0, sign * 4.0)
    cycle.run(plant, 1500)
    cycle.to_timer(plant.sample())
    assert sign * cycle.state["timer_angle_turns"] > 0.0
    in_six_step = cycle.run(plant, 3000)
    assert set(np.unique([in_six_step[n] for n in ("d_a", "d_b", "d_c")])) == {0.0, 1.0}
    assert in_six_step["i_q_mean_A"][-600:].mean() == pytest.approx(sign * 4.0, abs=0.1)
    cycle.reference(-4.0, sign * 4.0)
    cycle.to_carrier()
    after = cycle.run(plant, 3000)
    assert cycle.state["timer_angle_turns"] is None
    assert after["i_q_mean_A"][-300:].mean() == pytest.approx(sign * 4.0, abs=0.1)
    assert np.allclose(after["duration_s"] if "duration_s" in after else motor.T_s, motor.T_s)


def test_the_timer_refuses(motor):
    cycle, plant = iqfoc.Cycle(motor), iqfoc.Drive(motor).plant()
    with pytest.raises(iqfoc.InputError, match="does not run by the timer"):
        cycle.to_carrier()
    for choice, words in ((dict(bandwidth_Hz=0.0), "a number > 0"), (dict(bandwidth_Hz=1e6), "expected at most"),
                          (dict(limits_turns=(0.2, 0.1)), "two rising numbers")):
        with pytest.raises(ValueError, match=words):
            cycle.to_timer(plant.sample(), **choice)
    cycle.to_timer(plant.sample())
    with pytest.raises(iqfoc.InputError, match='modulation "over" only'):
        cycle.to_carrier()
    with pytest.raises(ValueError, match="takes PWM cycles"):
        cycle.run(plant, 1, iqfoc.Recorder(motor))


def test_tuned_control_and_its_watch(motor):
    design = iqfoc.tune(motor, drives=1)
    assert _held(motor, design.control()) == pytest.approx(5.0, abs=0.02)
    # The magnet of the drive is weaker than the design's: the change detector reports the flux.
    control = iqfoc.tune(motor, drives=1, tolerance=(0.1, 0.1, 0.02)).control(watched=True, noise_A=0.03)
    plant = iqfoc.Drive(motor.replace(psi_f_Wb=0.9 * motor.psi_f_Wb)).plant()
    plant.set_speed(2500.0)
    control.reference(0.0, 5.0)
    control.run(plant, 6000)
    assert control.state["alarm"] and control.state["group"] == "flux"
    assert iqfoc.Recording(control.run(plant, 100)).rows == 100
    assert str(design).startswith(design.motor.name) and len(design.points) == 17
    with pytest.raises(iqfoc.InputError, match="noise of the current sensors is unknown"):
        design.control(watched=True)
    with pytest.raises(ValueError, match="compare"):
        design.page("nowhere")


def test_tune_is_the_programs(program, root, tmp_path, motor, diagnosis):
    diagnosis_path = tmp_path / "d.json"
    diagnosis_path.write_text(diagnosis.json)
    for arguments, options in (({"drives": 3}, []), ({"drives": 3, "diagnosis": diagnosis}, ["--diagnosis", diagnosis_path])):
        text = subprocess.run([program, "tune", "--motor", root / "data" / "motors" / "jarzebowicz2019.toml", "--drives", "3", *options],
                              check=True, capture_output=True, text=True).stdout
        assert str(iqfoc.tune(motor, **arguments)) == text


@pytest.mark.extra
def test_tune_plot(motor):
    pytest.importorskip("matplotlib")
    margins, step = iqfoc.tune(motor, drives=1).plot().axes
    assert margins.lines[0].get_ydata().min() > 0.49
    assert step.lines[1].get_ydata()[-1] == pytest.approx(step.lines[0].get_ydata()[-1], rel=0.05)


@pytest.mark.parametrize("duties", [(8388608, 8388608, 8388608), (0.5, 0.5, 2), (-1, 0, 0), (float("nan"), 0, 0), (0.5, 0.5), "abc", 0.5, None])
def test_duties_are_shares(motor, duties):
    with pytest.raises(ValueError, match="expected three numbers from 0 to 1, or a Command"):
        iqfoc.Drive(motor).plant().cycle(duties)


def test_a_command_goes_back_into_the_plant(motor):
    """5 A asked are 5 A: by the command, and by its shares; its integers are refused."""
    for taken in (lambda c: c, lambda c: c.duties):
        plant, cycle = iqfoc.Drive(motor).plant(), iqfoc.Cycle(motor)
        cycle.reference(0.0, 5.0)
        duties = (0.5, 0.5, 0.5)
        for _ in range(300):
            valley, peak, mean = plant.cycle(duties)
            cycle.valley(valley)
            command = cycle.peak(peak)
            duties = taken(command)
        assert mean.i_dq_A[1] == pytest.approx(5.0, abs=0.05)
    with pytest.raises(ValueError, match="Command.duties has the shares"):
        plant.cycle(command.duty)


def test_run_refuses(motor):
    cycle, plant = iqfoc.Cycle(motor), iqfoc.Drive(motor).plant()
    cycle.enable(False)
    with pytest.raises(iqfoc.Error, match="not enabled"):
        cycle.run(plant, 10)
    with pytest.raises(ValueError, match="the plant's is"):
        iqfoc.Cycle(motor.replace(f_pwm_Hz=2.0 * motor.f_pwm_Hz)).run(plant, 10)
    with pytest.raises(ValueError, match="expected 0 or more"):
        cycle.run(plant, -1)
    with pytest.raises(ValueError, match="omega_e_rad_s"):
        plant.set_speed(float("nan"))


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
