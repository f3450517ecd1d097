"""
The library as a package of each firmware ecosystem: its metadata read by that ecosystem's own tool where a registry has it, else
held to the published rules, and a consumer that compiles, links and runs. The recipes are those of docs/install.md.
"""
import json
import os
import re
import shutil
import tarfile
import xml.etree.ElementTree
import zipfile

from common import HERE, INCLUDE, PROGRAM, ROOT, SOURCES, WARNINGS, cmake, expect, run, version_of_the_header

# The ecosystems' own tools, in the environment that `./dev` makes of packages/python/packages.txt.
TOOLS = ROOT / ".cache/python/packages/bin"
# The address that a package's maker gives.
URL = "https://packages.test/iqfoc"
INSTALL_PAGE = ROOT / "docs/install.md"
RECIPE_LINES = 10


def tool(name):
    path = TOOLS / name
    expect(path.exists(), f"no {path}: `./dev test --all` installs it, or `./dev tools packages` alone")
    return path


def recipe(name):
    """The code blocks [(language, text)] of a section of docs/install.md."""
    section = re.search(rf"^## {re.escape(name)}\n(.*?)(?=^## |\Z)", INSTALL_PAGE.read_text(), re.MULTILINE | re.DOTALL)
    expect(section, f"docs/install.md has no section '{name}'")
    return re.findall(r"^```(\S*)\n(.*?)^```", section[1], re.MULTILINE | re.DOTALL)


def block(name, language):
    """The one block of a recipe in this language."""
    found = [text for kind, text in recipe(name) if kind == language]
    expect(len(found) == 1, f"docs/install.md, {name}: {len(found)} blocks of {language}")
    return found[0]


# ---- One version, short recipes ----

def one_version_everywhere(_):
    """What cannot read the header says the same as the header."""
    version = version_of_the_header()
    said = {
        "library.json": json.loads((ROOT / "library.json").read_text())["version"],
        "idf_component.yml": re.search(r'^version: "(.*)"$', (ROOT / "idf_component.yml").read_text(), re.MULTILINE)[1],
    }
    wrong = {file: said for file, said in said.items() if said != version}
    expect(not wrong, f"the header says {version}, and {wrong}")
    numbers = dict(re.findall(r"define IQFOC_VERSION_(MAJOR|MINOR|PATCH) +(\d+)", (INCLUDE / "iqfoc/version.h").read_text()))
    expect(version.split("-")[0] == "{MAJOR}.{MINOR}.{PATCH}".format(**numbers), f"{version} is not {numbers}")
    listed = set(re.findall(r"^    (\w+\.c)\b", (ROOT / "src/CMakeLists.txt").read_text(), re.MULTILINE))
    expect(listed == {source.name for source in SOURCES}, "src/CMakeLists.txt does not list what packages take: all of src/*.c")


def recipes_are_short(_):
    page = INSTALL_PAGE.read_text()
    for name in re.findall(r"^## (.*)$", page, re.MULTILINE):
        lines = sum(len([line for line in text.split("\n") if line.strip()]) for _, text in recipe(name))
        expect(lines <= RECIPE_LINES, f"docs/install.md, {name}: {lines} lines")


# ---- PlatformIO ----

def platformio_environment(folder):
    """PlatformIO without a network: SCons from PyPI stands for its tool-scons, which only its own registry has."""
    core = folder / "core"
    scons = core / "packages/tool-scons"
    scons.mkdir(parents=True)
    code = "from platformio.dependencies import get_core_dependencies as d; print(d()['tool-scons'].lstrip('~'))"
    version = run([tool("python"), "-c", code]).strip()
    (scons / "package.json").write_text(json.dumps({"name": "tool-scons", "version": version, "description": "SCons of PyPI"}))
    spec = {"owner": "platformio", "id": None, "name": "tool-scons", "requirements": None, "uri": None}
    (scons / ".piopm").write_text(json.dumps({"type": "tool", "name": "tool-scons", "version": version, "spec": spec}))
    (scons / "scons.py").write_text("from SCons.Script import main\nmain()\n")
    return {**os.environ, "PLATFORMIO_CORE_DIR": str(core), "PLATFORMIO_SETTING_ENABLE_TELEMETRY": "no",
            "PLATFORMIO_SETTING_CHECK_PLATFORMIO_INTERVAL": "9999"}


