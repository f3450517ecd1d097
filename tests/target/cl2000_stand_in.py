#!/usr/bin/env python3
"""
A stand-in for TI's compiler, so that a Makefile for it can be run: the options that it knows, C by clang where int has 16 bits, with the
words of TI's compiler (__interrupt, cregister, __asm). What it writes is an empty file.

    cl2000_stand_in.py OPTIONS --compile_only --output_file=F SOURCE
    cl2000_stand_in.py OPTIONS --run_linker OBJECTS... --output_file=F
"""
import pathlib
import subprocess
import sys

KNOWN = {"--silicon_version=28", "--abi=eabi", "--float_support=fpu32", "--unified_memory", "--gen_func_subsections=on", "--opt_level=2",
         "--c99", "--diag_warning=225", "--compile_only", "--ramfunc=on", "--run_linker", "--rom_model", "--unused_section_elimination=on"}
WITH_VALUE = ("--include_path", "--output_file", "--map_file", "--library", "--search_path")
CLANG = ["clang", "--target=msp430", "-std=gnu99", "-ffreestanding", "-fsyntax-only", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion",
         "-Wno-unknown-attributes", "-Wno-main-return-type", "-Werror", "-D__TMS320C28XX__", "-D__interrupt=", "-Dcregister=",
         "-D__enable_interrupts()=(void)0"]


def main(words):
    options = [word for word in words if word.startswith("--")]
    files = [pathlib.Path(word) for word in words if not word.startswith("--")]
    values = dict(word.split("=", 1) for word in options if word.split("=")[0] in WITH_VALUE)
    unknown = [word for word in options if word not in KNOWN and word.split("=")[0] not in WITH_VALUE]
    missing = [str(file) for file in files if not file.is_file()]
    if unknown or missing or not files:
        sys.exit(f"cl2000_stand_in: unknown {unknown}, missing {missing}")
    if "--compile_only" in options and files[0].suffix == ".c":
        folders = [word.split("=", 1)[1] for word in options if word.startswith("--include_path=")]
        done = subprocess.run([*CLANG, *(f"-I{folder}" for folder in folders if pathlib.Path(folder).is_dir()), str(files[0])], check=False)
        if done.returncode != 0:
            sys.exit(done.returncode)
    pathlib.Path(values["--output_file"]).write_text("", encoding="utf-8")


main(sys.argv[1:])
