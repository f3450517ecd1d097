"""`iqfoc import` as its user meets it: another program's log, a map, a recording, a diagnosis."""

import gzip
import json
import math
import pathlib
import tempfile
import unittest

import foreign
import program

RECORDINGS = program.ROOT / "data" / "recordings"
PAIRS = 3


class Folder(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.scratch.name)

    def tearDown(self):
        self.scratch.cleanup()

    def write(self, name, content):
        (self.folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())

    def run_ok(self, *arguments):
        done = program.run(arguments, self.folder)
        self.assertEqual(done.returncode, 0, done.stderr.decode())
        return done

    def refused(self, words, *arguments):
        before = sorted(p.name for p in self.folder.iterdir())
        done = program.run(arguments, self.folder)
        line = done.stderr.decode()
        self.assertEqual(done.returncode, 2, line)
        self.assertEqual(line.count("\n"), 1, line)
        self.assertIn(words, line)
        self.assertEqual(before, sorted(p.name for p in self.folder.iterdir()))
        return line

    def convert(self, log, map_text, *more):
        self.write("log.txt", log)
        self.write("map.toml", map_text)
        self.run_ok("import", "log.txt", "--map", "map.toml", "-o", "rec.csv", *more)
        return foreign.read_recording(self.folder / "rec.csv")

    def assert_columns(self, got, expected, names, tolerance=1e-9):
        for name in names:
            self.assertEqual(len(got[name]), len(expected[name]), name)
            worst = max(abs(x - y) for x, y in zip(got[name], expected[name]))
            self.assertLess(worst, tolerance, name)


def causes(done):
    return [c["id"] for c in json.loads(done.stdout)["causes"]]


MOTOR = program.MOTOR

# A map in which a recording's own names stand, to be varied.
PLAIN = """[columns]
run = "run"
t_s = "t_s"
i_a_A = "i_a_A"
i_b_A = "i_b_A"
i_c_A = "i_c_A"
theta_e_rad = "theta_e_rad"
omega_e_rad_s = "omega_e_rad_s"
u_a_V = "u_a_V"
u_b_V = "u_b_V"
u_c_V = "u_c_V"
"""