def platformio(folder):
    """Packed by its own packer, which holds library.json to its schema; then `pio run` builds a program that depends on it."""
    archive = folder / "iqfoc.tar.gz"
    environment = platformio_environment(folder)
    run([tool("python"), HERE / "pio_pack.py", ROOT, archive], env=environment)
    with tarfile.open(archive) as packed:
        names = set(packed.getnames())
        expect({"library.json", "LICENSE", "src/cycle.c", "include/iqfoc/target/choose.h"} <= names, f"not all is packed: {names}")
        expect(not any(name.startswith(("tests", "sim_host", "port")) for name in names), "more than the library is packed")
        packed.extractall(folder / "iqfoc")
    app = folder / "app"
    (app / "src").mkdir(parents=True)
    shutil.copy(PROGRAM, app / "src/main.c")
    ini = block("PlatformIO", "ini")
    expect("platform = ststm32" in ini and "symlink://../iqfoc" in ini, "the recipe is not the one that is tested")
    ini = re.sub(r"^(framework|board) = .*\n", "", ini, flags=re.MULTILINE)
    (app / "platformio.ini").write_text(ini.replace("platform = ststm32", f"platform = symlink://{HERE}/platformio"))
    run([tool("pio"), "run"], env=environment, cwd=app)
    programs = list((app / ".pio/build").glob("*/program"))
    expect(len(programs) == 1, f"{programs}")
    run(programs)


# ---- Arduino ----

def arduino_rules(library):
    """The rules for a library that arduino-lint names LP001 to LP068, LS001 to LS008, as far as they concern this one."""
    lines = [line for line in (library / "library.properties").read_text().split("\n") if line]
    expect(all("=" in line for line in lines), f"not key=value: {lines}")
    about = dict(line.split("=", 1) for line in lines)
    required = {"name", "version", "author", "maintainer", "sentence", "paragraph", "category", "url", "architectures"}
    expect(required <= set(about), f"library.properties lacks {required - set(about)}")
    expect(set(about) <= required | {"includes", "depends", "dot_a_linkage", "license"}, f"fields that no tool knows: {about}")
    expect(all(about.values()), f"an empty field: {about}")
    expect(re.fullmatch(r"[A-Za-z][A-Za-z0-9_.-]{0,15}", about["name"]), "name: at most 16 letters, no space")
    expect("arduino" not in about["name"].lower() and "library" not in about["name"].lower(), "name: words that are not to be in it")
    expect(about["version"] == version_of_the_header(), "version")
    expect(not about["maintainer"].lower().startswith("arduino"), "maintainer")
    expect(about["category"] in {"Display", "Communication", "Signal Input/Output", "Sensors", "Device Control", "Timing",
                                 "Data Storage", "Data Processing", "Other"}, "category")
    expect(about["url"] == URL, "url")
    expect("avr" not in about["architectures"].split(","), "a double of 32 bits is refused by the headers")
    expect(not about["paragraph"].startswith(about["sentence"]), "paragraph: repeats the sentence")
    for header in about["includes"].split(","):
        expect((library / "src" / header).is_file(), f"includes names {header}, which is not in src/")
    expect((library / "src" / (about["name"] + ".h")).is_file(), "no header of the library's name")
    files = [file for file in library.rglob("*") if file.is_file()]
    expect(not any(file.is_symlink() for file in library.rglob("*")), "a symbolic link")
    expect(not any(file.suffix == ".exe" or file.name == ".development" for file in files), "a file that is not allowed")
    sketches = list((library / "examples").glob("*/*.ino"))
    expect(sketches and all(sketch.stem == sketch.parent.name for sketch in sketches), "a sketch not of its folder's name")
    return sketches


def arduino(folder):
    """Unpacked as the IDE does; src/ is compiled file by file with nothing else on the include path, and each example runs."""
    run([ROOT / "tools/package.py", "arduino", "--url", URL, "-o", folder])
    with zipfile.ZipFile(folder / f"iqfoc-arduino-{version_of_the_header()}.zip") as packed:
        packed.extractall(folder)
    library = folder / "iqfoc"
    sketches = arduino_rules(library)
    expect(len(list((library / "src").rglob("*.c"))) == len(SOURCES), "not all sources are packed")
    sketch_of_the_page = folder / "page.cpp"
    sketch_of_the_page.write_text('#include <Arduino.h>\n' + block("Arduino", "cpp"))
    for compilers, flags, runs in ((("gcc", "g++"), [], True),
                                   (("arm-none-eabi-gcc", "arm-none-eabi-g++"), ["-mcpu=cortex-m0plus", "-mthumb"], False)):
        objects = []
        for source in sorted((library / "src").rglob("*.c")):
            objects.append(folder / (source.stem + ".o"))
            run([compilers[0], *flags, "-std=gnu11", "-Os", "-w", f"-I{library}/src", "-c", source, "-o", objects[-1]])
        common = [compilers[1], *flags, "-std=gnu++17", "-Os", *[w for w in WARNINGS if w != "-Wconversion"],
                  f"-I{library}/src", f"-I{HERE}/arduino"]
        for sketch in [*sketches, sketch_of_the_page]:
            made = folder / (sketch.stem + ".o")
            run([*common, "-include", "Arduino.h", "-x", "c++", "-c", sketch, "-o", made])
            if runs:
                run(["g++", f"-I{HERE}/arduino", made, HERE / "arduino/main.cpp", *objects, "-o", folder / "sketch"])
                expect(run([folder / "sketch"]).strip(), "the sketch prints nothing")


