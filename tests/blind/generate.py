#!/usr/bin/python3
"""Writes one blind recording: DIR/rec.csv and DIR/motor.toml (what the user has) and DIR/truth.json (what is hidden).

    /usr/bin/python3 tests/blind/generate.py --seed 7              into build/blind/7; the seed draws the kind, too
    /usr/bin/python3 tests/blind/generate.py --seed 7 --kind single -o DIR
    kinds: clean, single, pair, triple, unknown, or cause ids joined by + (dead_time, resistance+angle_offset)

Needs Debian's python3-numpy.
"""

import argparse
import json
import os
import sys

try:
    import numpy as np
except ImportError:
    sys.exit("tests/blind: this python3 has no numpy; use Debian's /usr/bin/python3 with python3-numpy")

import draw
import motors
from second_plant import TURN

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))

# One of these where nobody asks for a kind.
KINDS = ("clean", "single", "single", "pair", "triple", "unknown")


def decimals(step):
    """Digits after the dot that show a tenth of a step."""
    return max(0, int(np.ceil(1.0 - np.log10(step))))


def recording_text(drawn):
    """The recording as CSV text in the columns, order, rounding and line ends that the bench was drawn with."""
    motor, bench, c = drawn.motor, drawn.bench, drawn.columns
    T_s, lanes = 1.0 / motor.f_pwm_Hz, bench.runs
    rng = np.random.default_rng([drawn.truth["seed"], 3])
    i_digits = decimals(2.0 * bench.full_scale_A / 2 ** bench.bits)
    table, start = {}, 0.0

    def put(name, values, form):
        table.setdefault((name, form), []).append(values)

    for lane in range(lanes):
        n = bench.rows[lane]
        theta = c["theta_e_rad"][:n, lane]
        shown = {"2pi": theta % TURN, "pi": (theta + np.pi) % TURN - np.pi, "no": theta}[bench.wrap]
        if bench.has_run:
            put("run", np.full(n, lane + 1), "%d")
        put("t_s", start + T_s * np.arange(n), "%.7f")
        start += T_s * (n + int(rng.integers(800, 4000)))
        for x, phase in enumerate("abc"[:3 if bench.has_i_c else 2]):
            put(f"i_{phase}_A", c["i_A"][:n, x, lane], f"%.{i_digits}f")
        put("theta_e_rad", shown, "%.6f")
        put("omega_e_rad_s", c["omega_e_rad_s"][:n, lane], "%.3f")
        if bench.columns in ("u", "both"):
            for x, phase in enumerate("abc"):
                put(f"u_{phase}_V", c["u_V"][:n, x, lane], "%.3f" if motor.u_dc_V > 100.0 else "%.4f")
        if bench.columns in ("duty", "both"):
            for x, phase in enumerate("abc"):
                put(f"d_{phase}", c["duty"][:n, x, lane], "%.6f")
        if bench.columns in ("duty", "both") or bench.extra:
            put("u_dc_V", c["u_dc_V"][:n, lane], "%.3f")
        if bench.has_mid:
            for x, phase in enumerate("abc"[:3 if bench.has_i_c else 2]):
                put(f"i_{phase}_mid_A", c["i_mid_A"][:n, x, lane], f"%.{i_digits}f")
        if bench.has_mech:
            put("theta_mech_rad", (theta / motor.pole_pairs) % TURN, "%.6f")
        if bench.extra:
            put("state", np.full(n, 4), "%d")
        if "temp_C" in c:
            put("temp_C", c["temp_C"][:n, lane], "%.2f")
        elif bench.extra:
            put("temp_C", 41.0 + 0.2 * lane + 0.1 * np.round(rng.standard_normal(n)), "%.1f")
    keys = list(table)
    if bench.shuffle:
        keys = [keys[k] for k in rng.permutation(len(keys))]
    columns = [np.char.mod(form, np.concatenate(table[name, form])) for name, form in keys]
    end = "\r\n" if bench.crlf else "\n"
    comments = [f"# {motor.name}, bench trace {drawn.truth['seed']}", "# sampled at the carrier valley"]
    lines = comments if bench.comments else []
    lines.append(",".join(name for name, _ in keys))
    lines += [",".join(row) for row in zip(*columns)]
    return end.join(lines) + end


def motor_text(motor):
    return (f'name = "{motor.name}"\n[motor]\npole_pairs = {motor.pole_pairs}\nR_ohm = {motor.R_ohm!r}\n'
            f"L_d_H = {motor.L_d_H!r}\nL_q_H = {motor.L_q_H!r}\npsi_f_Wb = {motor.psi_f_Wb!r}\n"
            f"I_rated_A_rms = {motor.I_rated_A_rms!r}\nn_max_rpm = {motor.n_max_rpm:g}\n"
            f"[inverter]\nf_pwm_Hz = {motor.f_pwm_Hz:g}\nu_dc_V = {motor.u_dc_V:g}\n")


def write_text(folder, name, text):
    with open(os.path.join(folder, name), "w", encoding="utf-8", newline="") as file:
        file.write(text)


def write_truth(truth, folder):
    """Last of the three files: a folder that holds it is whole."""
    write_text(folder, "truth.json", json.dumps(truth, indent=2) + "\n")


def write(drawn, folder):
    os.makedirs(folder, exist_ok=True)
    write_text(folder, "rec.csv", recording_text(drawn))
    write_text(folder, "motor.toml", motor_text(drawn.file))
    write_truth(drawn.truth, folder)


def make(seed, kind, plant, folder, iqfoc, bench_kind="usual", with_digits=False):
    """Draws and writes one recording by either plant; iqfoc is the program that holds the main one."""
    if plant == "main":
        import main_plant  # which imports this module
        main_plant.make(seed, kind, folder, iqfoc, None, bench_kind, with_digits)
    else:
        write(draw.draw(seed, kind, None, bench_kind, with_digits), folder)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--kind", help="what is hidden; drawn from the seed if not given")
    parser.add_argument("-o", "--output", metavar="DIR", help="build/blind/SEED if not given")
    parser.add_argument("--plant", choices=["second", "main"], default="second")
    parser.add_argument("--bench", choices=motors.BENCHES, default="usual")
    parser.add_argument("--digits", action="store_true", help="with last-digit errors in the motor file (digits.py)")
    parser.add_argument("--iqfoc", default=os.path.join(ROOT, "build", "host", "iqfoc"), help="for --plant main")
    args = parser.parse_args()
    kind = args.kind or KINDS[int(np.random.default_rng([args.seed, 9]).integers(len(KINDS)))]
    folder = args.output or os.path.join(ROOT, "build", "blind", str(args.seed))
    try:
        make(args.seed, kind, args.plant, folder, args.iqfoc, args.bench, args.digits)
    except ValueError as problem:
        parser.error(str(problem))


if __name__ == "__main__":
    sys.exit(main())
