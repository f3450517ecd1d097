"""The benchmark's tables: for the terminal, docs/bench.md and docs/porting.md."""
import pathlib

import size

DOCS = pathlib.Path(__file__).resolve().parent.parent / "docs"
BENCH, PORTING = DOCS / "bench.md", DOCS / "porting.md"

# Each row's name, the peers' instructions on the same core by the same method, and this project's bound.
ROWS = {
    "sincos": ("sine and cosine", "TI 115, CMSIS q31 124, CMSIS f32 (FPU) 63", 45),
    "park": ("Park, inlined", "CMSIS q31 19", 14),
    "park_inverse": ("inverse Park, inlined", "CMSIS q31 19", 14),
    "clarke": ("Clarke of two currents, inlined", "CMSIS q31 14", None),
    "sqrt": ("square root", "TI 106, CMSIS q31 53", 53),
    "atan2": ("arc tangent of a vector", "TI 130, CMSIS q31 311", 75),
    "div": ("division", "TI 80", 60),
    "rotor": ("s1 and s2 of the speed", "-", None),
    "mean_correction": ("mean-current correction, 2016 (10)", "-", 60),
    "mean_quasi_discrete": ("quasi-discrete mean, 2019 (10)", "-", None),
    "prediction_euler": ("standard prediction, 2019 (3)", "-", None),
    "prediction_quasi_discrete": ("quasi-discrete prediction, 2019 (12)", "-", 45),
    "prediction_exact": ("exact prediction, non-salient", "-", 53),
    "exact_at_speed": ("exact prediction's coefficients at a speed", "-", None),
    "exact_set_up": ("exact prediction's coefficients of a winding", "-", None),
    "prediction_salient": ("exact prediction, salient", "-", 60),
    "salient_at_speed": ("salient prediction's and mean's coefficients at a speed", "-", None),
    "mean_modulated": ("mean under modulation", "-", None),
    "modulated_at_speed": ("coefficients of the mean under modulation at a speed", "-", None),
    "ripple": ("ripple's part of the mean, salient", "-", None),
    "prediction_induction": ("exact prediction and flux, induction machine", "-", None),
    "induction_at_speed": ("induction machine's coefficients at a speed", "-", None),
    "deadbeat": ("deadbeat control, any predictor", "-", None),
    "deadbeat_drift": ("deadbeat control with disturbance observer", "-", None),
    "finite_set_1": ("finite control set, horizon 1", "-", None),
    "finite_set_3": ("finite control set, horizon 3", "-", None),
    "control_step": ("two PI with limits and anti-windup state", "CMSIS q31 2 x 20 (no limits)", None),
    "modulation": ("modulation with limiting", "-", None),
    "current_control": ("current control", "CMSIS f32 (FPU) 123, CMSIS q31 208, TI 226", 123),
    "cycle": ("the whole cycle, straight calls", "CMSIS q31 242 without correction and prediction", 242),
    "isr_cycle": ("valley and peak with all checks: quasi-discrete mean, PI, PWM", "-", 350),
    "isr_midpoint": ("valley and peak: mid-point sample", "-", None),
    "isr_corrected_mean": ("valley and peak: corrected mean", "-", None),
    "isr_exact": ("valley and peak: exact prediction and its mean", "-", None),
    "isr_salient": ("valley and peak: exact salient prediction and its mean", "-", None),
    "isr_flux": ("valley and peak: flux predictor (salient, saturating), mid-point sample", "-", None),
    "isr_flux_map": ("valley and peak: flux map of two saturating parts, mid-point sample", "-", None),
    "isr_mean_modulated": ("valley and peak: mean under modulation", "-", None),
    "isr_six_step": ("valley and peak: quasi-discrete mean, PI, six-step", "-", None),
    "isr_extended": ("valley and peak: quasi-discrete mean, PI, PWM, all corrections of a diagnosis", "-", None),
    "isr_deadbeat": ("valley and peak: deadbeat, quasi-discrete prediction", "-", 650),
    "isr_deadbeat_exact": ("valley and peak: deadbeat, exact prediction", "-", None),
    "isr_deadbeat_learning": ("valley and peak: deadbeat with disturbance observer, exact prediction", "-", None),
    "isr_cycle_looked_up": ("valley and peak: the ready-made cycle, which selects its methods at run time", "-", None),
    "sample_to_duty": ("the peak of `isr_cycle`: from the last sample to the duties", "-", 145),
    "overmodulation": ("modulation up to six-step", "-", None),
    "reference": ("torque to current: MTPA and field weakening", "-", None),
    "six_step_by_timer": ("six-step by a timer: one switching with all checks", "-", None),
    "pattern": ("pulse pattern: the edges of a cycle, nine pulses per electrical period", "-", None),
    "pattern_control_aim": ("control of a pulse pattern, at a peak", "-", None),
    "pattern_control_step": ("control of a pulse pattern, at a valley", "-", None),
    "edges_of_pattern": ("edges of a pattern in ticks", "-", None),
    "edges_of_duties": ("centred pulses in ticks", "-", None),
    "tuned_at_speed": ("tuned control's coefficients at a speed", "-", None),
    "tuned_step": ("tuned control, a cycle", "-", None),
    "watch_step": ("watch, each cycle", "-", None),
    "watch_block": ("watch, each 32 cycles", "-", None),
    "adapt_block": ("adaptation of resistance and magnet flux, each 32 cycles", "-", None),
    "adapt_law": ("adapted values into the predictor", "-", None),
    "encoder": ("angle from an encoder's count", "-", None),
    "resolver": ("angle from a resolver", "-", None),
    "halls": ("angle and speed from three Hall sensors", "-", None),
    "tracker": ("angle tracker", "-", None),
    "observer": ("angle and speed without a sensor, locked", "-", None),
    "observer_inductance": ("L_q of the observer from a step of the current", "-", None),
    "observer_resistance": ("R and psi_f of the observer from the flux's length", "-", None),
    "sensorless": ("the valley's angle from the observer, with its step", "-", None),
    "sensorless_acting": ("the voltage that acts: dead time's loss at each edge", "-", None),
    "watch_angle": ("watch of the angle sensor, each cycle", "-", None),
    "watch_angle_block": ("watch of the angle sensor, end of a block", "-", None),
    "shunts": ("currents from low-side shunts", "-", None),
    "offset": ("offset calibration, a sample", "-", None),
    "commission": ("self-commissioning, a cycle of the spin", "-", None),
    "commission_line": ("self-commissioning, end of the staircase", "-", None),
    "speed_control": ("speed control, a step", "-", None),
    "synchronous_carrier": ("synchronous carrier: the next period", "-", None),
    "synchronous_set": ("its set of parameters", "-", None),
    "synchronous_flux": ("its kept flux at a change of the period", "-", None),
    "pulse_mode_step": ("pulse modes: the level", "-", None),
    "pulse_mode_to_pattern": ("hand-over from carrier to pattern, with its control", "-", None),
    "pulse_mode_to_carrier": ("hand-over from pattern to carrier, with its control", "-", None),
    "pulse_mode_resume": ("first voltage of the carrier after a pattern", "-", None),
    "start": ("alignment and open-loop angle", "-", None),
    "supervision": ("detection of a lost phase and a lost sensor", "-", None),
    "restart": ("break latch and restart", "-", None),
    "recorder": ("recorder: a row of four channels", "-", None),
    "handler_stm32g4": ("the STM32G4 example's two interrupts of a period, with its port", "-", 640),
}
# All objects of a group, whether called or not.
PARTS = {
    "core": "the library's core: numbers, transforms, corrections, prediction, control, modulation, cycle",
    "all": "the whole library, with all optional modules and drive services",
}
START = "<!-- bench: begin -->"
END = "<!-- bench: end -->"
SIZE_START = "<!-- size: begin -->"
SIZE_END = "<!-- size: end -->"
CORES_START = "<!-- cores: begin -->"
CORES_END = "<!-- cores: end -->"
FLASH_START = "<!-- flash: begin -->"
FLASH_END = "<!-- flash: end -->"
FIRMWARE_START = "<!-- firmware: begin -->"
FIRMWARE_END = "<!-- firmware: end -->"
CORES = {"m0plus": "Cortex-M0+", "m3": "Cortex-M3", "m7": "Cortex-M7", "m33": "Cortex-M33", "rv32": "RV32IM", "rv32imc": "RV32IMC"}