class AsAUser(Folder):
    """Semicolons, decimal comma, dq currents in mA, compare counts, encoder counts, no speed."""

    COUNTS = 5000
    LINES = 16384

    def foreign_log(self, rec):
        i = foreign.dq(rec, foreign.I_ABC)
        # The angle as an encoder's counts of one mechanical turn, which the motor's three pole pairs divide.
        theta = unwrapped(rec)
        columns = {
            "Segment": foreign.run_of(rec),
            "Zeit": [round(1000.0 * t, 4) for t in rec["t_s"]],
            "Id": [round(1000.0 * d, 1) for d, _ in i],
            "Iq": [round(1000.0 * q, 1) for _, q in i],
            **self.commands(rec),
            "Enc": [round(th / PAIRS / (2 * math.pi) * self.LINES + 100) % self.LINES for th in theta],
        }
        ahead = "Pr\u00fcfstand 3\nMotor;2,2 kW\n\n"
        units = {"Zeit": "ms", "Id": "mA", "Iq": "mA", "Udc": "V", "Enc": "count", "Uab": "V", "Ubc": "V"}
        return foreign.table(columns, ";", ",", ahead, [units.get(n, "") for n in columns], "\r\n")

    def commands(self, rec):
        """Compare counts; voltages from line to line where the recording has no duties."""
        if "d_a" not in rec:
            a, b, c = (rec[n] for n in foreign.U_ABC)
            return {"Uab": [x - y for x, y in zip(a, b)], "Ubc": [x - y for x, y in zip(b, c)]}
        counts = {f"CCR{n}": [round(self.COUNTS * d) for d in rec[x]] for n, x in enumerate(("d_a", "d_b", "d_c"), 1)}
        return {**counts, "Udc": rec["u_dc_V"]}

    LINES_MAP = 'u_ab_V = "Uab"\nu_bc_V = "Ubc"\n'

    MAP = """[columns]
run = "Segment"
t_s = { from = "Zeit", unit = "ms" }
i_d_A = { from = "Id", unit = "mA" }
i_q_A = { from = "Iq", scale = 1e-3 }
d_a = "CCR1"
d_b = "CCR2"
d_c = "CCR3"
u_dc_V = "Udc"
theta_e_rad = { from = "Enc", unit = "count", per_turn = 16384, mechanical = true, zero = 100 }
[pwm]
frame = 5000
"""

    def test_import_then_diagnose_names_the_same(self):
        for name in ("dead_time", "saliency"):
            rec = foreign.whole(foreign.read_recording(RECORDINGS / f"{name}.csv.gz"))
            self.write("log.csv", self.foreign_log(rec).encode("latin-1"))
            pwm = self.MAP[self.MAP.index('d_a ='):self.MAP.index("theta")]
            self.write("map.toml", self.MAP if "d_a" in rec else self.MAP.replace(pwm, self.LINES_MAP).split("[pwm]")[0])
            motor = RECORDINGS / f"{name}.toml"
            self.run_ok("import", "log.csv", "--map", "map.toml", "--motor", motor, "-o", "rec.csv")
            own = self.run_ok("diagnose", RECORDINGS / f"{name}.csv.gz", "--motor", motor, "--json", "-")
            other = self.run_ok("diagnose", "rec.csv", "--motor", motor, "--json", "-")
            self.assertEqual(causes(own), causes(other))
            self.assertEqual(causes(own), [name])

    def test_heads_in_german_and_french(self):
        """Units in brackets; a duty in percent is no count; a column that no quantity takes is listed."""
        heads = {
            "Zeit [ms];Strom A [A];Strom B [A];Tastgrad A [%];Tastgrad B [%];Tastgrad C [%];Uzk [V];Rotorwinkel [deg];Drehzahl [U/min];Gang":
                ("Tastgrad A [%]", "Uzk [V]", "Rotorwinkel [deg]", "Drehzahl [U/min]", "Gang"),
            "temps [ms];courant A [A];courant B [A];rapport cyclique A [%];rapport cyclique B [%];rapport cyclique C [%];tension bus [V];"
            "angle rotor [deg];vitesse [tr/min];marche":
                ("rapport cyclique A [%]", "tension bus [V]", "angle rotor [deg]", "vitesse [tr/min]", "marche"),
        }
        for head, (duty, link, angle, speed, unused) in heads.items():
            self.write("log.csv", head + "\n" + "".join(f"{k};1;2;50;40;60;24;{k};300;3\n" for k in range(4)))
            text = self.run_ok("import", "log.csv").stdout.decode()
            for line in (f'd_a = {{ from = "{duty}", unit = "percent" }}', f'u_dc_V = {{ from = "{link}" }}',
                         f'theta_e_rad = {{ from = "{angle}", unit = "deg", mechanical = true }}',
                         f'omega_e_rad_s = {{ from = "{speed}", unit = "rpm", mechanical = true }}',
                         f'# columns that are not used: "{unused}"'):
                self.assertIn(line + "\n", text)
            self.assertNotIn("[pwm]", text)
            self.assertNotIn("missing", text)

    def test_the_proposal_is_nearly_the_map(self):
        rec = foreign.without_common(foreign.read_recording(RECORDINGS / "dead_time.csv.gz", 300), foreign.I_ABC)
        self.write("log.csv", self.foreign_log(rec).encode("latin-1"))
        done = self.run_ok("import", "log.csv")
        text = done.stdout.decode()
        for line in ('delimiter = ";"', 'decimal = ","', 't_s = { from = "Zeit", unit = "ms" }',
                     'i_q_A = { from = "Iq", unit = "mA" }', 'd_c = { from = "CCR3" }', "[pwm]",
                     'theta_e_rad = { from = "Enc", unit = "count", per_turn = 4096, mechanical = true }',
                     "omega_e_rad_s is not in the log"):
            self.assertIn(line, text)
        self.assertNotIn("missing", text)
        # It is a map: with the two guesses corrected it makes the recording.
        self.write("map.toml", text.replace("per_turn = 4096", "per_turn = 16384, zero = 100").replace(
            text[text.index("frame = "):text.index("inverted")], "frame = 5000\n"))
        self.run_ok("import", "log.csv", "--map", "map.toml", "--motor", RECORDINGS / "dead_time.toml", "-o", "rec.csv")
        got = foreign.read_recording(self.folder / "rec.csv")
        self.assert_columns(got, rec, ("i_a_A", "i_b_A"), 0.004)  # 16384 counts a turn, 6 A
        self.assert_columns(got, rec, ("d_a", "d_b", "d_c"), 1.01e-4)


