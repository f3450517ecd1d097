"""
Cycles of a call that runs from the STM32G4's flash at 170 MHz: those of estimate.py, and the waits for the flash by a model of its
interface (RM0440 3.3.3 to 3.3.5). A model, not a chip:

- The flash has four wait states and delivers a line: 64 bits with its two banks apart (DBANK = 1, as shipped), 128 bits with both as one.
  One read is under way at a time.
- With the arrival of a line the prefetch begins to read the line after it. An instruction starts when all of its bytes are there.
- A line that was waited for is kept in the instruction cache (1 KiB), and data in the data cache (256 bytes); a line that the prefetch
  brought is not kept. Both caches are empty when a call begins: the main program has used them since the last interrupt.
- The interrupt's entry and exit, and its vector, are not included.
"""
import re
import subprocess
import tempfile

import estimate

BANKS = {"two_banks": 8, "one_bank": 16}  # bytes of a line
WAIT = 4
INSTRUCTIONS, DATA = 1024, 256  # bytes of the caches
RAM = 0x20000000  # the emulated board's code and constants are below, its data above
NAMES = {"sl": 10, "fp": 11, "ip": 12, "sp": 13, "lr": 14, "pc": 15, **{f"r{k}": k for k in range(16)}}


class Flash:
    """The interface at a time that only grows: when the bytes of an address are there."""

    def __init__(self, line):
        self.line = line
        self.free = 0  # when the array can begin to read
        self.current = self.next = None  # (line, when it is there)
        self.instructions, self.data = {}, {}

    def _read(self, now):
        self.free = max(now, self.free) + 1 + WAIT
        return self.free - 1

    def _keep(self, cache, line, size):
        cache.pop(line, None)
        cache[line] = True
        if len(cache) > size // self.line:
            del cache[next(iter(cache))]

    def fetch(self, address, now):
        """When the instruction line of this address is there, not before `now`."""
        line = address // self.line
        if self.current and self.current[0] == line:
            return max(now, self.current[1])
        if self.next and self.next[0] == line:
            there = max(now, self.next[1])
        elif line in self.instructions:
            self._keep(self.instructions, line, INSTRUCTIONS)
            there = now
        else:
            there = self._read(now)
            self._keep(self.instructions, line, INSTRUCTIONS)
        self.current, self.next = (line, there), None
        if line + 1 not in self.instructions:
            self.next = (line + 1, self._read(there))
        return there

    def load(self, address, length, now):
        """When data of this many bytes are there."""
        there = now
        for line in range(address // self.line, (address + length - 1) // self.line + 1):
            if line not in self.data:
                there = self._read(there)
            self._keep(self.data, line, DATA)
        return there


def _load_of(mnemonic, operands, registers, address):
    """(address, bytes) of a load, or None."""
    if mnemonic.startswith("ldm"):
        base, names = operands.split(",", 1)
        return registers[NAMES[base.strip().rstrip("!")]], 4 * estimate.registers_in(names)
    if not mnemonic.startswith(("ldr", "vldr")):
        return None
    inside = re.search(r"\[(\w+)(?:, (#-?\d+|\w+)(?:, lsl #(\d+))?)?\]", operands)
    base = NAMES[inside.group(1)]
    at = (address + 4) & ~3 if base == 15 else registers[base]
    offset = inside.group(2) or "#0"
    at += int(offset[1:]) if offset[0] == "#" else registers[NAMES[offset]] << int(inside.group(3) or 0)
    return at & 0xFFFFFFFF, 8 if mnemonic == "ldrd" or operands.startswith("d") else 4


def calls_of(code, image, command, roots):
    """For each call of a root: (root, [(address, registers)]) of all that it executes."""
    start = {}
    for address, (_, _, _, function) in code.items():
        start.setdefault(function, address)
    inside, todo = set(), list(roots)
    while todo:
        function = todo.pop()
        if function in inside:
            continue
        inside.add(function)
        for _, mnemonic, operands, of in code.values():
            target = re.search(r"<(\w[\w.]*)>", operands) if of == function and mnemonic[0] == "b" else None
            if target and target.group(1) in start:
                todo.append(target.group(1))
    shown = inside | {function for function in start if estimate.MEASURED.match(function)}
    end = {function: max(a + length for a, (length, _, _, of) in code.items() if of == function) for function in shown}
    ranges = ",".join(f"{start[function]:#x}..{end[function] - 1:#x}" for function in shown)
    names = {start[root]: root for root in roots}
    with tempfile.NamedTemporaryFile("r", prefix="iqfoc-flash-") as log:
        subprocess.run(command + ["-kernel", str(image), "-singlestep", "-d", "exec,cpu,nochain", "-dfilter", ranges, "-D", log.name],
                       stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, timeout=1200, check=True)
        root, steps = None, []
        for line in log:
            at = re.match(r"Trace \d+: \S+ \[[0-9a-f]+/([0-9a-f]+)/", line)
            if at:
                address = int(at.group(1), 16)
                if code[address][3] not in inside:
                    if root:
                        yield root, steps
                    root = None
                elif address in names and root is None:
                    root, steps = names[address], []
                if root:
                    steps.append((address, []))
            elif root and line.startswith("R"):
                steps[-1][1].extend(int(value, 16) for value in re.findall(r"R\d\d=([0-9a-f]{8})", line))


def cycles_of(code, steps, line):
    """Cycles of one call; line None: from memory without wait states."""
    flash, now = line and Flash(line), 0
    for k, (address, registers) in enumerate(steps):
        length, mnemonic, operands, _ = code[address]
        if flash:
            now = max(flash.fetch(address, now), flash.fetch(address + length - 1, now))
            load = _load_of(mnemonic, operands, registers, address)
            if load and load[0] < RAM:
                now = flash.load(*load, now)
        taken = k + 1 == len(steps) or steps[k + 1][0] != address + length
        now += estimate.cycles(mnemonic, operands, taken)
    return now


# Each row's roots: the calls of one carrier period.
ROOTS = {"isr_cycle": ["bench_isr_cycle_valley", "bench_isr_cycle_peak"], "sample_to_duty": ["bench_isr_cycle_peak"],
         "handler_stm32g4": ["bench_handler", "bench_handler"]}


def evaluate(build, command):
    """{row: {a key of BANKS: cycles}}, means over the inputs of bench_trace."""
    image = build / "bench" / "bench_trace.elf"
    code = estimate.disassemble(image)
    found = {root: [] for roots in ROOTS.values() for root in roots}
    for root, steps in calls_of(code, image, command, sorted(found)):
        found[root].append([cycles_of(code, steps, line) for line in BANKS.values()])
    means = {root: [sum(call[k] for call in calls) / len(calls) for k in range(len(BANKS))] for root, calls in found.items()}
    return {row: {key: round(sum(means[root][k] for root in roots)) for k, key in enumerate(BANKS)} for row, roots in ROOTS.items()}