def plain(result):
    lines = []
    for target in ("cortex-m4", "rv32"):
        lines.append(f"{target:28} {'min':>6} {'mean':>8} {'max':>6} {'code':>6} {'rodata':>6} {'stack':>6}"
                     + ("  cycles, estimated" if target == "cortex-m4" else ""))
        for row in result[target]:
            line = "  {function:26} {min:6} {mean:8.1f} {max:6} {code:6} {rodata:6} {stack:6}".format(**row)
            if "cycles_estimate" in row:
                line += f" {row['cycles_estimate']:8.0f}"
            lines.append(line)
        library = result["library"][target]
        for part, what in PARTS.items():
            lines.append(f"  {what}: {library[part]['code']} bytes of code, {library[part]['rodata']} of constants")
        for drive in result["size"][target]:
            lines.append(f"  {size.DRIVES[drive['drive']]}: {drive['text']} text, {drive['data']} data, {drive['bss']} bss; "
                         + ", ".join(drive["parts"]))
    return "\n".join(lines) + "\n"


def _count(row):
    """The mean, and the ends of the spread where there is one."""
    if row["min"] == row["max"]:
        return f"{row['max']}"
    return f"{row['mean']:.0f} ({row['min']} ... {row['max']})"


def markdown(result):
    lines = [
        "| function | Cortex-M4 | bound | peers, Cortex-M4 | cycles (estimate) | bytes code + const | stack | RV32IM | bytes | stack |",
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for arm, riscv in zip(result["cortex-m4"], result["rv32"]):
        what, peers, bound = ROWS[arm["function"]]
        lines.append(
            f"| {what} (`{arm['function']}`) | {_count(arm)} | {bound or '-'} | {peers} | {arm['cycles_estimate']:.0f} | "
            f"{arm['code']} + {arm['rodata']} | {arm['stack']} | {_count(riscv)} | {riscv['code']} + {riscv['rodata']} | "
            f"{riscv['stack']} |")
    for part, what in PARTS.items():
        arm, riscv = (result["library"][target][part] for target in ("cortex-m4", "rv32"))
        bound = "8192 bytes" if part == "core" else "-"
        lines.append(f"| {what} | | {bound} | | | {arm['code']} + {arm['rodata']} | | | {riscv['code']} + {riscv['rodata']} | |")
    return "\n".join(lines) + "\n"


def size_markdown(result):
    """Memory of each drive of bench/size.py, and the library's sources in it."""
    lines = ["| drive | Cortex-M4: text | data | bss | RV32IM: text | data | bss | linked sources of `src/` |",
             "| --- | ---: | ---: | ---: | ---: | ---: | ---: | --- |"]
    for arm, riscv in zip(result["size"]["cortex-m4"], result["size"]["rv32"]):
        numbers = [drive[key] for drive in (arm, riscv) for key in ("text", "data", "bss")]
        lines.append(f"| {size.DRIVES[arm['drive']]} | " + " | ".join(map(str, numbers)) + f" | {', '.join(arm['parts'])} |")
    return "\n".join(lines) + "\n"


def cores_markdown(result):
    """Means of the pair and of a whole interrupt on other cores, and the library's size."""
    lines = ["| core | valley and peak, `isr_cycle` | STM32G4 example's two interrupts, `handler_stm32g4` | bytes of code, whole library |",
             "| --- | ---: | ---: | ---: |"]
    for core, name in CORES.items():
        counts = result["cores"][core]
        lines.append(f"| {name} | {counts['isr_cycle']:.0f} | {counts['handler_stm32g4']:.0f} | {counts['code']} |")
    return "\n".join(lines) + "\n"


def flash_markdown(result):
    """Cycles from memory without wait states and from the STM32G4's flash."""
    lines = ["| row | instructions | cycles, CCM SRAM | cycles, flash, two banks | cycles, flash, one bank |", "| --- | ---: | ---: | ---: | ---: |"]
    rows = {row["function"]: row for row in result["cortex-m4"]}
    for name, cycles in result["flash"].items():
        lines.append(f"| `{name}` | {rows[name]['mean']:.0f} | {rows[name]['cycles_estimate']} | {cycles['two_banks']} | {cycles['one_bank']} |")
    return "\n".join(lines) + "\n"


def firmware_markdown(result):
    """Memory of the STM32G474 firmware images, for docs/porting.md."""
    lines = ["| firmware for the STM32G474 | flash, KiB | CCM SRAM, KiB | RAM besides the stack, bytes |", "| --- | ---: | ---: | ---: |"]
    for row in result["firmware"]:
        lines.append(f"| `examples/{row['image']}` | {(row['text'] + row['data']) / 1024:.1f} | {row['ccm'] / 1024:.1f} | "
                     f"{row['data'] + row['bss']} |")
    return "\n".join(lines) + "\n"


def _blocks(result):
    """(document, start, end, text) of each table."""
    return ((BENCH, START, END, markdown(result)), (BENCH, SIZE_START, SIZE_END, size_markdown(result)),
            (BENCH, CORES_START, CORES_END, cores_markdown(result)), (BENCH, FLASH_START, FLASH_END, flash_markdown(result)),
            (PORTING, FIRMWARE_START, FIRMWARE_END, firmware_markdown(result)))


def _split(path, start, end):
    """The document before, between and after a table's marks."""
    text = path.read_text()
    if text.count(start) != 1 or text.count(end) != 1:
        raise SystemExit(f"{path}: {start} and {end} must each occur once")
    head, rest = text.split(start)
    return head, *rest.split(end)


def rewrite(result):
    """Writes the tables into the documents."""
    for path, start, end, text in _blocks(result):
        head, _, tail = _split(path, start, end)
        path.write_text(head + start + "\n" + text + end + tail)


def differing(result):
    """The documents' tables that are not these: (document, mark)."""
    return [(path, start) for path, start, end, text in _blocks(result) if _split(path, start, end)[1] != "\n" + text]