def unwrapped(rec):
    out = [rec["theta_e_rad"][0]]
    for last, now in zip(rec["theta_e_rad"], rec["theta_e_rad"][1:]):
        out.append(out[-1] + math.remainder(now - last, 2 * math.pi))
    return out


class RoundTrips(Folder):
    """Each kind of map brings the same recording back."""

    @classmethod
    def setUpClass(cls):
        cls.rec = foreign.read_recording(RECORDINGS / "dead_time.csv.gz", 400)
        for names in (foreign.I_ABC, foreign.U_ABC):
            foreign.without_common(cls.rec, names)

    def columns(self, **changed):
        keep = {k: self.rec[k] for k in ("run", "t_s", *foreign.I_ABC, "theta_e_rad", "omega_e_rad_s", *foreign.U_ABC)}
        keep.update(changed)
        return {k: v for k, v in keep.items() if v is not None}

    def same(self, columns, map_text, *more, tolerance=1e-9, names=None, **form):
        got = self.convert(foreign.table(columns, **form), map_text, *more)
        self.assert_columns(got, self.rec, names or ("run", "t_s", *foreign.I_ABC, "theta_e_rad", "omega_e_rad_s",
                                                     *foreign.U_ABC), tolerance)
        return got

    def test_own_names(self):
        self.same(self.columns(), PLAIN)

    def test_every_delimiter_and_mark(self):
        for delimiter, decimal in ((";", ","), (";", "."), ("\t", ","), ("\t", "."), (" ", "."), (" ", ","), (",", ".")):
            self.same(self.columns(), PLAIN, delimiter=delimiter, decimal=decimal)
        said = PLAIN + '[format]\ndelimiter = "tab"\ndecimal = ","\nencoding = "utf-8"\nskip = 2\n'
        self.same(self.columns(), said, delimiter="\t", decimal=",", ahead="1\t2\n3\t4\n")

    def test_aligned_by_blanks(self):
        text = foreign.table(self.columns(), " ").replace(" ", "    ").replace("\n", " \n  ")
        got = self.convert("  " + text, PLAIN)
        self.assert_columns(got, self.rec, ("t_s", "u_c_V"))

    def test_every_encoding_and_line_end(self):
        name = "Dr\u00e4hzahl \u00b5"
        text = foreign.table({**self.columns(), name: self.rec["t_s"]}, ahead="\u00dcberschrift\n")
        for end in ("\n", "\r\n", "\r"):
            lines = text.replace("\n", end)
            for raw in (lines.encode(), b"\xef\xbb\xbf" + lines.encode(), lines.encode("latin-1"),
                        b"\xff\xfe" + lines.encode("utf-16-le"), b"\xfe\xff" + lines.encode("utf-16-be"),
                        gzip.compress(lines.encode("utf-16"))):
                got = self.convert(raw, PLAIN + f'temp_C = "{name}"\n')
                self.assert_columns(got, {**self.rec, "temp_C": self.rec["t_s"]}, ("u_c_V", "temp_C"))
        for encoding in ("utf-16-le", "latin-1"):
            said = f'[format]\nencoding = "{encoding.replace("16-", "16")}"\n'
            self.assert_columns(self.convert(text.encode(encoding), said + PLAIN), self.rec, ("u_c_V",))

    def test_quotes(self):
        quoted = "\n".join(",".join(f'"{x}"' for x in line.split(";"))
                           for line in foreign.table(self.columns(), ";", ",").splitlines())
        self.assert_columns(self.convert(quoted, PLAIN), self.rec, ("t_s", "i_c_A"))

    def test_a_delimiter_at_the_end_and_words_between(self):
        text = foreign.table(self.columns()).replace("\n", ",ok,\n").replace("u_c_V,ok,", "u_c_V,state,")
        self.assert_columns(self.convert(text + "\n", PLAIN), self.rec, ("t_s", "u_c_V"))

    def test_scale_offset_and_units(self):
        columns = self.columns(t_s=[1e6 * t for t in self.rec["t_s"]], i_a_A=[(x - 3.0) / -2.0 for x in self.rec["i_a_A"]],
                               u_b_V=[x / 1e3 for x in self.rec["u_b_V"]],
                               omega_e_rad_s=[w * 60 / (2 * math.pi) / PAIRS for w in self.rec["omega_e_rad_s"]],
                               theta_e_rad=[math.degrees(th) / PAIRS + 7 for th in self.rec["theta_e_rad"]])
        text = (PLAIN.replace('t_s = "t_s"', 't_s = { from = "t_s", unit = "us" }')
                .replace('"i_a_A"', '{ from = "i_a_A", scale = -2, offset = 3.0 }')
                .replace('"u_b_V"', '{ from = "u_b_V", unit = "kV" }')
                .replace('"omega_e_rad_s"', '{ from = "omega_e_rad_s", unit = "rpm", mechanical = true }')
                .replace('"theta_e_rad"', '{ from = "theta_e_rad", unit = "deg", zero = 7, mechanical = true }'))
        self.write("motor.toml", MOTOR)
        got = self.same(columns, text, "--motor", "motor.toml")
        self.assert_columns(got, {"theta_mech_rad": [th / PAIRS for th in self.rec["theta_e_rad"]]}, ("theta_mech_rad",))
        self.refused("theta_e_rad is mechanical: --motor", "import", "log.txt", "--map", "map.toml", "-o", "other.csv")

    def test_angle_in_turns_and_speed_in_hertz(self):
        columns = self.columns(theta_e_rad=[th / (2 * math.pi) for th in self.rec["theta_e_rad"]],
                               omega_e_rad_s=[w / (2 * math.pi) for w in self.rec["omega_e_rad_s"]])
        self.same(columns, PLAIN.replace('"theta_e_rad"', '{ from = "theta_e_rad", unit = "turn" }')
                  .replace('"omega_e_rad_s"', '{ from = "omega_e_rad_s", unit = "Hz" }'))

    def test_two_phases_of_any(self):
        for absent in foreign.I_ABC:
            got = self.convert(foreign.table(self.columns(**{absent: None})),
                               PLAIN.replace(f'{absent} = "{absent}"\n', ""))
            here = [x for x in foreign.I_ABC if x in got]
            self.assert_columns(got, self.rec, here)
            self.assertNotIn("i_c_A", got)

    def vector_map(self, what, first, second):
        letter = "i" if what is foreign.I_ABC else "u"
        unit = "A" if letter == "i" else "V"
        text = "".join(line for line in PLAIN.splitlines(True) if not line.startswith(f"{letter}_"))
        return text + f'{letter}_{first}_{unit} = "x"\n{letter}_{second}_{unit} = "y"\n'

    def test_vectors(self):
        for what in (foreign.I_ABC, foreign.U_ABC):
            for frame, (first, second) in ((foreign.dq, ("d", "q")), (foreign.vectors, ("alpha", "beta"))):
                pairs = frame(self.rec, what)
                columns = self.columns(x=[p[0] for p in pairs], y=[p[1] for p in pairs], **dict.fromkeys(what))
                names = ("t_s", "i_a_A", "i_b_A", *foreign.U_ABC)
                self.same(columns, self.vector_map(what, first, second), names=names)

    def test_voltages_turned_by_an_angle_ahead(self):
        step = self.rec["t_s"][1] - self.rec["t_s"][0]
        angle = [th + 1.5 * step * w for th, w in zip(self.rec["theta_e_rad"], self.rec["omega_e_rad_s"])]
        pairs = [foreign.park(x, y, th) for (x, y), th in zip(foreign.vectors(self.rec, foreign.U_ABC), angle)]
        columns = self.columns(x=[p[0] for p in pairs], y=[p[1] for p in pairs], **dict.fromkeys(foreign.U_ABC))
        text = self.vector_map(foreign.U_ABC, "d", "q").replace('u_d_V = "x"', 'u_d_V = { from = "x", ahead = 1.5 }')
        self.same(columns, text, tolerance=1e-6)

    def test_line_to_line(self):
        a, b, c = (self.rec[n] for n in foreign.U_ABC)
        lines = {"u_ab_V": [x - y for x, y in zip(a, b)], "u_bc_V": [x - y for x, y in zip(b, c)],
                 "u_ca_V": [x - y for x, y in zip(c, a)]}
        plain = "".join(line for line in PLAIN.splitlines(True) if not line.startswith("u_"))
        for names in (list(lines), ["u_ab_V", "u_bc_V"], ["u_bc_V", "u_ca_V"], ["u_ab_V", "u_ca_V"]):
            columns = self.columns(**dict.fromkeys(foreign.U_ABC), **{n: lines[n] for n in names})
            self.same(columns, plain + "".join(f'{n} = "{n}"\n' for n in names))

    def test_voltages_against_the_rail_lose_their_common_part(self):
        columns = self.columns(**{n: [x + 200.0 for x in self.rec[n]] for n in foreign.U_ABC})
        self.same(columns, PLAIN)

    def test_counts(self):
        plain = "".join(line for line in PLAIN.splitlines(True) if not line.startswith("u_"))
        plain += 'd_a = "d_a"\nd_b = "d_b"\nd_c = "d_c"\n'
        duties = {n: self.rec[n] for n in ("d_a", "d_b", "d_c")}
        forms = (("frame = 4000", lambda d: 4000 * d), ("frame = 4000\ninverted = true", lambda d: 4000 * (1 - d)),
                 ("frame = 2\ncentre = 0", lambda d: 2 * d - 1), ("frame = 1000\ncentre = 700", lambda d: 1000 * (d - 0.5) + 700))
        for pwm, law in forms:
            columns = self.columns(**dict.fromkeys(foreign.U_ABC), **{n: list(map(law, v)) for n, v in duties.items()})
            text = plain + f"[pwm]\n{pwm}\n[fixed]\nu_dc_V = 565\n"
            got = self.same(columns, text, names=("d_a", "d_b", "d_c"))
            self.assertEqual(set(got["u_dc_V"]), {565.0})
        percent = self.columns(**dict.fromkeys(foreign.U_ABC), **{n: [100 * d for d in v] for n, v in duties.items()})
        text = plain + "[fixed]\nu_dc_V = 565\n"
        for n in duties:
            text = text.replace(f'{n} = "{n}"', f'{n} = {{ from = "{n}", unit = "percent" }}')
        self.same(percent, text, names=("d_a", "d_b", "d_c"))

    def test_rate_instead_of_time(self):
        columns = self.columns(t_s=None, run=None)
        text = PLAIN.replace('t_s = "t_s"\n', "").replace('run = "run"\n', "") + "[timing]\nrate_Hz = 4000\n"
        got = self.convert(foreign.table(columns), text)
        self.assert_columns(got, {"t_s": [k / 4000 for k in range(400)]}, ("t_s",))

    def test_rounded_stamps_go_onto_the_grid(self):
        columns = self.columns(t_s=[round(t, 3) for t in self.rec["t_s"]])
        self.refused("is there twice", *self.prepare(columns, PLAIN))
        got = self.convert(foreign.table(self.columns(t_s=[round(t, 4) for t in self.rec["t_s"]])),
                           PLAIN + "[timing]\nrate_Hz = 4000\n")
        self.assert_columns(got, self.rec, ("t_s",))

    def prepare(self, columns, text):
        self.write("log.txt", foreign.table(columns))
        self.write("map.toml", text)
        return "import", "log.txt", "--map", "map.toml", "-o", "rec.csv"

    def test_speed_from_the_angle(self):
        wrapped = [math.remainder(th, 2 * math.pi) for th in self.rec["theta_e_rad"]]
        got = self.convert(foreign.table(self.columns(omega_e_rad_s=None, theta_e_rad=wrapped)),
                           PLAIN.replace('omega_e_rad_s = "omega_e_rad_s"\n', ""))
        mean = sum(self.rec["omega_e_rad_s"]) / len(self.rec["omega_e_rad_s"])
        self.assert_columns(got, self.rec, ("omega_e_rad_s",), 0.02 * abs(mean))
        self.assertGreater(max(map(abs, got["omega_e_rad_s"])), 0.5 * abs(mean))

    def test_what_is_fixed(self):
        text = PLAIN.replace('omega_e_rad_s = "omega_e_rad_s"\n', "").replace('theta_e_rad = "theta_e_rad"\n', "")
        columns = self.columns(omega_e_rad_s=None, theta_e_rad=None)
        got = self.convert(foreign.table(columns), text + "[fixed]\ntheta_e_rad = 0.25\n")
        self.assertEqual((set(got["theta_e_rad"]), set(got["omega_e_rad_s"])), ({0.25}, {0.0}))
        got = self.convert(foreign.table(self.columns(omega_e_rad_s=None)),
                           PLAIN.replace('omega_e_rad_s = "omega_e_rad_s"\n', "") + "[fixed]\nomega_e_rad_s = 50\n")
        self.assertEqual(set(got["omega_e_rad_s"]), {50.0})

    def test_shift(self):
        """The command in row k of the log acts from cycle k + shift on."""
        one = {k: (v[:200] if k != "run" else [1.0] * 200) for k, v in self.rec.items()}
        for shift, law in ((1, lambda u, k: u[k - 1]), (2, lambda u, k: u[k - 2]), (-1, lambda u, k: u[k + 1]),
                           (0.5, lambda u, k: (u[k] + u[k - 1]) / 2), (1.5, lambda u, k: (u[k - 1] + u[k - 2]) / 2),
                           (-0.5, lambda u, k: (u[k] + u[k + 1]) / 2)):
            columns = {k: one[k] for k in self.columns()}
            got = self.convert(foreign.table(columns), PLAIN + f"[timing]\nshift_cycles = {shift}\n")
            first = max(0, math.ceil(shift))
            last = 200 + min(0, math.floor(shift))
            self.assert_columns(got, {k: v[first:last] for k, v in one.items()}, ("t_s", "i_b_A", "theta_e_rad"))
            self.assert_columns(got, {"u_b_V": [law(one["u_b_V"], k) for k in range(first, last)]}, ("u_b_V",))
        duties = "".join(line for line in PLAIN.splitlines(True) if not line.startswith("u_"))
        duties += 'd_a = "d_a"\nd_b = "d_b"\nd_c = "d_c"\nu_dc_V = "u_dc_V"\n'
        columns = {k: one[k] for k in (*self.columns(), "d_a", "d_b", "d_c", "u_dc_V") if k not in foreign.U_ABC}
        got = self.convert(foreign.table(columns), duties + "[timing]\nshift_cycles = 1\n")
        self.assert_columns(got, {"d_a": one["d_a"][:-1]}, ("d_a",))
        got = self.convert(foreign.table(columns), duties + "[timing]\nshift_cycles = 0.5\n")
        self.assertNotIn("d_a", got)
        self.assertIn("u_a_V", got)