# ---- ESP-IDF ----

def esp_idf(folder):
    """The manifest is taken by ESP-IDF's component manager; what it packs is read twice, as ESP-IDF does, and linked."""
    environment = {**os.environ, "IDF_TOOLS_PATH": str(folder / "tools")}
    run([tool("compote"), "--warnings-as-errors", "component", "pack", "--name", "iqfoc", "--dest-dir", folder], cwd=ROOT,
        env=environment)
    with tarfile.open(folder / f"iqfoc_{version_of_the_header()}.tgz") as packed:
        packed.extractall(folder / "iqfoc")
    expect(not (folder / "iqfoc/tests").exists(), "more than the library is packed")
    text = run(["cmake", f"-DIQFOC_SOURCE={folder}/iqfoc", "-P", HERE / "esp_idf/requirements.cmake"])
    expect("registered: SRC_DIRS;src;INCLUDE_DIRS;include" in text.replace(" ", ";").replace("registered:;", "registered: "), text)
    cmake(HERE / "esp_idf", folder / "build", f"-DIQFOC_SOURCE={folder}/iqfoc")
    run([folder / "build/consumer"])
    manifest = block("ESP-IDF", "yaml")
    expect("path: ../../iqfoc" in manifest, "the recipe is not the one that is tested")
    project = folder / "app"
    (project / "main").mkdir(parents=True)
    (project / "main/idf_component.yml").write_text(manifest)
    check = ("import sys; from idf_component_tools.manager import ManifestManager; "
             "m = ManifestManager(sys.argv[1], 'main').load(); print([d.name for d in m.raw_requirements])")
    expect("iqfoc" in run([tool("python"), "-c", check, project / "main"], env=environment), "the recipe's manifest asks for no iqfoc")


# ---- Zephyr ----

def zephyr(folder):
    """module.yml by its schema, Kconfig by kconfiglib, which Zephyr uses, and the CMake part with and without the symbol."""
    check = ("import json, sys, jsonschema, yaml; "
             "jsonschema.validate(yaml.safe_load(open(sys.argv[1])), json.load(open(sys.argv[2]))); "
             "b = yaml.safe_load(open(sys.argv[1]))['build']; print(b['cmake'], b['kconfig'])")
    cmake_folder, kconfig = run([tool("python"), "-c", check, ROOT / "zephyr/module.yml",
                                 HERE / "zephyr_app/module_schema.json"]).split()
    expect((ROOT / cmake_folder / "CMakeLists.txt").is_file() and (ROOT / kconfig).is_file(), "module.yml names what is not there")

    (folder / "prj.conf").write_text(block("Zephyr", "ini"))
    read = ("import sys, kconfiglib; k = kconfiglib.Kconfig(sys.argv[1], warn_to_stderr=False); k.load_config(sys.argv[2]); "
            "print(k.warnings or k.syms['IQFOC'].str_value)")
    expect(run([tool("python"), "-c", read, ROOT / kconfig, folder / "prj.conf"]).strip() == "y",
           "the recipe's prj.conf does not turn the library on")
    expect(f"zephyr/{'module.yml'}" in INSTALL_PAGE.read_text(), "the page does not name the module's file")

    common = [f"-DMODULE_CMAKE_DIR={ROOT}/{cmake_folder}", "-DCONFIG_IQFOC=y"]
    cmake(HERE / "zephyr_app", folder / "build", *common)
    run([folder / "build/consumer"])
    header = HERE.parent / "unit/library/iq24_narrow_multiply.h"
    cmake(HERE / "zephyr_app", folder / "own", *common, f"-DCONFIG_IQFOC_TARGET_HEADER={header}")
    run([folder / "own/consumer"])
    # Left out, nothing of it is there: the consumer asks in vain for its headers.
    run(["cmake", "-G", "Ninja", "-S", HERE / "zephyr_app", "-B", folder / "off", common[0]])
    expect("iqfoc/iqfoc.h" in run(["cmake", "--build", folder / "off"], status=None), "the symbol makes no difference")


