#!/usr/bin/env python3
"""
Runs the benchmark images in QEMU: instructions, bytes and stack, as tables and JSON, and the check against the baseline (2 %).

Called by bench/run.sh, which builds the images first.
"""
import argparse
import concurrent.futures
import json
import pathlib
import subprocess
import sys

import core as one_core
import elf32
import estimate
import flash
import size
import table
from footprint import Footprint

HERE = pathlib.Path(__file__).resolve().parent
BASELINE = HERE / "baseline.json"
INPUTS = 4096

# port/*/counter_qemu.h says why a count is exact.
EMULATORS = {
    "cortex-m4": ["qemu-system-arm", "-M", "mps2-an386", "-semihosting-config", "enable=on,target=native",
                  "-icount", "shift=10"],
    "rv32": ["qemu-system-riscv32", "-M", "virt", "-bios", "none", "-icount", "shift=0"],
}
SERIAL = ["-display", "none", "-monitor", "none", "-serial", "stdio"]
TIME_LIMIT_S = 1200  # by the clock: a loaded machine is slow

# The configurations of bench/drives.h.
DRIVES = ("isr_cycle", "isr_midpoint", "isr_corrected_mean", "isr_exact", "isr_salient", "isr_flux", "isr_flux_map", "isr_mean_modulated",
          "isr_six_step", "isr_extended", "isr_deadbeat", "isr_deadbeat_exact", "isr_deadbeat_learning")

# Where each row's code begins. A row of inlined code is a pair: a straight line of eight, and the same without.
ROOTS = {
    "sincos": ["iq24_sincos"],
    "park": ("bench_park_line", "bench_four_to_two_line"),
    "park_inverse": ("bench_park_inverse_line", "bench_four_to_two_line"),
    "clarke": ("bench_clarke_line", "bench_two_to_two_line"),
    "sqrt": ["iq24_sqrt"],
    "atan2": ["iq24_atan2"],
    "div": ["iq24_div"],
    "rotor": ["iqfoc_rotor_from_speed"],
    "mean_correction": ["iqfoc_mean_current_correct"],
    "mean_quasi_discrete": ["iqfoc_mean_current_quasi_discrete"],
    "prediction_euler": ["iqfoc_predictor_euler"],
    "prediction_quasi_discrete": ["iqfoc_predictor_quasi_discrete"],
    "prediction_exact": ["iqfoc_exact_step"],
    "exact_at_speed": ["iqfoc_exact_at_speed"],
    "exact_set_up": ["iqfoc_exact_prediction"],
    "prediction_salient": ["iqfoc_salient_step"],
    "salient_at_speed": ["iqfoc_salient_at_speed"],
    "mean_modulated": ["iqfoc_mean_modulated"],
    "modulated_at_speed": ["iqfoc_mean_modulated_at_speed"],
    "ripple": ["iqfoc_ripple_seen"],
    "prediction_induction": ["iqfoc_induction_step"],
    "induction_at_speed": ["iqfoc_induction_at_speed"],
    "deadbeat": ["iqfoc_deadbeat_step"],
    "deadbeat_drift": ["iqfoc_deadbeat_drift_step"],
    "finite_set_1": ["iqfoc_finite_set_choose"],
    "finite_set_3": ["iqfoc_finite_set_choose"],
    "control_step": ["iqfoc_current_control_step"],
    "modulation": ["iqfoc_modulate"],
    "current_control": ["bench_current_control"],
    "cycle": ["bench_cycle"],
    **{name: [f"bench_{name}_valley", f"bench_{name}_peak"] for name in DRIVES},
    "isr_cycle_looked_up": ["iqfoc_cycle_valley", "iqfoc_cycle_peak"],
    "sample_to_duty": ["bench_isr_cycle_peak"],
    "overmodulation": ["iqfoc_overmodulate"],
    "reference": ["iqfoc_reference_step"],
    "six_step_by_timer": ["iqfoc_cycle_six_step_switch"],
    "pattern": ["iqfoc_pattern_step"],
    "pattern_control_aim": ["iqfoc_pattern_control_aim"],
    "pattern_control_step": ["iqfoc_pattern_control_step"],
    "edges_of_pattern": ["iqfoc_edges_of_pattern"],
    "edges_of_duties": ["iqfoc_edges_of_duties"],
    "tuned_at_speed": ["iqfoc_tuned_at_speed"],
    "tuned_step": ["iqfoc_tuned_step"],
    "watch_step": ["iqfoc_watch_step"],
    "watch_block": ["iqfoc_watch_block"],
    "adapt_block": ["iqfoc_adapt_block"],
    "adapt_law": ["iqfoc_adapt_law"],
    "encoder": ["iqfoc_encoder_theta"],
    "resolver": ["iqfoc_resolver_read"],
    "halls": ["iqfoc_halls_step"],
    "tracker": ["iqfoc_tracker_step"],
    "observer": ["iqfoc_observer_step"],
    "observer_inductance": ["iqfoc_observer_inductance_step"],
    "observer_resistance": ["iqfoc_observer_resistance_step"],
    "sensorless": ["iqfoc_sensorless_valley"],
    "sensorless_acting": ["iqfoc_sensorless_acting"],
    "watch_angle": ["iqfoc_watch_angle_step"],
    "watch_angle_block": ["iqfoc_watch_angle_step"],
    "shunts": ["iqfoc_shunts_read"],
    "offset": ["iqfoc_offset_step"],
    "commission": ["iqfoc_commission_step"],
    "commission_line": ["iqfoc_commission_step"],
    "speed_control": ["iqfoc_speed_control_step"],
    "synchronous_carrier": ["iqfoc_synchronous_carrier_step"],
    "synchronous_set": ["iqfoc_synchronous_carrier_set"],
    "synchronous_flux": ["iqfoc_synchronous_carrier_keep_flux"],
    "pulse_mode_step": ["iqfoc_pulse_mode_step"],
    "pulse_mode_to_pattern": ["iqfoc_pulse_mode_to_pattern"],
    "pulse_mode_to_carrier": ["iqfoc_pulse_mode_to_carrier"],
    "pulse_mode_resume": ["iqfoc_pulse_mode_resume"],
    "start": ["iqfoc_start_step"],
    "supervision": ["iqfoc_supervision_step"],
    "restart": ["iqfoc_restart_step"],
    "recorder": ["iqfoc_recorder_take"],
    "handler_stm32g4": ["bench_handler"],
}
LINE = 8