LOG = """t_s,i_a_A,i_b_A,theta_e_rad,u_a_V,u_b_V,u_c_V,d
0,1,2,0.1,5,-2,-3,0.5
0.00025,1,2,0.2,5,-2,-3,0.5
0.0005,1,2,0.3,5,-2,-3,1.5
"""
MAP = """[columns]
t_s = "t_s"
i_a_A = "i_a_A"
i_b_A = "i_b_A"
theta_e_rad = "theta_e_rad"
u_a_V = "u_a_V"
u_b_V = "u_b_V"
u_c_V = "u_c_V"
"""
DUTIES = MAP.replace('u_a_V = "u_a_V"\nu_b_V = "u_b_V"\nu_c_V = "u_c_V"\n', 'd_a = "d"\nd_b = "d"\nd_c = "d"\n')

# (log, map, words). The good log and map are tried too, so that each of these is refused for what it changes.
REFUSED = [
    (LOG, MAP.replace('"i_b_A"', '"i_bA"'), 'map.toml:4:9: i_b_A: log.txt has no column "i_bA"; did you mean "i_b_A"?'),
    (LOG, MAP.replace('"i_b_A"', '"bridge"'), 'has no column "bridge"; it has t_s, i_a_A'),
    (LOG, MAP.replace("i_b_A =", "i_x_A ="), "map.toml:4:1: unknown key i_x_A in [columns]"),
    (LOG, MAP.replace('"i_b_A"', '{ form = "i_b_A" }'), "i_b_A: from is missing"),
    (LOG, MAP.replace('"i_b_A"', '{ from = "i_b_A", scale = 0 }'), "scale must not be 0"),
    (LOG, MAP.replace('"i_b_A"', '{ from = "i_b_A", unit = "V" }'), 'unit must be "A", "mA" or "kA", not text "V"'),
    (LOG, MAP.replace('"theta_e_rad"', '{ from = "theta_e_rad", unit = "count" }'), "per_turn is missing"),
    (LOG, MAP.replace('theta_e_rad = "theta_e_rad"\n', ""), "[columns] lacks the angle"),
    (LOG, MAP.replace('t_s = "t_s"\n', "").replace('u_c_V = "u_c_V"\n', "").replace('i_a_A = "i_a_A"\n', ""),
     "lacks the time (t_s, or [timing] rate_Hz), the currents"),
    (LOG, "t_s = 1\n", "columns is missing"),
    (LOG, MAP + "[timing]\ndecimation = 10\n", "map.toml:10: every 10th cycle only: the commands between two rows are not in"),
    (LOG, MAP + "[timing]\nshift_cycles = 0.3\n", "shift_cycles must be whole or half cycles, not 0.3"),
    (LOG, MAP + "[timing]\nrate_Hz = 0\n", "rate_Hz must be a number > 0"),
    (LOG, MAP + "[format]\ndelimiter = \"|\"\n", 'delimiter must be ",", ";", "tab" or "blank"'),
    (LOG, MAP + "[format]\ndelimiter = \";\"\n", "log.txt:1: no rows of numbers are found"),
    (LOG, MAP + "[timing]\nrate_Hz = 100\n", "more rows than rate_Hz = 100 has cycles"),
    (LOG, DUTIES, "lacks the DC link of the duties"),
    (LOG, DUTIES + "[fixed]\nu_dc_V = 48\n", "log.txt:4: d_a is a duty of 1.5, outside 0 to 1: for compare counts"),
    (LOG, DUTIES + "[fixed]\nu_dc_V = 48\n[pwm]\nframe = 1.2\n", "are frame and centre of [pwm] right?"),
    (LOG, DUTIES + "[fixed]\nu_dc_V = 0\n", "u_dc_V must be a number > 0"),
    (LOG.replace("0.2,5", "x,5"), MAP, 'log.txt:3:13: theta_e_rad "x" is no finite number (decimal mark ".")'),
    (LOG.replace("0.2,5", ",5"), MAP, 'log.txt:3:13: theta_e_rad "" is no finite number'),
    (LOG.replace("0.2,5", "nan,5"), MAP, 'theta_e_rad "nan" is no finite number'),
    (LOG.replace("0.2,5", "1e999,5"), MAP, 'theta_e_rad "1e999" is no finite number'),
    (LOG.replace("0.3,5,-2,-3,1.5\n", "0.3,5,"), MAP, "log.txt:4:1: the row has 6 fields, the header has 8; is the file cut off?"),
    (LOG.replace("0.2,5", '"0.2,5'), MAP, "log.txt:3: a quoted field has no end on its line"),
    (LOG.replace("0.00025", "0"), MAP, "log.txt:3: the time 0 s is there twice"),
    (LOG.replace("0.0005,", "0.0001,"), MAP, "log.txt:4: the time 0.0001 s does not rise"),
    ("", MAP, "log.txt: the log is empty"),
    ("t_s,i_a_A\n", MAP, "no rows of numbers"),
    (b"\xff\xfe" + LOG.encode("utf-16-le")[:-1], MAP, "the file ends within a UTF-16 character"),
    (LOG.replace("t_s,", "t_s\u00e9,").encode("latin-1"), MAP + '[format]\nencoding = "utf-8"\n', "log.txt:1: the line is not UTF-8"),
    (gzip.compress(LOG.encode() * 500)[:-20], MAP, "gzip data is cut or damaged"),
    (b"7" * (3 << 20), MAP, "the line is longer than 1 MiB"),
]


