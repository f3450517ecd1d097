"""Logs of packed binary rows: read back to the same recording, and one clear line for what is none. import_binary.py IQFOC"""

import math
import pathlib
import struct
import tempfile
import unittest

import foreign
import program

END, ESC = 0xC0, 0xDB
KINDS = {"u8": "B", "i8": "b", "u16": "H", "i16": "h", "u32": "I", "i32": "i", "f32": "f", "f64": "d"}
FIELDS = [("n", "u16"), ("t_us", "u32"), ("state", "u8"), ("i_alpha", "f32"), ("i_beta", "f64"), ("u_alpha", "i16"), ("u_beta", "i32"),
          ("enc", "u16"), ("omega", "f32"), ("spare", "i8")]
MAP = """[format]
type = "binary"
frame = "%s"
fields = [%s]
[columns]
t_s = { from = "t_us", scale = 1e-6 }
i_alpha_A = "i_alpha"
i_beta_A = "i_beta"
u_alpha_V = { from = "u_alpha", scale = 1e-3 }
u_beta_V = { from = "u_beta", scale = 1e-3 }
theta_e_rad = { from = "enc", unit = "count", per_turn = 65536 }
omega_e_rad_s = "omega"
[pwm]
periods_per_cycle = 8
held = "rotor"
delay_cycles = 0.04
[sensors]
shunts = "two_lowest"
"""
ROWS = [(k & 0xFFFF, 1000 + 200 * k, 192, 3.0 * math.cos(0.1 * k), 3.0 * math.sin(0.1 * k), round(4000 * math.cos(0.1 * k + 1)),
         round(-4000 * math.sin(0.1 * k)), (1043 * k + 219) & 0xFFFF, 500.25, -(k % 100)) for k in range(700)]


def pack(row, order="<"):
    return b"".join(struct.pack(order + KINDS[kind], value) for value, (_, kind) in zip(row, FIELDS))


def slip(frame):
    out = bytearray()
    for byte in frame:
        out += bytes([ESC, 0xDC]) if byte == END else bytes([ESC, 0xDD]) if byte == ESC else bytes([byte])
    return bytes(out) + bytes([END])


def map_text(frame, fields=FIELDS):
    return MAP % (frame, ", ".join(f'["{name}", "{kind}"]' for name, kind in fields))


class Binary(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        self.folder = pathlib.Path(self.scratch.name)

    def call(self, log, text):
        (self.folder / "log.raw").write_bytes(log)
        (self.folder / "map.toml").write_text(text)
        return program.run(["import", "log.raw", "--map", "map.toml", "-o", "rec.csv"], self.folder)

    def converted(self, log, text):
        done = self.call(log, text)
        self.assertEqual(done.returncode, 0, done.stderr.decode())
        return foreign.read_recording(self.folder / "rec.csv"), (self.folder / "rec.csv").read_text()

    def refused(self, words, log, text):
        done = self.call(log, text)
        line = done.stderr.decode()
        self.assertEqual(done.returncode, 2, line)
        self.assertEqual(line.count("\n"), 1, line)
        self.assertIn(words, line)
        self.assertFalse((self.folder / "rec.csv").exists())

    def assert_rows(self, got, rows=ROWS):
        self.assertEqual(len(got["t_s"]), len(rows))
        for k, row in enumerate(rows):
            alpha, beta = struct.unpack("<f", struct.pack("<f", row[3]))[0], row[4]
            self.assertAlmostEqual(got["i_a_A"][k], alpha, delta=1e-9)
            self.assertAlmostEqual(got["i_b_A"][k], -0.5 * alpha + math.sqrt(0.75) * beta, delta=1e-9)
            self.assertAlmostEqual(got["u_a_V"][k], 1e-3 * row[5], delta=1e-9)
            self.assertAlmostEqual(math.remainder(got["theta_e_rad"][k] - row[7] / 65536 * 2 * math.pi, 2 * math.pi), 0.0, delta=1e-9)
            self.assertEqual(got["omega_e_rad_s"][k], 500.25)
            self.assertAlmostEqual(got["t_s"][k], 1e-6 * row[1], delta=1e-12)

    def test_rows_of_all_types_come_back(self):
        got, text = self.converted(b"".join(map(pack, ROWS)), map_text("fixed"))
        self.assert_rows(got)
        self.assertIn('# [pwm] periods_per_cycle = 8, held = "rotor", delay_cycles = 0.04\n', text)
        self.assertIn('# [sensors] shunts = "two_lowest"\n', text)

    def test_slip_frames(self):
        self.assert_rows(self.converted(b"".join(slip(pack(row)) for row in ROWS), map_text("slip"))[0])

    def test_a_log_that_begins_and_ends_within_a_frame(self):
        log = b"".join(slip(pack(row)) for row in ROWS)
        self.assert_rows(self.converted(log[7:-5], map_text("slip"))[0], ROWS[1:-1])

    def test_bytes_of_the_other_order_behind_a_head(self):
        log = b"HEAD" + b"".join(pack(row, ">") for row in ROWS)
        self.assert_rows(self.converted(log, map_text("fixed").replace("[columns]", 'endian = "big"\nskip = 4\n[columns]'))[0])

    def test_what_is_no_such_log(self):
        log = b"".join(map(pack, ROWS))
        self.refused("frame 3 at byte", b"".join(slip(pack(row)) for row in ROWS[:2]) + slip(b"123") + slip(pack(ROWS[2])),
                     map_text("slip"))
        self.refused("is the log framed by SLIP?", slip(pack(ROWS[0])) + bytes([ESC, 1]) + slip(pack(ROWS[1])), map_text("slip"))
        self.refused("no row: 5 bytes", b"12345", map_text("fixed"))
        self.refused("i_alpha is not a finite number", pack((0, 0, 0, math.nan, 0, 0, 0, 0, 0, 0)) + log, map_text("fixed"))
        self.refused('is of type "f16", expected', log, map_text("fixed").replace('"f32"', '"f16"'))
        self.refused("is there twice", log, map_text("fixed", [("t_us", "u32"), ("t_us", "u32")]))
        self.refused("fields must list", log, map_text("fixed").replace("fields = [", "#"))
        self.refused("pairs", log, map_text("fixed").replace('["n", "u16"]', '["n"]'))
        self.refused("periods_per_cycle", log, map_text("fixed").replace("= 8", "= 0"))


if __name__ == "__main__":
    unittest.main(argv=[__file__])
