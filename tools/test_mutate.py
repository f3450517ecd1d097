#!/usr/bin/env python3
"""Tests of tools/mutate.py: the mistakes, the outcome of each on a small library, and the counts."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import mutate
import mutate_bench
import mutate_page
import mutators

LIBRARY = """#include "half.h"

/* Never called. */
int32_t forgotten(int32_t x)
{
    return x + 7;
}

int32_t half(int32_t x)
{
    int32_t steps = 0;
    if (x > MOST) {
        return MOST / 2;
    }
    while (x >= 2) {
        x -= 2;
        steps++;
    }
    return steps;
}
"""
HEADER = """#include <stdint.h>
#define MOST 100
int32_t forgotten(int32_t x);
int32_t half(int32_t x);
"""
TEST = """#include "half.h"
#include <stdio.h>
int main(void)
{
    int bad = half(9) != 4 || half(8) != 4 || half(99) != 49 || half(100) != 50 || half(101) != 50 || half(300) != 50;
    printf(bad ? "test:1:half:FAIL\\n" : "test:1:half:PASS\\n");
    return bad;
}
"""
INLINE = """static inline int twice(int x)
{
#ifdef OTHER_TARGET
    return x + x + 0;
#else
    return 2 * x;
#endif
}
"""
HOST = """#include "twice.h"
int use(int x);
int use(int x)
{
    return twice(x);
}
"""
TEST_OF_HOST = """#include <stdio.h>
int use(int x);
int main(void)
{
    printf(use(3) == 6 ? "test:1:use:PASS\\n" : "test:1:use:FAIL\\n");
    return use(3) != 6;
}
"""
CMAKE = """cmake_minimum_required(VERSION 3.16)
project(small LANGUAGES C)
enable_testing()
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_C_FLAGS "-O2 -g -g1 -Wall")
add_subdirectory(src)
add_executable(test_half tests/test_half.c)
target_link_libraries(test_half PRIVATE iqfoc)
set_target_properties(test_half PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests)
add_test(NAME half COMMAND test_half)
add_library(host_use STATIC host/use.c)
target_include_directories(host_use PRIVATE include)
add_executable(test_use tests/test_use.c)
target_link_libraries(test_use PRIVATE host_use iqfoc)
set_target_properties(test_use PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests)
add_test(NAME use COMMAND test_use)
"""


def shown(text):
    return [mutant.key.split(": ", 1)[1] for mutant in mutators.mutants("f.c", text)]


class Mistakes(unittest.TestCase):
    def test_operators_constants_and_members(self):
        found = shown("bool f(int x)\n{\n    return x < 3 && y.a != -z;\n}\n")
        for one in ("return x {<=><=} 3 && y.a != -z;", "return x {<=>>=} 3 && y.a != -z;", "return x < {3=>4} && y.a != -z;",
                    "return x < {3=>2} && y.a != -z;", "return x < 3 {&&=>||} y.a != -z;", "return x < 3 && y.{a=>b} != -z;",
                    "return x < 3 && y.a {!==>==} -z;", "return x < 3 && y.a != {-=>}z;",
                    "return {x < 3 && y.a != -z=>!(x < 3 && y.a != -z)};"):
            self.assertIn(one, found)
        self.assertEqual(9, len(found))

    def test_statements_roundings_conditions_and_calls(self):
        found = shown("void f(void)\n{\n    int k = g(x + 32, 6);\n    if (ready) {\n        k++;\n    }\n"
                      "    h = late ? iq24_max(k, IQ24(0.5)) : k;\n}\n")
        for one in ("int k = g(x{+ 32=>}, 6);", "int k = g(x + 32, {6=>7});", "if ({ready=>!(ready)}) {", "{k++;=>;}", "k{++=>--};",
                    "h = {=>!}late ? iq24_max(k, IQ24(0.5)) : k;", "h = late ? {iq24_max=>iq24_min}(k, IQ24(0.5)) : k;",
                    "h = late ? iq24_max(k, IQ24(0.5){=>+ 1}) : k;", "{h = late ? iq24_max(k, IQ24(0.5)) : k;=>;}"):
            self.assertIn(one, found)

    def test_what_is_no_arithmetic_is_left(self):
        self.assertEqual([], shown('#include <a.h>\n#if A > 3\n/* 1 + 1 */\ntypedef struct s { int32_t *x; } s;\n'
                                   'static const char *text = "a + 1";\n#endif\n'))

    def test_the_same_line_twice_has_two_names(self):
        found = shown("void f(void)\n{\n    g(x < y);\n    g(x < y);\n}\n")
        self.assertIn("g(x {<=><=} y);", found)
        self.assertIn("g(x {<=><=} y); #2", found)

    def test_all_of_the_library_is_read(self):
        for path in sorted((mutate.ROOT / "src").glob("*.c")):
            text = path.read_text(encoding="utf-8")
            made = mutators.mutants(path.name, text)
            self.assertEqual(len(made), len({mutant.key for mutant in made}))
            self.assertTrue(all(mutant.changed() != text for mutant in made))


class Counting(unittest.TestCase):
    def setUp(self):
        self.mutants = mutators.mutants("f.c", "int f(void)\n{\n    return 1 + 2 + 3;\n}\n")

    def results(self, *states):
        return [(mutant, mutate_bench.Outcome(state)) for mutant, state in zip(self.mutants, states)]

    def test_score(self):
        self.assertEqual(75.0, mutate_page.score(self.results("killed", "killed", "killed", "survived", "equivalent", "same code")))

    def test_equivalents_must_survive(self):
        results = self.results("survived", "killed")
        wrong = mutate.judged(results, {mutant.key: "because" for mutant in self.mutants})
        self.assertEqual("equivalent", results[0][1].state)
        self.assertEqual(1, len(wrong))

    def test_a_part_is_updated_alone(self):
        """The same results twice give the same text; other parts do not change."""
        before = mutate_page.read(mutate.RESULTS)
        once = mutate_page.updated(before, {"decisions": self.results("killed", "survived")}, 7, "abc1234")
        self.assertEqual(once, mutate_page.updated(once, {"decisions": self.results("killed", "survived")}, 7, "abc1234"))
        self.assertEqual(list(mutate_page.HEADINGS), list(once))
        self.assertEqual({"seed": 7, "commit": "abc1234", "survived": [self.mutants[1].key],
                          "files": {"f.c": {"no code": 0, "equivalent": 0, "killed": 1, "survived": 1}}}, once["decisions"])
        for name in ("src", "headers"):
            self.assertEqual(before[name], once[name])
        self.assertIn("| The diagnosis' decisions | 2 | 0 | 0 | 1 | 1 | 50.0 % | 7, abc1234 |", mutate_page.summary_table(once))

    def test_results_are_kept_as_text(self):
        records = mutate_page.read(mutate.RESULTS)
        self.assertEqual(mutate.RESULTS.read_text(encoding="utf-8"), mutate_page.text_of(records))
        for part in records.values():
            self.assertEqual(len(part["survived"]), mutate_page.total_of(part)["survived"])

    def test_the_page_has_the_kept_results(self):
        page = mutate.PAGE.read_text(encoding="utf-8")
        self.assertEqual(page, mutate_page.with_summary(page, mutate_page.read(mutate.RESULTS)))

    def test_the_whole_page_names_all(self):
        records, known = mutate_page.read(mutate.RESULTS), mutate.equivalents()
        whole = mutate_page.whole_page(records, known)
        self.assertEqual([*mutate_page.HEADINGS.values(), "Equivalent mutants"], list(mutate_page.sections(whole)))
        for key in [*known, *(key for part in records.values() for key in part["survived"])]:
            self.assertIn("\n" + key + "\n", whole)

    def test_list_of_equivalents(self):
        known = mutate.equivalents()
        self.assertEqual([], mutate.stale(known))
        self.assertEqual(["src/restart.c: gone"], mutate.stale(["src/restart.c: gone"]))

    def test_sample_is_the_seeds(self):
        files = ["src/restart.c", "src/ripple.c", "src/deadbeat.c"]
        chosen = mutate.sample(files, 40, 1)
        self.assertEqual(40, len(chosen))
        self.assertEqual(chosen, mutate.sample(files, 40, 1))
        self.assertNotEqual(chosen, mutate.sample(files, 40, 2))
        self.assertTrue(all(sum(mutant.file == file for mutant in chosen) >= mutate.FEWEST for file in files))


class OnALibrary(unittest.TestCase):
    """Killed by a value, by an endless loop, not at all; the same code; no code."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        root = pathlib.Path(cls.folder.name).resolve()
        for name, text in {"src/half.c": LIBRARY, "src/half.h": HEADER, "tests/test_half.c": TEST, "include/twice.h": INLINE,
                           "host/use.c": HOST, "tests/test_use.c": TEST_OF_HOST, "CMakeLists.txt": CMAKE,
                           "src/CMakeLists.txt": "add_library(iqfoc half.c)\n"
                                                 "target_include_directories(iqfoc PUBLIC ${CMAKE_CURRENT_SOURCE_DIR})\n"}.items():
            (root / name).parent.mkdir(exist_ok=True)
            (root / name).write_text(text)
        for command in (["cmake", "-G", "Ninja", "-S", str(root), "-B", str(root / "build")], ["cmake", "--build", str(root / "build")]):
            subprocess.run(command, check=True, capture_output=True)
        cls.root = root
        cls.bench = mutate_bench.Bench(root, root / "build", root / "work")

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def states(self, file):
        made = mutators.mutants(file, (self.root / file).read_text())
        self.bench.prepare_for(made)
        return {mutant.key.split(": ", 1)[1]: outcome for mutant, outcome in mutate.run(self.bench, made, 2)}

    def test_source(self):
        outcomes = self.states("src/half.c")
        self.assertEqual("killed", outcomes["return MOST / {2=>3};"].state)
        self.assertEqual("half", outcomes["return MOST / {2=>3};"].why)
        self.assertEqual("killed", outcomes["{x -= 2;=>;}"].state)
        self.assertEqual("killed", outcomes["while (x >= {2=>1}) {"].state)
        self.assertEqual("survived", outcomes["return x {+=>-} 7;"].state)
        self.assertEqual("no test calls it", outcomes["return x + {7=>8};"].why)
        self.assertEqual("survived", outcomes["if (x {>=>>=} MOST) {"].state)

    def test_header_of_the_sources(self):
        outcomes = self.states("src/half.h")
        self.assertEqual("survived", outcomes["#define MOST {100=>101}"].state)
        self.assertEqual("killed", outcomes["#define MOST {100=>99}"].state)

    def test_header_of_the_hosts_objects(self):
        outcomes = self.states("include/twice.h")
        self.assertEqual("killed", outcomes["return {2=>3} * x;"].state)
        self.assertEqual("use", outcomes["return {2=>3} * x;"].why)
        self.assertEqual("same code", outcomes["return x + x + {0=>1};"].state)

    def test_results_are_kept(self):
        self.states("src/half.c")
        again = mutate_bench.Bench(self.root, self.root / "build", self.root / "work")
        again._runs_well = None  # nothing may be run
        made = mutators.mutants("src/half.c", LIBRARY)
        again.prepare_for(made)
        self.assertEqual("killed", again.try_out(next(mutant for mutant in made if "{2=>3};" in mutant.key)).state)

    def test_same_code_and_no_code(self):
        text = LIBRARY.replace("steps = 0;", "steps = 0 * 1;")
        made = {mutant.key: mutant for mutant in mutators.mutants("src/half.c", text)}
        self.bench.prepare_for(made.values())
        self.assertEqual("same code", self.bench.try_out(made["src/half.c: int32_t steps = 0 * {1=>2};"]).state)
        broken = mutators.Mutant("src/half.c", 0, 0, "no C ", 1, "broken", LIBRARY)
        self.assertEqual("no code", self.bench.try_out(broken).state)


if __name__ == "__main__":
    unittest.main()