class Refusals(Folder):
    CALL = ("import", "log.txt", "--map", "map.toml", "-o", "rec.csv")

    def test_the_good_ones_are_taken(self):
        self.convert(LOG, MAP)
        self.convert(LOG.replace("1.5", "1"), DUTIES + "[fixed]\nu_dc_V = 48\n")
        self.convert(LOG, MAP + "[timing]\nrate_Hz = 4000\ndecimation = 1\nshift_cycles = 0.5\n")

    def test_bad_rows_are_left_out_on_request(self):
        self.write("log.txt", LOG.replace("0.2,5", "x,5") + "".join(f"{k * 0.00025},1,2,0.4,5,-2,-3,1\n" for k in range(3, 9)) + "0.00225\n")
        self.write("map.toml", MAP)
        self.refused("log.txt:3:13", *self.CALL)
        done = self.run_ok(*self.CALL, "--skip-bad")
        self.assertIn('2 rows left out; the first: log.txt:3:13: theta_e_rad "x"', done.stderr.decode())
        self.assertEqual(len(foreign.read_recording(self.folder / "rec.csv")["t_s"]), 8)
        self.write("map.toml", MAP.replace('t_s = "t_s"\n', "") + "[timing]\nrate_Hz = 4000\n")
        (self.folder / "rec.csv").unlink()
        self.refused("--skip-bad needs t_s", *self.CALL, "--skip-bad")

    def test_each(self):
        for log, text, words in REFUSED:
            with self.subTest(words=words):
                self.write("log.txt", log)
                self.write("map.toml", text)
                self.refused(words, *self.CALL)

    def test_rows_further_apart_than_the_motors_cycle(self):
        self.write("log.txt", LOG)
        self.write("map.toml", MAP)
        self.write("motor.toml", MOTOR.replace("f_pwm_Hz = 4000", "f_pwm_Hz = 40000"))
        self.refused("10 cycles of motor.toml", *self.CALL, "--motor", "motor.toml")
        self.write("motor.toml", MOTOR)
        self.run_ok(*self.CALL, "--motor", "motor.toml")

    def test_usage(self):
        self.write("log.txt", LOG)
        self.write("map.toml", MAP)
        for words, arguments in (("no log is given", ()), ("`iqfoc import LOG > MAP.toml` proposes one", ("log.txt", "-o", "r.csv")),
                                 ("--output REC.csv is missing", ("log.txt", "--map", "map.toml")),
                                 ("exclude each other", ("log.txt", "--map", "map.toml", "--preset", "vesc")),
                                 ('no preset "odrve"; did you mean odrive?', ("log.txt", "--preset", "odrve")),
                                 ("there are vesc, odrive", ("log.txt", "--preset", "none of them")),
                                 ("absent.txt: cannot be read", ("absent.txt",)),
                                 ("unexpected argument", ("log.txt", "more.txt"))):
            self.refused(words, "import", *arguments)


