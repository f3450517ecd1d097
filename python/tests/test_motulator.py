"""The library's cycle on motulator's plant, and motulator's controller on ours."""

import importlib.util
import re

import numpy as np
import pytest

import iqfoc

pytest.importorskip("motulator")

from motulator.drive import model
from motulator.drive.control.sm import CurrentReferenceCfg, CurrentVectorControl

from iqfoc.motulator import Firmware, drive_plant, machine_parameters

pytestmark = pytest.mark.extra

RPM = 3000.0


def their_plant(motor):
    w_M = 2.0 * np.pi * RPM / 60.0
    mdl = model.Drive(model.VoltageSourceConverter(motor.u_dc_V), model.SynchronousMachine(machine_parameters(motor)),
                      model.ExternalRotorSpeed(lambda t: w_M + 0.0 * t))
    mdl.pwm = model.CarrierComparison(N=2 ** 20)
    return mdl


@pytest.mark.parametrize("feedback", ["midpoint", "quasi_discrete_mean"])
def test_both_plants_under_the_firmware_agree(motor, feedback):
    """Two plants that share no line: the same firmware, the same samples at each peak, to what motulator's solver is good for."""
    cycles = 40
    mdl, firmware = their_plant(motor), Firmware(iqfoc.Cycle(motor, feedback=feedback), lambda t: -1.0, lambda t: 8.0)
    model.Simulation(mdl, firmware).simulate(t_stop=(cycles - 0.25) * motor.T_s, max_step=motor.T_s / 20.0)
    plant, cycle = iqfoc.Drive(motor).plant(), iqfoc.Cycle(motor, feedback=feedback)
    plant.set_speed(2.0 * np.pi * RPM / 60.0 * motor.pole_pairs)
    cycle.reference(-1.0, 8.0)
    duties, seen = (0.5, 0.5, 0.5), []
    for k in range(cycles):
        valley, peak, _ = plant.cycle(duties)
        cycle.valley(valley)
        duties = cycle.peak(peak).duties
        seen.append(np.array(cycle.state["i_dq"]) * motor.I_base_A / 2 ** 24)
    assert len(firmware.data.t) == cycles
    theirs = np.array([firmware.data.i_d_A, firmware.data.i_q_A]).T
    # Their delay starts with the duties 0, ours with a half: the same voltage.
    assert np.abs(theirs - np.array(seen)).max() < 2e-3 * 8.0
    assert abs(theirs[-1, 1] - 8.0) < 0.5


def test_their_controller_on_our_plant(motor):
    cfg = CurrentReferenceCfg(machine_parameters(motor), max_i_s=1.5 * motor.I_base_A, nom_w_m=2.0 * np.pi * 400.0)
    control = CurrentVectorControl(machine_parameters(motor), cfg, T_s=motor.T_s, alpha_c=2.0 * np.pi * 250.0, sensorless=False)
    asked_Nm = 4.0
    control.ref.tau_M = lambda t: asked_Nm
    plant = iqfoc.Drive(motor).plant()
    plant.set_speed(2.0 * np.pi * RPM / 60.0 * motor.pole_pairs)
    run = drive_plant(control, plant, 400)
    i_q = run["i_q_A"][-50:].mean()
    assert abs(i_q - asked_Nm / (1.5 * motor.pole_pairs * motor.psi_f_Wb)) < 0.3 and abs(run["i_d_A"][-50:].mean()) < 0.5
    with pytest.raises(ValueError, match="samples every"):
        control.T_s = 1e-4
        drive_plant(control, plant, 1)


def test_the_table_in_the_docs_is_unchanged(root):
    """docs/tune.md: a row of theirs that holds, one that trips, and the plain PI's, which the program measured by its own loop."""
    spec = importlib.util.spec_from_file_location("compare_motulator", root / "python" / "compare_motulator.py")
    compared = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(compared)
    table = importlib.import_module("marked").table_in(compared.DOCUMENT.read_text(encoding="utf-8"), "motulator")
    rows = {tuple(cells[:2]): cells[2:5] for cells in ([cell.strip() for cell in line.split("|")[1:-1]] for line in table.splitlines())
            if len(cells) > 5}
    rpm = float(re.search(r"All turn at (\S+) rpm", table)[1])

    def measured(ratio, run):
        motor = compared.motor_at(ratio, rpm, 1.0)
        return compared.cells(compared.step(lambda inverter, asked, cycles: run(inverter, motor, asked, cycles), motor, rpm, ratio))

    def theirs(inverter, motor, asked, cycles):
        return compared.under_motulator(inverter, motor, compared.THEIR_BANDWIDTH, asked, cycles)

    name = f"motulator, {compared.THEIR_BANDWIDTH:.0f} rad/s"
    assert measured(20, theirs) == rows["20", name]
    assert measured(10, theirs) == rows["10", name] == ["trips", "-", "-"]
    assert measured(20, lambda inverter, motor, asked, cycles: compared.under_firmware(inverter, motor, "midpoint", asked, cycles)) == rows[
        "20", "PI, mid-point sample"]
