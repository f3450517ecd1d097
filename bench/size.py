"""What a drive takes of the library, as `size` tells it of one image a drive, linked without a port (bench/size_drive.c)."""
import subprocess

import elf32

# The images, and their methods in words.
DRIVES = {
    "papers": "quasi-discrete prediction, its mean, PI, PWM",
    "salient": "exact prediction of a salient machine, its mean, PI, PWM",
    "deadbeat": "exact prediction, deadbeat with a learnt drift, PWM",
    "diagnosed": "prediction by flux linkage, mid-point sample, PI, up to six-step, with what a diagnosis puts right",
}
TOOLS = {"cortex-m4": "arm-none-eabi-size", "rv32": "riscv64-unknown-elf-size"}


def _defined(path):
    """The library's functions and constants in a file; what is static there may bear the name of another's."""
    return {symbol.name for symbol in elf32.read(path).symbols if symbol.section
            and symbol.kind in (elf32.STT_FUNC, elf32.STT_OBJECT) and symbol.name.startswith(("iqfoc_", "iq24_"))}


def _parts(build, image):
    """The sources of the library of which anything is in the image."""
    linked = _defined(image)
    return sorted(path.name.split(".")[0] for path in build.glob("src/CMakeFiles/iqfoc.dir/*.obj") if _defined(path) & linked)


def evaluate(target, build):
    """The drives of a target, in the order of DRIVES."""
    rows = []
    for drive in DRIVES:
        image = build / "bench" / f"size_{drive}.elf"
        said = subprocess.run([TOOLS[target], str(image)], capture_output=True, text=True, check=True).stdout
        text, data, bss = map(int, said.split("\n")[1].split()[:3])
        rows.append({"drive": drive, "text": text, "data": data, "bss": bss, "parts": _parts(build, image)})
    return rows


def compared(target, baseline, now):
    """Complaints: a drive that has grown by more than 2 %, or that links a part which it did not."""
    complaints = []
    for old, new in zip(baseline, now, strict=True):
        for key in ("text", "data", "bss"):
            if new[key] > old[key] * 1.02:
                complaints.append(f"{target} {new['drive']}: {key} rose from {old[key]} to {new[key]}")
        more = set(new["parts"]) - set(old["parts"])
        if more:
            complaints.append(f"{target} {new['drive']} links besides: {', '.join(sorted(more))}")
    return complaints
