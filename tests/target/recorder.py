#!/usr/bin/env python3
"""
The recorder's whole chain: an image in QEMU drives the plant with a hidden effect and records over its UART, `iqfoc record`
decodes that, `iqfoc diagnose` names the effect. And `iqfoc record` on every kind of line, whole and damaged; and a trigger that reaches the
running image over a terminal.

Called by tests/target/run.sh.
"""
import argparse
import csv
import json
import os
import pathlib
import pty
import random
import select
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import tty
import zlib

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
MOTOR = ROOT / "data" / "motors" / "jarzebowicz2019.toml"
SCENARIO = ROOT / "data" / "scenarios" / "identification.toml"
# What the drive has and its file does not say, and the cause that the diagnosis is to name.
HIDDEN = {"cortex-m4": ("dead_time:t_dead=1e-6,v_switch=1.5,v_diode=1.2", "dead_time"),
          "rv32": ("inductance:L=4.4e-3", "inductance")}
SEED = 20130611
END_FRAME = b"\x01\x03"  # version and type, docs/recorder-format.md
# One run that needs more voltage than there is from between 2 and 3 s on.
RAMP = """name = "ramp"
[[run]]
duration_s = 7.2
speed_rpm = { at_s = [0.0, 2.0, 3.0, 7.2], ramp = [7000.0, 7000.0, 10000.0, 10000.0] }
i_q_A = 8
"""
HEADER, ROWS, END, ANSWER = 1, 2, 3, 5  # frames
STATUS, RISES, VOLTAGE_LIMIT = 1, 2, 0x40
I_BETA, STATUS_WORD = 5, 22  # channels
MEMORY_WORDS = 80000  # pil_recorder.c

failures = []


def check(good, what):
    print(("ok    " if good else "FAIL  ") + what)
    if not good:
        failures.append(what)


def run(*command):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=1200, check=False)


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.reader(line for line in file if not line.startswith("#")))[1:]


def chain(program, folder, target):
    """The octets of the UART, and the recording made of them."""
    effect, cause = HIDDEN[target]
    uart, recording, verdict = folder / f"{target}.uart", folder / f"{target}.csv", folder / f"{target}.json"
    done = run(program, "simulate", "--motor", MOTOR, "--scenario", SCENARIO, "--target", target, "--uart", uart,
               "--effect", effect, "-o", folder / "host.csv")
    check(done.returncode == 0, f"{target}: drives the plant with a hidden effect {done.stderr.strip()}")
    done = run(program, "record", "--port", uart, "-o", recording)
    check(done.returncode == 0 and "0 damaged, 0 lost; 0 rows lost" in done.stderr, f"{target}: {done.stderr.strip()}")
    done = run(program, "diagnose", recording, "--motor", MOTOR, "--json", verdict)
    named = [c["id"] for c in json.loads(verdict.read_text())["causes"]] if verdict.exists() else []
    check(done.returncode == 0 and named[:1] == [cause], f"{target}: {cause} hidden, {named} named {done.stderr.strip()}")
    return uart.read_bytes(), rows_of(recording)


def record_from(program, folder, name, feed):
    """Runs `iqfoc record` on a line that `feed` serves; returns what it did and the rows."""
    out = folder / f"{name}.csv"
    ended = threading.Event()
    port, serve = feed(ended)
    thread = threading.Thread(target=serve, daemon=True)
    thread.start()
    done = run(program, "record", "--port", port, "-o", out, "--seconds", "600")
    ended.set()
    thread.join(timeout=10)
    return done, rows_of(out) if out.exists() else []


def over_pty(octets):
    """A pseudo-terminal with all octets; it does not translate, even before the reader says so."""
    def feed(ended):
        master, slave = pty.openpty()
        tty.setraw(slave)
        os.set_blocking(master, False)

        def serve():
            left = octets
            while left and not ended.is_set():
                if select.select([], [master], [], 0.1)[1]:
                    left = left[os.write(master, left[:512]):]
            # A line stays open until the recorder has seen the stream's end.
            ended.wait()
            os.close(slave)
            os.close(master)
        return os.ttyname(slave), serve
    return feed


