#!/usr/bin/env python3
"""
Where the linker put the interrupt of the STM32G474's firmware: the handler, all that it calls, and their constants are in CCM SRAM, and
fit into that of the smaller parts. Reads the linked images; nothing runs. Called by tests/target/run.sh.
"""
import argparse
import pathlib
import re
import struct
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "bench"))
import elf32  # noqa: E402

CCM, FLASH = 0x10000000, 0x08000000
VECTOR = 16 + 18  # ADC1_2
# RM0440 2.4: KiB of CCM SRAM of the STM32G47x and G48x, of G491 and G4A1, of G431 and G441.
SIZES = {"STM32G474": 32, "STM32G491": 16, "STM32G431": 10}
# The images, and the smallest part whose CCM SRAM holds what they put there.
IMAGES = {"first_drive_stm32g4": "STM32G431", "corrected_drive_stm32g4": "STM32G431", "sensorless_drive_stm32g4": "STM32G491",
          "pattern_drive_stm32g4": "STM32G491"}

failures = []


def check(good, what):
    print(("ok    " if good else "FAIL  ") + what)
    if not good:
        failures.append(what)


class Image:
    def __init__(self, path):
        elf = elf32.read(path)
        self.data = path.read_bytes()
        self.sections = {section.name: section for section in elf.sections}
        self.functions = {symbol.value & ~1: symbol.name for symbol in elf.symbols if symbol.kind == elf32.STT_FUNC and symbol.section}
        self.calls, self.words = {}, {}
        self._disassemble(path)

    def _disassemble(self, path):
        """The branches out of each function, and the words in its literal pools."""
        text = subprocess.run(["arm-none-eabi-objdump", "-d", str(path)], capture_output=True, text=True, check=True).stdout
        function = None
        for line in text.split("\n"):
            head = re.match(r"([0-9a-f]{8}) <.*>:$", line)
            if head:
                function = int(head.group(1), 16)
                self.calls[function], self.words[function] = set(), set()
                continue
            branch = re.search(r"\tb[a-z]*(?:\.[nw])?\t([0-9a-f]+) <(?![^>]*\+0x)", line)
            word = re.search(r"\.word\t0x([0-9a-f]+)$", line)
            if branch:
                self.calls[function].add(int(branch.group(1), 16))
            elif word:
                self.words[function].add(int(word.group(1), 16))

    def exception(self, number):
        """The address of a handler."""
        at = self.sections[".vectors"].offset + 4 * number
        return struct.unpack_from("<I", self.data, at)[0] & ~1

    def reachable(self, root, without=frozenset()):
        """The functions that the root can reach by branches and by addresses in literal pools, but for some."""
        seen, todo = set(without), [root]
        while todo:
            function = todo.pop()
            if function in seen:
                continue
            seen.add(function)
            todo += self.calls[function]
            todo += [word & ~1 for word in self.words[function] if word & 1 and word & ~1 in self.functions]
        return seen - set(without)

    def outside(self, root):
        """What the root executes or reads by a constant address that is in flash."""
        found = []
        for function in self.reachable(root):
            found += [self.functions.get(function, hex(function))] if function < CCM else []
            found += [hex(word) for word in self.words[function] if FLASH <= word < FLASH + 0x80000]
        return sorted(found)


def main():
    parser = argparse.ArgumentParser(description=__doc__.strip().split("\n")[0])
    parser.add_argument("--build", type=pathlib.Path, required=True)
    options = parser.parse_args()
    for name, part in IMAGES.items():
        image = Image(options.build / "cortex-m4" / "examples" / f"{name}.elf")
        size = image.sections[".ccm"].size
        handler = image.exception(VECTOR)
        check(CCM <= handler < CCM + SIZES["STM32G474"] * 1024, f"{name}: the ADC's interrupt is at {handler:#x}, in CCM SRAM")
        functions = image.reachable(handler)
        check(len(functions) > 5, f"{name}: {len(functions)} functions are within its reach")
        outside = image.outside(handler)
        check(not outside, f"{name}: all of them and their constants are in CCM SRAM" + "".join(f", not {what}" for what in outside))
        check(size <= SIZES[part] * 1024, f"{name}: {size} bytes of CCM SRAM, within the {SIZES[part]} KiB of an {part}")
        main_at = next(at for at, function in image.functions.items() if function == "main")
        early = image.reachable(image.exception(1), {main_at})
        check(all(at < CCM for at in early), f"{name}: the start-up calls nothing in CCM SRAM before it is copied")
        check(image.outside(main_at), f"{name}: of main, which is in flash, the same search finds that")
    print(f"{len(failures)} failures")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
