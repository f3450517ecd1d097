#!/usr/bin/env python3
"""
What the emulated board's image makes of configurations that the library refuses: it says so, and drives nothing by them.

Called by tests/target/run.sh. The frames are put together here from port/emulated/pil_wire.h, by other code than the program's.
"""
import argparse
import pathlib
import struct
import subprocess
import sys
import zlib

EMULATORS = {"cortex-m4": ["qemu-system-arm", "-M", "mps2-an386"],
             "rv32": ["qemu-system-riscv32", "-M", "virt", "-bios", "none"]}
OPTIONS = ["-semihosting-config", "enable=on,target=native", "-serial", "none", "-display", "none", "-monitor", "none", "-kernel"]
START, CYCLE, STARTED, COMMAND = 1, 2, 3, 4
WORDS = {STARTED: 1, COMMAND: 6}
OK, PREDICTOR, TIMES = 0, -2, -7
STATUS_GARBLED = 3  # what the image ends with where it is sent what it cannot use
TIME_LIMIT_S = 1200
ONE = 1 << 24

# The words of a configuration, in the order of pil_start_frame.
GOOD = {"k_u": ONE, "k_r": ONE // 100, "k_psi": ONE, "kp_d": ONE // 4, "kp_q": ONE // 4, "ki_d": ONE // 100, "ki_q": ONE // 100,
        "anti_windup": ONE // 4, "x_d": ONE, "x_q": ONE, "emf": ONE, "feedback": 0, "modulation": 0, "safe_state": 0,
        "span_max": ONE, "current_limit": 2 * ONE, "period": 1000, "tolerance": 100, "stale": 1000, "deadline": 1000, "trips": 0}

failures = []


def check(good, what):
    print(("ok    " if good else "FAIL  ") + what)
    if not good:
        failures.append(what)


def frame(kind, words):
    body = bytes([kind]) + struct.pack(f"<{len(words)}i", *words)
    return b"\x5a" + body + struct.pack("<I", zlib.crc32(body))


def start(**changes):
    return frame(START, [value - (1 << 32) if value >= 1 << 31 else value for value in {**GOOD, **changes}.values()])


def cycle(time):
    """A carrier period of a drive at rest: reference, and samples of valley and peak (pil_cycle_frame)."""
    def sample(at):
        return [0, 0, 0, 0, 0, 0, 0, 0, ONE, at, 0]
    return frame(CYCLE, [0, ONE // 10] + sample(time) + sample(time + 500))


class Board:
    """An image in its emulator; left with the emulator ended."""

    def __init__(self, target, image):
        self.process = subprocess.Popen(EMULATORS[target] + OPTIONS + [str(image)], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.stdin.close()
        self.process.kill()
        self.process.wait()

    def ask(self, question, kind):
        """The words of the answer, or None where the image ends instead."""
        self.process.stdin.write(question)
        self.process.stdin.flush()
        length = 2 + 4 * WORDS[kind] + 4
        answer = self.process.stdout.read(length)
        if len(answer) < length or answer[1] != kind or zlib.crc32(answer[1:-4]) != struct.unpack("<I", answer[-4:])[0]:
            return None
        return struct.unpack(f"<{WORDS[kind]}i", answer[2:-4])

    def end(self):
        return self.process.wait(TIME_LIMIT_S)


def drives(board):
    """Gates on within two periods."""
    return [board.ask(cycle(1000 * k), COMMAND) for k in range(2)][1][4] == 1


def try_board(target, image):
    with Board(target, image) as board:
        check(board.ask(start(), STARTED) == (OK,) and drives(board), f"{target}: drives by a good configuration")
        check(board.ask(start(k_u=0), STARTED) == (PREDICTOR,), f"{target}: names what is unfit in the next")
        check(board.ask(cycle(2000), COMMAND) is None and board.end() == STATUS_GARBLED, f"{target}: and drives no more")
    with Board(target, image) as board:
        check(board.ask(start(tolerance=(1 << 32) - 900), STARTED) == (TIMES,),
              f"{target}: refuses a period plus tolerance that wraps")
        check(board.ask(start(tolerance=(1 << 31) - 1000), STARTED) == (TIMES,), f"{target}: and one above 2^31 - 1")
        check(board.ask(start(tolerance=(1 << 31) - 1001), STARTED) == (OK,) and drives(board),
              f"{target}: takes the longest, and drives after refusals")


def main():
    parser = argparse.ArgumentParser(description=__doc__.strip().split("\n", maxsplit=1)[0])
    parser.add_argument("--build", type=pathlib.Path, required=True)
    options = parser.parse_args()
    for target in EMULATORS:
        try_board(target, options.build / target / "iqfoc_pil.elf")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