def over_socket(folder, octets):
    def feed(_):
        path = folder / "line.socket"
        server = socket.socket(socket.AF_UNIX)
        server.bind(str(path))
        server.listen(1)

        def serve():
            connection, _ = server.accept()
            try:
                connection.sendall(octets)
            except OSError:
                pass  # the reader has what it wants
            connection.close()
            server.close()
            path.unlink()
        return path, serve
    return feed


def first_stream(octets):
    """What the file holds up to its first end frame, at which the recorder stops on a line."""
    at = 0
    for frame in octets.split(b"\xc0"):
        at += len(frame) + 1
        if frame[:2] == END_FRAME:
            return octets[:at]
    raise ValueError("no end frame")


def kinds_of_line(program, folder, octets, rows):
    """The first stream over a pseudo-terminal and a socket: the same rows as from the file."""
    octets = first_stream(octets)
    first = [row for row in rows if row[0] == "1"]
    for name, feed in (("pseudo-terminal", over_pty(octets)), ("socket", over_socket(folder, octets))):
        done, got = record_from(program, folder, name, feed)
        check(done.returncode == 0 and got == first, f"{name}: {len(got)} rows, those of the file {done.stderr.strip()}")


def damaged(program, folder, octets, rows):
    """A noisy line: rows go missing, none is invented, and each stretch ends where one is missing."""
    draw = random.Random(SEED)
    noisy = bytearray(octets)
    for _ in range(200):
        at = draw.randrange(len(noisy))
        how = draw.randrange(3)
        if how == 0:
            noisy[at] ^= 1 << draw.randrange(8)
        elif how == 1:
            del noisy[at:at + draw.randrange(1, 200)]
        else:
            noisy[at:at] = b"\r\nwatchdog: 17 ms\r\n"
    port, out = folder / "noisy.uart", folder / "noisy.csv"
    port.write_bytes(noisy)
    done = run(program, "record", "--port", port, "-o", out)
    known = {tuple(row[1:]) for row in rows}
    got = rows_of(out)
    check(done.returncode == 0 and len(got) < len(rows) and all(tuple(row[1:]) in known for row in got),
          f"noisy line: {len(got)} of {len(rows)} rows, none invented: {done.stderr.strip()}")
    step = 2e-4
    whole = all(a[0] != b[0] or abs(float(b[1]) - float(a[1]) - step) < 1e-9 for a, b in zip(got, got[1:]))
    check(whole, "noisy line: no stretch goes on over a gap")


class Terminal:
    """Both directions of the image's UART: whole frames as lists of words."""

    def __init__(self):
        self.master, self.slave = pty.openpty()
        tty.setraw(self.slave)
        self.rest, self.frames, self.damaged = b"", [], 0

    def close(self):
        os.close(self.master)
        os.close(self.slave)

    def of(self, kind):
        return [frame for frame in self.frames if frame[0] >> 8 & 0xFF == kind]

    def wait(self, kind, count=1):
        """The frames of a kind, once there are so many."""
        while len(self.of(kind)) < count:
            if not select.select([self.master], [], [], 100)[0]:
                raise TimeoutError(f"no frame of type {kind} in 100 s, {len(self.frames)} others")
            *pieces, self.rest = (self.rest + os.read(self.master, 65536)).split(b"\xc0")
            for piece in filter(None, pieces):
                octets = piece.replace(b"\xdb\xdc", b"\xc0").replace(b"\xdb\xdd", b"\xdb")
                whole = len(octets) % 4 == 0 and zlib.crc32(octets[:-4]).to_bytes(4, "little") == octets[-4:]
                self.damaged += not whole
                self.frames += [struct.unpack(f"<{len(octets) // 4 - 1}I", octets[:-4])] if whole else []
        return self.of(kind)

    def ask(self, sequence, trigger, bits, channel, level, share, decimation):
        octets = struct.pack("<HHIIIiII", 1 | 4 << 8, sequence, trigger, bits, channel, level, share, decimation)
        octets += zlib.crc32(octets).to_bytes(4, "little")
        os.write(self.master, b"\xc0" + octets.replace(b"\xdb", b"\xdb\xdd").replace(b"\xc0", b"\xdb\xdc") + b"\xc0")


