"""Builds mutants and runs the tests on them: see mutate.py."""
import dataclasses
import hashlib
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import threading
import time

LIBRARY = "src/libiqfoc.a"
NAME = "libiqfoc_mutant.so"
# The quick tests of the diagnosis; the others take a minute for each mutant.
QUICK = re.compile(r"choose(_\w+)?")
# A test that runs long, or is no test of C code: not one of the unit tests.
NOT_UNIT = {"sweep", "blind", "tool", "cli", "study"}
FAILED = re.compile(rb":FAIL")


@dataclasses.dataclass
class Outcome:
    state: str  # killed, survived; no code: does not compile; same code
    why: str = ""  # the test that killed it


def digest(*files):
    found = hashlib.sha256()
    for file in files:
        found.update(pathlib.Path(file).read_bytes())
    return found.hexdigest()[:24]


def shell(command, cwd):
    return subprocess.run(command, cwd=cwd, shell=isinstance(command, str), capture_output=True, text=True, check=False)


class Bench:
    def __init__(self, root, build, work):
        self.root, self.build, self.work = root, build, work
        if not (build / "compile_commands.json").is_file():
            raise SystemExit(f"{build} is not built: cmake --preset host -DBUILD_TESTING=ON && cmake --build build/host")
        work.mkdir(parents=True, exist_ok=True)
        self.compile = {}  # the library's own compilation of a file comes before any test's
        for entry in json.loads((build / "compile_commands.json").read_text()):
            path = pathlib.Path(entry["file"]).resolve()
            if path.is_relative_to(root):
                self.compile.setdefault(str(path.relative_to(root)), shlex.split(entry["command"]))
        self.sources = sorted(file for file in self.compile if re.fullmatch(r"src/\w+\.c", file))
        self.links = self._links()
        self.labels = self._labels()
        self.made_of = self._read_dependencies()
        self.only = {}  # key: tests, where they are given
        self.plain = {}
        self.objects = {}  # {test: sources of its objects}
        self.of_object = self._sources_by_object()
        self.lock = threading.Lock()
        self.results = {}  # {(library, test): passed}
        self.killers = {}  # {library: name of a test that failed on it}
        self.log = work / "results.jsonl"
        if self.log.is_file():
            for line in self.log.read_text().splitlines():
                self._keep(*json.loads(line))
        self.tests, self.times, self.reach = {}, {}, {}
        self._base()

    def _keep(self, library, test, name, passed):
        self.results[library, test] = passed
        if not passed:
            self.killers[library] = name

    # ---- What the build says ----

    def _links(self):
        """{test: command that links it}."""
        commands = shell(["ninja", "-t", "commands"], self.build).stdout
        return {match[1]: line for line in commands.split("\n") if (match := re.search(r" -o tests/test_(\w+) ", line))}

    def _sources_by_object(self):
        """{(folder of the target's objects, object): source}."""
        found = {}
        for file, words in self.compile.items():
            folder, name = re.fullmatch(r"(.*?CMakeFiles/\w+\.dir)/(?:.*/)?([^/]+)", words[words.index("-o") + 1]).groups()
            found[folder, name] = file
        return found

    def _labels(self):
        tests = json.loads(shell(["ctest", "--test-dir", str(self.build), "--show-only=json-v1"], self.root).stdout)["tests"]
        found = {}
        for test in tests:
            labels = [p["value"] for p in test.get("properties", []) if p["name"] == "LABELS"]
            # A test of C code is a program without arguments; its limit of processor time is before it.
            if test.get("command", [])[-1:] == [str(self.build / "tests" / f"test_{test['name']}")]:
                found[test["name"]] = set(labels[0] if labels else [])
        return found

    def _read_dependencies(self):
        """{C file: all that its object is made of}."""
        found = {}
        for block in shell(["ninja", "-t", "deps"], self.build).stdout.split("\n\n"):
            names = {os.path.relpath(os.path.normpath(self.build / line.strip()), self.root) for line in block.split("\n")[1:]}
            found.update({file: names for file in names & set(self.compile)})
        return found

    def _including(self, header):
        return {file for file, names in self.made_of.items() if header in names}

    # ---- Building ----

    def command(self, file, out, source, extra=()):
        """As the build compiles the file, without debugging information and warnings."""
        words = self.compile[file]
        start = next(k for k, word in enumerate(words) if re.search(r"(gcc|cc|clang)[-.\d]*$", word) and "ccache" not in word)
        kept, skip = [words[start], *extra], False
        for word in words[start + 1:]:
            if skip or word in ("-o", "-c"):
                skip = not skip
            elif not re.fullmatch(r"-g\d?", word) and not word.startswith("-W"):
                kept.append(word)
        return [*kept, "-w", "-iquote", str((self.root / file).parent), "-o", str(out), "-c", str(source)]

    def _link(self, objects, folder):
        done = shell(["gcc", "-shared", "-s", "-Wl,--build-id=none", f"-Wl,-soname,{NAME}", "-o", str(folder / NAME), *map(str, objects)],
                     self.root)
        return done.stderr[-2000:] if done.returncode != 0 else ""

    def _base(self):
        """The library unchanged, of the build's own objects."""
        folder = self.work / "base"
        folder.mkdir(exist_ok=True)
        self.base = {}
        for file in self.sources:
            words = self.compile[file]
            self.base[file] = self.build / words[words.index("-o") + 1]
        error = self._link(self.base.values(), folder)
        if error:
            raise SystemExit(f"the library does not link to a shared one:\n{error}")

    def _plain(self, file, options=()):
        """The file's object as mutants are compiled, for the comparison of the code."""
        key = file + "".join(options)
        with self.lock:
            out = self.work / "plain" / (key.replace("/", "_") + ".o")
            if key not in self.plain:
                out.parent.mkdir(exist_ok=True)
                shell(self.command(file, out, self.root / file) + list(options), self.root)
                self.plain[key] = digest(out)
        return self.plain[key]

    def test_program(self, name):
        """The test, linked to the shared library; rebuilt if an input is newer."""
        out = self.work / "tests" / name
        out.parent.mkdir(exist_ok=True)
        command = self.links[name].replace(f" {LIBRARY}", f" {self.work / 'base' / NAME}").replace(f" -o tests/test_{name} ",
                                                                                                     f" -s -o {out} ")
        parts = [self.build / word for word in shlex.split(command) if re.search(r"\.(o|a)$", word)]
        if not out.is_file() or any(part.stat().st_mtime > out.stat().st_mtime for part in parts):
            done = shell(command, self.build)
            if done.returncode != 0:
                raise SystemExit(f"test_{name} does not link:\n{done.stderr[-2000:]}")
        return out

    # ---- Which tests, and how long they take ----

    def prepare(self, names):
        for name in sorted(names):
            program = self.test_program(name)
            self.tests[name] = (program, digest(program))
            start = time.monotonic()
            if name not in self.times:
                if not self._runs_well(name, self.work / "base", 600):
                    raise SystemExit(f"test_{name} fails on the library as it is")
                self.times[name] = time.monotonic() - start

    def unit_tests(self):
        return [name for name, command in self.links.items()
                if f" {LIBRARY}" in command and not self.labels.get(name, NOT_UNIT) & NOT_UNIT]

    def prepare_for(self, mutants):
        """Links the tests; measures which functions each calls, and its time, where that is not known from before."""
        files = {mutant.file for mutant in mutants}
        if any(file.startswith(("src/", "include/")) for file in files):
            self._measure(self.unit_tests())

    def _measure(self, names):
        kept = self.work / "reach.json"
        known = json.loads(kept.read_text()) if kept.is_file() else {}
        counted = self.work / "counted"
        base = digest(self.work / "base" / NAME)
        fresh = {}
        for name in sorted(names):
            program = self.test_program(name)
            self.tests[name] = (program, digest(program))
            key = f"{base} {self.tests[name][1]}"
            if key not in known:
                if not fresh:
                    self._build_counted(counted)
                known[key] = self._measured(name, counted)
            fresh[key] = known[key]
            self.times[name], self.reach[name] = known[key]
        kept.write_text(json.dumps(fresh))

    def _build_counted(self, folder):
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        objects = []
        for file in self.sources:
            objects.append(folder / (pathlib.Path(file).stem + ".o"))
            shell(self.command(file, objects[-1], self.root / file, ("--coverage",)) + ["-O0"], folder)
        shell(["gcc", "-shared", "--coverage", f"-Wl,-soname,{NAME}", "-o", str(folder / NAME), *map(str, objects)], folder)

    def _measured(self, name, counted):
        """(seconds, {file: [[first line, last line] of each function that the test calls]})."""
        start = time.monotonic()
        if not self._runs_well(name, self.work / "base", 600):
            raise SystemExit(f"test_{name} fails on the library as it is")
        seconds = time.monotonic() - start
        for old in counted.glob("*.gcda"):
            old.unlink()
        self._runs_well(name, counted, 3000)
        data = [str(path) for path in counted.glob("*.gcda")]
        reach = {}
        if data:
            text = shell(["gcov", "--json-format", "--stdout", *data], counted).stdout
            for line in filter(None, text.split("\n")):
                for file in json.loads(line)["files"]:
                    path = os.path.relpath(os.path.join(self.root, file["file"]), self.root)
                    if not path.startswith("src/"):
                        continue
                    spans = reach.setdefault(path, [])
                    spans += [[f["start_line"], f["end_line"]] for f in file["functions"]
                              if f["execution_count"] > 0 and [f["start_line"], f["end_line"]] not in spans]
        return seconds, reach

    def tests_for(self, mutant):
        """Those that call the function which the mutant is in, or anything of the file where it is in none that is counted; the fastest
        first."""
        if mutant.key in self.only:
            return self.only[mutant.key]
        calls = {name: {tuple(span) for span in reach.get(mutant.file, [])} for name, reach in self.reach.items()}
        names = [name for name, spans in calls.items() if any(first <= mutant.line <= last for first, last in spans)]
        if not self._in_a_function(mutant):
            files = {mutant.file} if mutant.file.endswith(".c") else self._including(mutant.file)
            names = [name for name, reach in self.reach.items() if any(reach.get(file) for file in files)]
        return sorted(names, key=lambda name: (self.times[name], name))

    @staticmethod
    def _in_a_function(mutant):
        """Not one that is inlined even in the counted library: gcov does not list it."""
        before = mutant.text[:mutant.start].split("\n")
        opened = [k for k, line in enumerate(before) if line == "{"]
        closed = [k for k, line in enumerate(before) if line == "}"]
        if not opened or (closed and closed[-1] > opened[-1]):
            return False
        start = opened[-1]
        while start > 0 and before[start - 1]:
            start -= 1
        return not any(line.startswith("IQFOC_STEP") for line in before[start:opened[-1]])

    def _sources_of(self, name):
        return [file for file in self.compile
                if f"{pathlib.Path(file).name}.o" in self.links[name] and f"test_{name}.dir" in " ".join(self.compile[file])]

    # ---- Running ----

    def _runs_well(self, name, folder, seconds, program=None):
        """Whether the test passes; it is ended at its first failure, and after so many seconds of processor time."""
        command = ["prlimit", f"--cpu={int(seconds) + 1}", "--core=0", "stdbuf", "-oL", str(program or self.tests[name][0])]
        with subprocess.Popen(command, cwd=self.root, env={**os.environ, "LD_LIBRARY_PATH": str(folder)}, stdout=subprocess.PIPE,
                              stderr=subprocess.DEVNULL) as process:
            for line in process.stdout:
                if FAILED.search(line):
                    process.kill()
                    return False
            return process.wait() == 0

    def _passes(self, name, library, folder, program=None):
        test = digest(program) if program else self.tests[name][1]
        with self.lock:
            if (library, test) in self.results:
                return self.results[library, test]
        passed = self._runs_well(name, folder, 4.0 * self.times[name] + 1.0, program)
        with self.lock:
            self._keep(library, test, name, passed)
            with self.log.open("a") as log:
                log.write(json.dumps([library, test, name, passed]) + "\n")
        return passed

    def try_out(self, mutant):
        name = hashlib.sha256(mutant.key.encode()).hexdigest()[:16]
        folder = self.work / "mutants" / name
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        try:
            if mutant.file.startswith("src/"):
                return self._try_source(mutant, folder)
            if mutant.file.startswith("include/"):
                return self._try_header(mutant, folder)
            return self._try_host(mutant, folder)
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    def _compiled(self, files, folder, root, options=()):
        """{file: object} of the files under that root, or None if one does not compile."""
        objects = {}
        for file in files:
            objects[file] = folder / (file.replace("/", "_") + ".o")
            if shell(self.command(file, objects[file], root / file, (f"-I{root / 'include'}",)) + list(options), root).returncode != 0:
                return None
        return objects

    def _copied(self, mutant, folder):
        """The library's sources under another root, one of them changed."""
        for part in ("src", "include"):
            if (self.root / part).is_dir():
                shutil.copytree(self.root / part, folder / part)
        (folder / mutant.file).write_text(mutant.changed(), encoding="utf-8")

    def _try_source(self, mutant, folder):
        files = [mutant.file]
        if mutant.file.endswith(".h"):
            self._copied(mutant, folder)
            files = sorted(self._including(mutant.file) & set(self.sources))
        else:
            (folder / "src").mkdir()
            (folder / mutant.file).write_text(mutant.changed(), encoding="utf-8")
        made = self._compiled(files, folder, folder)
        if made is None:
            return Outcome("no code")
        if all(digest(made[file]) == self._plain(file) for file in files):
            return Outcome("same code")
        if self._link({**self.base, **made}.values(), folder):
            return Outcome("no code")
        return self._first_failure(self.tests_for(mutant), digest(folder / NAME), folder)

    def _first_failure(self, names, library, folder):
        for name in sorted(names, key=lambda name: name != self.killers.get(library)):
            if not self._passes(name, library, folder):
                return Outcome("killed", name)
        return Outcome("survived", "no test calls it" if not names else "")

    def _try_header(self, mutant, folder):
        """Every includer is recompiled: the library's sources, the test's own, and the host's objects that the test links."""
        self._copied(mutant, folder)
        options = ("-O1",)
        wanted = self._including(mutant.file)
        made = self._compiled(sorted(wanted & set(self.sources)), folder, folder, options)
        if made is None:
            return Outcome("no code")
        changed = {file for file in made if digest(made[file]) != self._plain(file, options)}
        if self._link({**self.base, **made}.values(), folder):
            return Outcome("no code")
        objects = {}

        def recompiled(file):
            if file not in objects:
                out = folder / (file.replace("/", "_") + ".test.o")
                shell(self.command(file, out, self.root / file, (f"-I{folder / 'include'}",)) + list(options), self.root)
                objects[file] = out if out.is_file() else None
            return objects[file]

        def program_of(name, files):
            command = self.links[name].replace(f" {LIBRARY}", f" {folder / NAME}")
            ahead = []
            for file in files:
                command, replaced = re.subn(rf" \S+test_{name}\.dir/(?:\S*/)?{re.escape(pathlib.Path(file).name)}\.o", f" {recompiled(file)}", command)
                ahead += [] if replaced else [str(recompiled(file))]
            shell(command.replace(f" -o tests/test_{name} ", f" -s {' '.join(ahead)} -o {folder / name} "), self.build)
            return folder / name

        ran = 0
        names = self._tests_of_header(mutant, wanted, changed)
        for name in names:
            files = sorted(wanted & self._objects_of(name))
            if any(recompiled(file) is None for file in files):
                return Outcome("no code")
            if not changed and all(digest(recompiled(file)) == self._plain(file, options) for file in files):
                continue
            ran += 1
            program = program_of(name, files)
            if not program.is_file():
                return Outcome("no code")
            if not self._passes(name, digest(folder / NAME), folder, program):
                return Outcome("killed", name)
        return Outcome("survived", "" if names else "no test calls it") if ran or not names else Outcome("same code")

    def _tests_of_header(self, mutant, wanted, changed):
        """Those with an object that includes the header, and those that call a source which it changes: the header's own test first,
        then those with the fewest objects to compile."""
        if mutant.key in self.only:
            return self.only[mutant.key]
        stem = pathlib.Path(mutant.file).stem
        names = [name for name, reach in self.reach.items() if wanted & self._objects_of(name) or any(reach.get(file) for file in changed)]
        return sorted(names, key=lambda name: (name != stem, len(wanted & self._objects_of(name)), self.times[name], name))

    def _objects_of(self, name):
        """The sources of the test's objects: its own, and those that it takes from the host's archives."""
        with self.lock:
            if name not in self.objects:
                traced = shell(self.links[name].replace(f" -o tests/test_{name} ", f" -Wl,-t,-t -o {self.work / 'traced'} "), self.build).stdout
                members = re.findall(r"^\((\S*?)lib(\w+)\.a\)(\S+)$", traced, re.MULTILINE)
                host = {self.of_object.get((f"{folder}CMakeFiles/{target}.dir", member)) for folder, target, member in members}
                self.objects[name] = set(self._sources_of(name)) | host - {None} - set(self.sources)
            return self.objects[name]

    # ---- The host's parts: the changed object comes before its archive ----

    def _try_host(self, mutant, folder):
        source = folder / pathlib.Path(mutant.file).name
        out = folder / (source.name + ".o")
        source.write_text(mutant.changed(), encoding="utf-8")
        if shell(self.command(mutant.file, out, source), self.root).returncode != 0:
            return Outcome("no code")
        if digest(out) == self._plain(mutant.file):
            return Outcome("same code")
        for name in self.host_tests(mutant.file):
            program = folder / name
            shell(self.links[name].replace(f" -o tests/test_{name} ", f" -s {out} -o {program} "), self.build)
            if not program.is_file():
                return Outcome("no code")
            if not self._passes(name, "", folder, program):
                return Outcome("killed", name)
        return Outcome("survived")

    def host_tests(self, file):
        """The quick ones of the archive that holds the file."""
        archive = re.search(r"(\S+)/CMakeFiles/(\w+)\.dir", " ".join(self.compile[file]))
        names = [name for name, command in self.links.items()
                 if QUICK.fullmatch(name) and f"{archive[1]}/lib{archive[2]}.a" in command]
        with self.lock:
            for name in names:
                if name not in self.times:
                    program = self.build / "tests" / f"test_{name}"
                    self.tests[name] = (program, digest(program))
                    start = time.monotonic()
                    self._runs_well(name, self.work, 600)
                    self.times[name] = time.monotonic() - start
        return sorted(names, key=lambda name: self.times[name])
