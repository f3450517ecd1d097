"""The benchmark's tables: for the terminal, and for docs/bench.md beside what peers need."""
import size

# What the row is, the peers' instructions on the same core and by the same method, and this project's bound.
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
    "exact_set_up": ("exact prediction's law of a winding", "-", None),
    "prediction_salient": ("exact prediction, salient", "-", 60),
    "salient_at_speed": ("salient prediction's and mean's coefficients at a speed", "-", None),
    "mean_modulated": ("mean under modulation", "-", None),
    "modulated_at_speed": ("its coefficients at a speed", "-", None),
    "ripple": ("the ripple's part of the mean, salient", "-", None),
    "prediction_induction": ("exact prediction and flux, induction machine", "-", None),
    "induction_at_speed": ("its coefficients at a speed", "-", None),
    "deadbeat": ("deadbeat control of a cycle, any predictor", "-", None),
    "deadbeat_drift": ("the same with a learnt drift", "-", None),
    "finite_set_1": ("finite control set, horizon 1", "-", None),
    "finite_set_3": ("the same, horizon 3", "-", None),
    "control_step": ("two PI with limits and anti-windup state", "CMSIS q31 2 x 20 (no limits)", None),
    "modulation": ("modulation with limiting", "-", None),
    "current_control": ("current control", "CMSIS f32 (FPU) 123, CMSIS q31 208, TI 226", 123),
    "cycle": ("the whole cycle, straight calls", "CMSIS q31 242 without correction and prediction", 242),
    "isr_cycle": ("valley and peak, all checks: quasi-discrete mean, PI, PWM", "-", 400),
    "isr_midpoint": ("the same fed by the mid-point sample", "-", None),
    "isr_corrected_mean": ("fed by the corrected mean", "-", None),
    "isr_exact": ("by exact prediction, fed by its mean", "-", None),
    "isr_salient": ("by exact prediction of a salient machine, fed by its mean", "-", None),
    "isr_flux": ("by flux linkage: salient and saturating; mid-point sample", "-", None),
    "isr_mean_modulated": ("fed by the mean under modulation", "-", None),
    "isr_six_step": ("quasi-discrete mean, PI, six-step", "-", None),
    "isr_extended": ("quasi-discrete mean, PI, PWM, with all that a diagnosis puts right", "-", None),
    "isr_deadbeat": ("deadbeat control by quasi-discrete prediction", "-", 650),
    "isr_deadbeat_exact": ("deadbeat control by exact prediction", "-", None),
    "isr_deadbeat_learning": ("the same with a learnt drift", "-", None),
    "isr_cycle_looked_up": ("the ready-made cycle, its methods looked up: the first of these", "-", None),
    "sample_to_duty": ("of the first, the peak: from the last sample to the duties", "-", 170),
    "overmodulation": ("modulation up to six-step", "-", None),
    "reference": ("torque to current: MTPA and field weakening", "-", None),
    "six_step_by_timer": ("six-step by a timer: one switching, all checks", "-", None),
    "tuned_at_speed": ("tuned control's coefficients at a speed", "-", None),
    "tuned_step": ("tuned control of a cycle", "-", None),
    "watch_step": ("the watch on the model, each cycle", "-", None),
    "watch_block": ("the watch, each 32 cycles", "-", None),
    "adapt_block": ("resistance and magnet followed, each 32 cycles", "-", None),
    "adapt_law": ("and handed to the law", "-", None),
    "encoder": ("angle of an encoder's count", "-", None),
    "resolver": ("angle of a resolver", "-", None),
    "halls": ("angle and speed of three Halls", "-", None),
    "tracker": ("the angle's tracker", "-", None),
    "shunts": ("currents of low-side shunts", "-", None),
    "offset": ("offset calibration, a sample", "-", None),
    "start": ("alignment and open-loop angle", "-", None),
    "supervision": ("lost phase and lost sensor", "-", None),
    "restart": ("break latch and restart", "-", None),
    "handler_stm32g4": ("the STM32G4 example's two interrupts of a period, port and all", "-", 640),
}
# What is linked, nothing left out.
PARTS = {
    "core": "the library linked: numbers, transforms, corrections, prediction, control, modulation, cycle",
    "all": "with all the rest: exact and salient prediction, mean under modulation, deadbeat, finite-set and tuned control, "
           "overmodulation, reference, induction machine, corrections from a diagnosis, watch, recorder, and what stands around a first "
           "drive",
}
START = "<!-- bench: begin -->"
END = "<!-- bench: end -->"
SIZE_START = "<!-- size: begin -->"
SIZE_END = "<!-- size: end -->"


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
    """What each drive of bench/size.py takes, and of which parts of the library."""
    lines = ["| drive | Cortex-M4: text | data | bss | RV32IM: text | data | bss | of the library, linked |",
             "| --- | ---: | ---: | ---: | ---: | ---: | ---: | --- |"]
    for arm, riscv in zip(result["size"]["cortex-m4"], result["size"]["rv32"]):
        numbers = [drive[key] for drive in (arm, riscv) for key in ("text", "data", "bss")]
        lines.append(f"| {size.DRIVES[arm['drive']]} | " + " | ".join(map(str, numbers)) + f" | {', '.join(arm['parts'])} |")
    return "\n".join(lines) + "\n"


def _blocks(result):
    """The document's tables, by the marks that they stand between."""
    return {(START, END): markdown(result), (SIZE_START, SIZE_END): size_markdown(result)}


def _split(path, start, end):
    """The document before, between and after a table's marks."""
    text = path.read_text()
    if text.count(start) != 1 or text.count(end) != 1:
        raise SystemExit(f"{path}: the marks {start} and {end} must each stand in it once")
    head, rest = text.split(start)
    return head, *rest.split(end)


def rewrite(path, result):
    """Puts the tables between their marks in a document."""
    for (start, end), text in _blocks(result).items():
        head, _, tail = _split(path, start, end)
        path.write_text(head + start + "\n" + text + end + tail)


def stand_in(path, result):
    return all(_split(path, start, end)[1] == "\n" + text for (start, end), text in _blocks(result).items())