def signed(word):
    return word - (1 << 32) if word >> 31 else word


def asked(program, folder, target, name, column, trigger, bits, level, fires):
    """A trigger that is set while the image runs: answered, then one memory full, with few rows before the first cycle that fires it."""
    scenario = folder / "ramp.toml"
    scenario.write_text(RAMP)
    line = Terminal()
    board = subprocess.Popen([program, "simulate", "--motor", MOTOR, "--scenario", scenario, "--target", target, "--uart",
                              os.ttyname(line.slave), "-o", folder / "terminal.csv"], stdout=subprocess.DEVNULL)
    try:
        line.wait(ROWS, 20)
        header = line.of(HEADER)[0]
        channels = [header[6 + 3 * k] for k in range(header[5])]
        at = channels.index(column)
        line.ask(0xC0DB, trigger, bits, at, level, 1 << 16, 2)
        answer = line.wait(ANSWER)[0]
        check(answer[2:] == (0, 0xC0DB, trigger, bits, at, level & 0xFFFFFFFF, 1 << 16, 2), f"{name}: answered, stream {answer[1]}")
        end = line.wait(END)[0]
    finally:
        board.terminate()
        board.wait()
        line.close()
    width = 1 + len(channels)
    rows = [frame[k:k + width] for frame in line.of(ROWS) if frame[1] == answer[1] for k in range(4, len(frame), width)]
    values = [signed(row[1 + at]) for row in rows]
    capacity = MEMORY_WORDS // width
    fired = [k for k in range(1, len(values)) if fires(values[k - 1], values[k])]
    check(line.damaged == 0 and end[1:] == (answer[1], 0, capacity) and len(rows) == capacity,
          f"{name}: {len(rows)} rows of {capacity}, {end[2]} lost, {line.damaged} frames damaged")
    check(fired and fired[0] <= capacity >> 8 and all(b[0] - a[0] == 2 for a, b in zip(rows, rows[1:])),
          f"{name}: it fires at row {fired[:1]}, at most {capacity >> 8} before it, every other cycle")


def requests(program, folder):
    asked(program, folder, "cortex-m4", "trigger by a status bit", STATUS_WORD, STATUS, VOLTAGE_LIMIT, 0,
          lambda before, at: not before & VOLTAGE_LIMIT and at & VOLTAGE_LIMIT)
    level = 1 << 22
    asked(program, folder, "rv32", "trigger by a current", I_BETA, RISES, 0, level, lambda before, at: before < level <= at)


def refused(program, folder):
    text = folder / "text"
    text.write_text("just text\n" * 100)
    future = folder / "future"
    # Version 2, type 3, and a right CRC.
    words = b"\x02\x03\x00\x00" + bytes(12)
    future.write_bytes(b"\xc0" + words + zlib.crc32(words).to_bytes(4, "little") + b"\xc0")
    for arguments, words in ((("--port", folder / "missing"), "cannot be opened"), (("--port", folder), "is a directory"),
                             (("--port", text), "no row received"), (("--port", future), "version 2"),
                             (("--port", text, "--baud", "x"), "--baud")):
        done = run(program, "record", *arguments, "-o", folder / "refused.csv")
        check(done.returncode == 2 and words in done.stderr and not (folder / "refused.csv").exists(),
              f"refused: {done.stderr.strip().splitlines()[-1]}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.strip().split("\n")[0])
    parser.add_argument("--build", type=pathlib.Path, required=True)
    options = parser.parse_args()
    program = options.build / "host" / "iqfoc"
    with tempfile.TemporaryDirectory(prefix="iqfoc-recorder-") as name:
        folder = pathlib.Path(name)
        for target in HIDDEN:
            octets, rows = chain(program, folder, target)
        kinds_of_line(program, folder, octets, rows)
        damaged(program, folder, octets, rows)
        requests(program, folder)
        refused(program, folder)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
