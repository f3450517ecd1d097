#!/usr/bin/env python3
"""
The recorder's whole chain: an image in QEMU drives the plant with a hidden effect and records over its UART, `iqfoc record`
decodes that, `iqfoc diagnose` names the effect. And `iqfoc record` on every kind of line, whole and damaged.

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
        refused(program, folder)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