class Missing(Folder):
    """`diagnose` of another program's log: all that is missing, and the way to a recording."""

    def test_all_missing_columns_and_a_map(self):
        self.write("motor.toml", MOTOR)
        self.write("rec.csv", "time,Ia [mA],Ib [mA],angle,Vdc\n0,1,2,3,4\n")
        line = self.refused("missing columns: t_s, i_a_A, i_b_A, theta_e_rad, u_a_V, u_b_V, u_c_V (or", "diagnose", "rec.csv",
                            "--motor", "motor.toml")
        for words in ("found time,Ia [mA]", "`iqfoc import`", 'i_a_A = "Ia [mA]"', 'theta_e_rad = "angle"'):
            self.assertIn(words, line)
        self.write("rec.csv", "alpha,beta\n0,1\n")
        line = self.refused("`iqfoc import` makes a recording", "diagnose", "rec.csv", "--motor", "motor.toml")
        self.assertNotIn("(map:", line)

    def test_speed_from_the_angle(self):
        rec = foreign.read_recording(RECORDINGS / "dead_time.csv.gz")
        motor = RECORDINGS / "dead_time.toml"
        own = self.run_ok("diagnose", RECORDINGS / "dead_time.csv.gz", "--motor", motor, "--json", "-")
        self.assertEqual(own.stderr, b"")
        del rec["omega_e_rad_s"]
        self.write("rec.csv", foreign.table({k: ([int(x) for x in v] if k == "run" else v) for k, v in rec.items()}))
        done = self.run_ok("diagnose", "rec.csv", "--motor", motor, "--json", "-")
        self.assertIn(b"note: rec.csv has no omega_e_rad_s", done.stderr)
        self.assertEqual(causes(done), causes(own))


if __name__ == "__main__":
    unittest.main(argv=["import"])