# ---- CMSIS ----

def cmsis_pack(folder):
    """
    The pack by packChk's rules: the description's schema, its names, and that each file it lists is in it. Arm's pack manager
    reads it. A program is built from the listed files alone.
    """
    run([ROOT / "tools/package.py", "cmsis", "--url", URL, "-o", folder])
    version = version_of_the_header()
    with zipfile.ZipFile(folder / f"iqfoc.iqfoc.{version}.pack") as packed:
        packed.extractall(folder / "pack")
    description = folder / "pack/iqfoc.iqfoc.pdsc"
    run(["xmllint", "--noout", "--schema", HERE / "pdsc.xsd", description])
    run([tool("pack-manager"), "add-packs", "--data-path", folder / "data", "--json-path", folder / "json", description])
    package = xml.etree.ElementTree.parse(description).getroot()
    expect(f"{package.findtext('vendor')}.{package.findtext('name')}.pdsc" == description.name, "the file's name is not its own")
    expect([release.get("version") for release in package.iter("release")] == [version], "releases")
    expect({component.get("Cversion") for component in package.iter("component")} == {version}, "components")
    classes = {entry.get("Cclass") for entry in package.find("taxonomy")}
    expect(all(component.get("Cclass") in classes for component in package.iter("component")), "a class without a description")
    files = {(entry.get("category"), entry.get("name")) for entry in package.iter("file")}
    files.add(("doc", package.findtext("license")))
    absent = [name for kind, name in files
              if not ((folder / "pack" / name).is_dir() if kind == "include" else (folder / "pack" / name).is_file())]
    expect(not absent, f"listed, but not in the pack: {absent}")
    sources = [folder / "pack" / name for kind, name in files if kind == "source"]
    expect(len(sources) == len(SOURCES), "not all sources are listed")
    include = [f"-I{folder}/pack/{name}" for kind, name in files if kind == "include"]
    run(["gcc", "-std=c99", "-O1", *include, PROGRAM, *sources, "-o", folder / "consumer"])
    run([folder / "consumer"])


def a_package_has_its_makers_address(folder):
    """No address is invented: without one, or with a malformed one, nothing is packed."""
    for words in ([], ["--url", "iqfoc"]):
        run([ROOT / "tools/package.py", *words, "-o", folder / "none"], status=2)
        expect(not (folder / "none").exists(), "packed without an address")


def packages_are_the_same_twice(folder):
    for turn in ("first", "second"):
        run([ROOT / "tools/package.py", "--url", URL, "-o", folder / turn])
    for first in (folder / "first").iterdir():
        expect(first.read_bytes() == (folder / "second" / first.name).read_bytes(), f"{first.name} differs")


def a_release_is_the_same_twice(folder):
    """And its archive, unpacked, builds the library; its SBOM is what SPDX's own reader takes."""
    python = ROOT / ".cache/python/checks/bin/python"
    expect(python.exists(), f"no {python}: `./dev tools checks` installs it")
    for turn in ("first", "second"):
        run([python, "-B", ROOT / "tools/release.py", "--url", URL, "-o", folder / turn])
    names = {file.name for file in (folder / "first").iterdir()}
    version = version_of_the_header()
    expect({"SHA256SUMS", "tag-notes.txt", f"iqfoc-{version}.tar.gz", f"iqfoc-{version}.spdx.json"} <= names, f"{names}")
    for name in names:
        expect((folder / "first" / name).read_bytes() == (folder / "second" / name).read_bytes(), f"{name} differs")
    run(["sha256sum", "--check", "--strict", "SHA256SUMS"], cwd=folder / "first")
    run([python.parent / "pyspdxtools", "--infile", folder / "first" / f"iqfoc-{version}.spdx.json"])
    with tarfile.open(folder / "first" / f"iqfoc-{version}.tar.gz") as packed:
        packed.extractall(folder)
    sources = sorted((folder / f"iqfoc-{version}/src").glob("*.c"))
    run(["gcc", "-std=c99", f"-I{folder}/iqfoc-{version}/include", folder / f"iqfoc-{version}/tests/consume/every_header.c", *sources,
         "-o", folder / "consumer"])
    run([folder / "consumer"])


CHECKS = [one_version_everywhere, recipes_are_short, platformio, arduino, esp_idf, zephyr, cmsis_pack, a_package_has_its_makers_address,
          packages_are_the_same_twice, a_release_is_the_same_twice]