def run(target, image):
    """The image's counts: {function: (min, mean, max)}."""
    command = EMULATORS[target] + SERIAL + ["-kernel", str(image)]
    try:
        done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, timeout=TIME_LIMIT_S, check=False)
    except subprocess.TimeoutExpired:
        raise SystemExit(f"{target}: no end after {TIME_LIMIT_S} s")
    lines = done.stdout.decode(errors="replace").split("\n")
    if done.returncode != 0 or "end" not in lines:
        raise SystemExit(f"{target}: exit status {done.returncode}\n" + "\n".join(lines) + done.stderr.decode())
    counts = {}
    for line in lines:
        words = line.split()
        if len(words) == 4:
            counts[words[0]] = (int(words[1]), int(words[2]) / INPUTS, int(words[3]))
    if set(counts) != set(ROOTS):
        raise SystemExit(f"{target}: counted {sorted(counts)}, expected {sorted(ROOTS)}")
    return counts


def evaluate(target, build):
    """The rows of a target, in the order of ROOTS."""
    image = build / "bench" / "bench.elf"
    objects = sorted(build.glob("src/CMakeFiles/iqfoc.dir/*.obj")) + sorted(build.glob("bench/CMakeFiles/bench.dir/**/*.obj"))
    footprint = Footprint(image, objects)
    counts = run(target, image)
    rows = []
    for name, roots in ROOTS.items():
        least, mean, greatest = counts[name]
        row = {"function": name, "min": least, "mean": round(mean, 2), "max": greatest}
        if isinstance(roots, tuple):
            row["code"] = round((footprint.size_of(roots[0]) - footprint.size_of(roots[1])) / LINE)
            row["rodata"] = row["stack"] = 0
        else:
            row["code"], row["rodata"] = footprint.bytes_of(roots)
            row["stack"] = max(footprint.stack_of(root) for root in roots)
        rows.append(row)
    return rows


def estimated(build):
    """The rows of Cortex-M4 with an estimate of their cycles."""
    rows = evaluate("cortex-m4", build)
    estimate.add(rows, build, EMULATORS["cortex-m4"] + SERIAL)
    return rows


def measured(folder):
    """All that is counted of the builds in a folder. The emulators run side by side: they count instructions, not time."""
    build = {target: folder / target for target in EMULATORS}
    with concurrent.futures.ProcessPoolExecutor() as pool:
        rows = {"cortex-m4": pool.submit(estimated, build["cortex-m4"]), "rv32": pool.submit(evaluate, "rv32", build["rv32"])}
        cores = {core: pool.submit(one_core.costs, core, ("isr_cycle", "handler_stm32g4")) for core in table.CORES}
        banks = pool.submit(flash.evaluate, build["cortex-m4"], EMULATORS["cortex-m4"] + SERIAL)
        return {
            **{target: found.result() for target, found in rows.items()},
            "flash": banks.result(),
            "library": {target: library_size(build[target]) for target in EMULATORS},
            "size": {target: size.evaluate(target, build[target]) for target in EMULATORS},
            "compilers": compilers(EMULATORS),
            "cores": {core: found.result() for core, found in cores.items()},
            "firmware": size.firmware(build["cortex-m4"]),
        }


