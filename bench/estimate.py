"""
Estimates Cortex-M4 clock cycles from the instructions that a short run executes.

The estimate is the sum of the documented instruction timings (Arm DDI 0439, Cortex-M4 Technical Reference Manual, table 3-1), each at its
slow end: a division 12 cycles, a pipeline refill of 3 after a taken branch, no pipelined loads, no folded IT, memory without wait states. Those of
the FPU are in table 7-1, without the stall of an operand that is just computed. On a chip, build the benchmark with -DIQFOC_BENCH_DWT=ON, which reads the core's own counter.
"""
import re
import subprocess
import tempfile

REFILL = 3
DIVIDE = 12
FLOAT_DIVIDE = 14  # and the root
# The functions of bench/main.c and bench/inputs.c: what they execute is not the measured function's.
MEASURED = re.compile(r"ticks_(\w+)$")


def registers_in(operands):
    """How many registers a list such as {r4, r5, r8-fp} names."""
    count = 0
    names = ["r%d" % k for k in range(10)] + ["sl", "fp", "ip", "sp", "lr", "pc"]
    if "{s" in operands or "{d" in operands:
        names = [f"{operands[operands.index('{') + 1]}{k}" for k in range(32)]
    for part in operands[operands.index("{") + 1 : operands.index("}")].split(","):
        ends = [names.index(name.strip()) for name in part.split("-")]
        count += ends[-1] - ends[0] + 1
    return 2 * count if "{d" in operands else count


def cycles(mnemonic, operands, taken):
    """Documented cycles of one instruction at the slow end; taken: the next instruction was not the following one."""
    base = mnemonic.split(".")[0]
    refill = REFILL if taken else 0
    if base.startswith(("udiv", "sdiv")):
        return DIVIDE
    if base.startswith(("vdiv", "vsqrt")):
        return FLOAT_DIVIDE
    if base.startswith(("vmla", "vmls", "vnmla", "vnmls", "vfma", "vfms", "vfnma", "vfnms")):
        return 3
    if base.startswith(("vldr", "vstr")):
        return 3 if operands.startswith("d") else 2
    if base.startswith(("push", "pop", "ldm", "stm", "vpush", "vpop", "vldm", "vstm")):
        return 1 + registers_in(operands) + refill
    if base.startswith(("ldrd", "strd")):
        return 3
    if base.startswith(("ldr", "str")):
        return 2 + refill
    if base.startswith(("tbb", "tbh")):
        return 2 + refill
    return 1 + refill


def disassemble(image):
    """{address: (length, mnemonic, operands, function)}."""
    text = subprocess.run(["arm-none-eabi-objdump", "-d", str(image)], capture_output=True, text=True, check=True).stdout
    code, function = {}, ""
    for line in text.split("\n"):
        head = re.match(r"[0-9a-f]{8} <(.*)>:$", line)
        if head:
            function = head.group(1)
            continue
        instruction = re.match(r" *([0-9a-f]+):\t([0-9a-f ]+?) *\t(\S+)(?:\t([^@]*))?", line)
        if instruction:
            address, raw, mnemonic, operands = instruction.groups()
            code[int(address, 16)] = (len(raw.replace(" ", "")) // 2, mnemonic, operands or "", function)
    return code


def executed(image, command):
    """The addresses of all executed instructions, in order."""
    with tempfile.NamedTemporaryFile("r", prefix="iqfoc-trace-") as log:
        subprocess.run(command + ["-kernel", str(image), "-singlestep", "-d", "exec,nochain", "-D", log.name],
                       stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, timeout=1200, check=True)
        for line in log:
            at = re.match(r"Trace \d+: \S+ \[[0-9a-f]+/([0-9a-f]+)/", line)
            if at:
                yield int(at.group(1), 16)


def add(rows, build, command):
    """Adds `cycles_estimate`, the mean of one call, to each of the rows."""
    image = build / "bench" / "bench_trace.elf"
    code = disassemble(image)
    own = {"main", "report", "draw", "draw_within", "draw_magnitudes", "bench_input_draw", "bench_input_restart",
           "counter_start", "bench_nothing", "bench_handler_set", "bench_handler_start", "counts_of", "renew", "bench_drives_config"}
    sums, calls, case, previous = {}, {}, None, None
    for address in executed(image, command):
        if previous is not None and case is not None:
            length, mnemonic, operands, function = code[previous]
            if not MEASURED.match(function) and function not in own and not function.startswith("count_"):
                sums[case] = sums.get(case, 0) + cycles(mnemonic, operands, address != previous + length)
        function = code[address][3]
        measured = MEASURED.match(function)
        if measured:
            if case is None:
                case = measured.group(1)
                calls[case] = calls.get(case, 0) + 1
        elif function in own and function != "bench_nothing" or function.startswith("count_"):
            case = None
        previous = address
    per_call = {name: 2 * sums[name] / calls[name] for name in sums}  # every second call is the bare one
    for row in rows:
        name = row["function"]
        if name + "_valley" in per_call:
            row["cycles_estimate"] = round(per_call[name + "_valley"] + per_call[name + "_peak"])
        elif name == "sample_to_duty":
            row["cycles_estimate"] = round(per_call["isr_cycle_peak"])
        elif name == "handler_stm32g4":
            row["cycles_estimate"] = round(2 * per_call["interrupt"])
        elif name in per_call:
            row["cycles_estimate"] = round(per_call[name])
        else:
            # Inlined: no loads of its own, no branch, no division: one cycle an instruction.
            row["cycles_estimate"] = round(row["mean"])
