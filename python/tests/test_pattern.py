"""Pulse patterns over arrays and on the plant, against sums over the table's edges and the machine's equations, in double precision."""

import subprocess

import numpy as np
import pytest

import iqfoc

TURNS = 0.013


def voltages(edges, cycles, per_cycle=400):
    """Level of each leg at many times of each cycle, from its edges."""
    t = (np.arange(per_cycle) + 0.5) / per_cycle
    at = np.where(np.arange(16) < edges.edges[..., None], iqfoc.to_float(edges.at), 2.0)
    passed = (at[:, :, None, :] <= t[None, None, :, None]).sum(-1)
    return (edges.level[..., None] * (-1) ** passed).transpose(1, 0, 2).reshape(3, cycles * per_cycle)


def test_the_fundamental_is_the_index(motor):
    """Of the leg's voltage over many turns: amplitude as asked, phase of the angle; each leg switches 2 x pulses times a turn."""
    pulses, index, turn = 7, 0.72, 1000
    pattern = iqfoc.Pattern(motor, pulses=pulses)
    angle = iqfoc.from_float(np.remainder(TURNS * np.arange(turn), 1.0))
    edges = pattern.step(angle, iqfoc.from_float(TURNS), iqfoc.from_float(index))
    u = voltages(edges, turn)
    x = 2.0 * np.pi * TURNS * (np.arange(u.shape[1]) + 0.5) / 400
    for leg in range(3):
        fundamental = 2.0 * np.mean(u[leg] * np.exp(-1j * (x - leg * 2.0 * np.pi / 3.0)))
        assert abs(fundamental) == pytest.approx(index * 4.0 / np.pi, rel=4e-3)
        assert abs(np.angle(fundamental)) < 4e-3
    assert edges.edges.sum(0) == pytest.approx(2 * pulses * TURNS * turn, abs=2)
    high = iqfoc.to_float(edges.high)
    assert np.abs(high - (u.reshape(3, turn, 400).mean(-1).T + 1.0) / 2.0).max() < 16 / 400


def test_on_the_plant_the_current_is_the_machines(motor):
    """Steady state of the dq equations under that fundamental."""
    omega, index, ahead = 2000.0, 0.72, 0.27
    plant, pattern = iqfoc.Drive(motor).plant(), iqfoc.Pattern(motor, pulses=7)
    plant.set_speed(omega)
    rows = pattern.run(plant, 4000, index, ahead)
    u = index * 2.0 / np.pi * motor.u_dc_V * np.exp(2j * np.pi * ahead)
    i = (u - 1j * omega * motor.psi_f_Wb) / (motor.R_ohm + 1j * omega * motor.L_d_H)
    whole = slice(4000 - 22 * 10, None)  # a turn is 15.7 cycles: 14 turns
    assert rows["i_d_mean_A"][whole].mean() == pytest.approx(i.real, abs=0.15)
    assert rows["i_q_mean_A"][whole].mean() == pytest.approx(i.imag, abs=0.15)


def test_the_table_is_the_programs(program, root, motor, tmp_path):
    """Angles of the firmware's header, met by the edges of one slow turn at an index of the table."""
    subprocess.run([program, "patterns", "--motor", root / "data/motors/jarzebowicz2019.toml", "--pulses", "5", "-o", tmp_path / "p"],
                   check=True, capture_output=True)
    row = next(line for line in (tmp_path / "p" / "iqfoc_pattern.h").read_text().splitlines() if "/* 0.80 */" in line)
    start, _, *angles = [int(x) for x in row.split("/*")[0].replace("{", " ").replace("}", " ").replace(",", " ").split()]
    pattern, eighth, index = iqfoc.Pattern(motor, pulses=5), iqfoc.from_float(0.125), iqfoc.from_float(0.8)
    # The table's angles count from the rising zero of leg a, a quarter turn before its axis.
    first, second = pattern.step(-2 * eighth, eighth, index), pattern.step(-eighth, eighth, index)
    met = [int(at) / 8 + n * 2 ** 21 for n, e in enumerate((first, second)) for at in e.at[0][:e.edges[0]] if n > 0 or at > 0]
    assert first.level[0] * (-1) ** (first.edges[0] - len([a for a in angles if a <= 2 ** 21])) == start
    assert np.abs(np.array(met[:len(angles)]) - angles).max() <= 2


def test_refusals(motor):
    for choice, words in ((dict(pulses=6), "odd number"), (dict(on_time_s=-1.0), "on_time_s"), (dict(dead_time_s=1.0), "dead_time_s")):
        with pytest.raises(ValueError, match=words):
            iqfoc.Pattern(motor, **choice)
    pattern, plant = iqfoc.Pattern(motor), iqfoc.Drive(motor).plant()
    assert pattern.index_range[0] == 0.3 and pattern.index_range[1] > 0.9
    for choice, words in ((dict(index=2.0, ahead_turns=0.2), "index = 2.0"), (dict(index=0.5, ahead_turns=np.nan), "nan")):
        with pytest.raises(ValueError, match=words):
            pattern.run(plant, 10, **choice)
    with pytest.raises(TypeError, match="Q7.24"):
        pattern.step(0.1, 0, 0)