# Objects of the papers' control: the library's core.
CORE = {"arm_muls", "arm_rotor", "arm_sincos", "cycle", "iq24_math", "iq24_trig", "modulation", "rotor"}


def library_size(build):
    """Code and constants in bytes of all objects: of the core, and of the whole library."""
    sizes = {"core": {"code": 0, "rodata": 0}, "all": {"code": 0, "rodata": 0}}
    for path in build.glob("src/CMakeFiles/iqfoc.dir/*.obj"):
        for section in elf32.read(path).sections:
            if section.flags & elf32.SHF_ALLOC and section.kind == 1:
                kind = "code" if section.flags & elf32.SHF_EXECINSTR else "rodata"
                sizes["all"][kind] += section.size
                if path.name.split(".")[0] in CORE:
                    sizes["core"][kind] += section.size
    return sizes


def compilers(targets):
    """The compilers; counts of different compilers are not comparable."""
    names = {"cortex-m4": "arm-none-eabi-gcc", "rv32": "riscv64-unknown-elf-gcc"}
    return {target: f"{name} " + subprocess.run([name, "-dumpfullversion"], capture_output=True, text=True,
                                                check=True).stdout.strip() for target, name in names.items() if target in targets}


def compared_cores(baseline, result):
    return [f"{core} {function}: rose from {old} to {result['cores'][core][function]}"
            for core, row in baseline["cores"].items() for function, old in row.items()
            if function != "code" and result["cores"][core][function] > 1.02 * old]


def compared_firmware(baseline, result):
    return [f"{new['image']}: {key} rose from {old[key]} to {new[key]}" for old, new in zip(baseline["firmware"], result["firmware"], strict=True)
            for key in ("text", "data", "bss", "ccm") if new[key] > 1.02 * old[key]]


def check(result):
    """Complaints: a count more than 2 % above the baseline's, or a document's table that is not the baseline's."""
    if not BASELINE.exists():
        return [f"{BASELINE} is missing: bench/run.sh --update writes it"]
    baseline = json.loads(BASELINE.read_text())
    complaints = []
    for path, mark in table.differing(baseline):
        complaints.append(f"{path.name}: the table at {mark} is not that of {BASELINE.name}: bench/run.sh --update")
    for target in result["compilers"]:
        if baseline["compilers"][target] != result["compilers"][target]:
            print(f"{target}: the baseline is of {baseline['compilers'][target]}, this is {result['compilers'][target]}: "
                  "not compared")
            continue
        known = {row["function"]: row for row in baseline[target]}
        for row in result[target]:
            old = known.get(row["function"])
            if old is None:
                complaints.append(f"{target} {row['function']}: not in {BASELINE.name}")
                continue
            for key in ("mean", "max", "code", "stack"):
                if row[key] > old[key] * 1.02:
                    complaints.append(f"{target} {row['function']}: {key} rose from {old[key]} to {row[key]}")
        complaints += size.compared(target, baseline["size"][target], result["size"][target])
    if "cores" in result and baseline["compilers"]["cortex-m4"] == result["compilers"]["cortex-m4"]:
        complaints += compared_cores(baseline, result) + compared_firmware(baseline, result)
    return complaints


def report(complaints):
    """The exit status for what `check` found."""
    print("\n".join(complaints), file=sys.stderr) if complaints else print("within 2 % of bench/baseline.json")
    return 1 if complaints else 0


def main():
    parser = argparse.ArgumentParser(prog="./dev bench", description=__doc__.strip().split("\n")[0])
    parser.add_argument("--build", type=pathlib.Path, required=True, help=argparse.SUPPRESS)
    parser.add_argument("--json", type=pathlib.Path, metavar="F", help="write the counts to F")
    parser.add_argument("--check", action="store_true", help="fail if a count is more than 2 %% above bench/baseline.json")
    parser.add_argument("--update", action="store_true", help="write bench/baseline.json and the tables of docs/bench.md and porting.md")
    parser.add_argument("--markdown", action="store_true", help="print the table of docs/bench.md")
    parser.add_argument("--quick", action="store_true", help="Cortex-M4 alone; with --check")
    options = parser.parse_args()
    if options.quick and (not options.check or options.json or options.update or options.markdown):
        parser.error("--quick goes with --check alone: the files and tables need all targets")

    if options.quick:
        target = "cortex-m4"
        return report(check({target: evaluate(target, options.build / target), "size": {target: size.evaluate(target, options.build / target)},
                             "compilers": compilers([target])}))
    result = measured(options.build)
    text = json.dumps(result, indent=1) + "\n"
    if options.json:
        options.json.write_text(text)
    if options.update:
        BASELINE.write_text(text)
        table.rewrite(result)
    if options.markdown:
        print(table.markdown(result), end="")
    else:
        print(table.plain(result), end="")
    return report(check(result)) if options.check else 0


if __name__ == "__main__":
    sys.exit(main())
