"""Memory of a drive, by `size`: one image for each drive, linked without a port (bench/size_drive.c), and whole firmware images."""
import subprocess

import elf32

# The images, and their methods in words.
DRIVES = {
    "papers": "quasi-discrete prediction, its mean, PI, PWM",
    "salient": "exact prediction of a salient machine, its mean, PI, PWM",
    "deadbeat": "exact prediction, deadbeat with disturbance observer, PWM",
    "diagnosed": "flux predictor, mid-point sample, PI, up to six-step, all corrections of a diagnosis",
}
# Whole firmware for the STM32G474, start-up and port included.
FIRMWARE = {"first_drive": "first_drive_stm32g4", "corrected_drive": "corrected_drive_stm32g4",
            "sensorless_drive": "sensorless_drive_stm32g4", "pattern_drive": "pattern_drive_stm32g4"}
TOOLS = {"cortex-m4": "arm-none-eabi-size", "rv32": "riscv64-unknown-elf-size"}


def _defined(path):
    """The library's functions and constants in a file, without static ones, whose names may repeat."""
    return {symbol.name for symbol in elf32.read(path).symbols if symbol.section
            and symbol.kind in (elf32.STT_FUNC, elf32.STT_OBJECT) and symbol.name.startswith(("iqfoc_", "iq24_"))}


def _parts(build, image):
    """The library's sources with at least one symbol in the image."""
    linked = _defined(image)
    return sorted(path.name.split(".")[0] for path in build.glob("src/CMakeFiles/iqfoc.dir/*.obj") if _defined(path) & linked)


def _size(target, image):
    """text, data and bss of an image."""
    said = subprocess.run([TOOLS[target], str(image)], capture_output=True, text=True, check=True).stdout
    return dict(zip(("text", "data", "bss"), map(int, said.split("\n")[1].split()[:3])))


def firmware(build):
    """As _size, and the part of the text that the start-up copies to CCM SRAM."""
    paths = {name: build / "examples" / f"{image}.elf" for name, image in FIRMWARE.items()}
    return [{"image": name, **_size("cortex-m4", path), "ccm": sum(s.size for s in elf32.read(path).sections if s.name == ".ccm")}
            for name, path in paths.items()]


def evaluate(target, build):
    """The drives of a target, in the order of DRIVES."""
    rows = []
    for drive in DRIVES:
        image = build / "bench" / f"size_{drive}.elf"
        rows.append({"drive": drive, **_size(target, image), "parts": _parts(build, image)})
    return rows


def compared(target, baseline, now):
    """Complaints: a drive that has grown by more than 2 %, or links a source that it did not link before."""
    complaints = []
    for old, new in zip(baseline, now, strict=True):
        for key in ("text", "data", "bss"):
            if new[key] > old[key] * 1.02:
                complaints.append(f"{target} {new['drive']}: {key} rose from {old[key]} to {new[key]}")
        more = set(new["parts"]) - set(old["parts"])
        if more:
            complaints.append(f"{target} {new['drive']} also links {', '.join(sorted(more))}")
    return complaints
