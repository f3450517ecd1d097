"""
Memory of a function: bytes of code and constants that it adds to an image, and its worst-case stack.

Bytes: every function and constant has its own section (-ffunction-sections, -fdata-sections). Relocations lead from a function's section
to all that it needs; the sizes are those of the linked image.
Stack: frames and calls from the compiler (-fcallgraph-info=su). Recursion, an indirect call, a frame of unknown size or a call to an
unknown object is an error.
"""
import pathlib
import re

import elf32

# Constants that belong to the benchmark and not to what it measures.
NOT_COUNTED = {"bench_config"}

# Calls that a compiler may make on its own, and their frames in the targets' C libraries (bytes, as pushed by
# their code: newlib-nano's memcpy pushes r4 and lr, its memset r4; picolibc's hold everything in registers. The 64-bit
# division pushes 16 bytes and calls one that pushes eight registers; on RV32 it has no frame).
LIBRARY_FRAMES = {"memcpy": 16, "memset": 16, "__aeabi_ldivmod": 48, "__aeabi_uldivmod": 48, "__divdi3": 0, "__udivdi3": 0}


class Footprint:
    def __init__(self, image, objects):
        self.objects = [elf32.read(path) for path in objects]
        self.sizes = {}
        self.library = set()
        for symbol in elf32.read(image).symbols:
            if symbol.name and symbol.kind in (elf32.STT_FUNC, elf32.STT_OBJECT):
                self.sizes.setdefault(symbol.name, symbol.size)
        self.home = {}
        for elf in self.objects:
            for symbol in elf.symbols:
                if symbol.section and symbol.name in self.sizes and symbol.kind in (1, 2):
                    self.home.setdefault(symbol.name, (elf, symbol.section))
        self.frames, self.calls = {}, {}
        for path in objects:
            self._read_calls(pathlib.Path(path).with_suffix(".ci"))

    def _read_calls(self, path):
        """Reads one file of frames and calls. A static function's title is `file:name`; the name alone is unique here."""
        text = path.read_text()
        for title, label in re.findall(r'^node: \{ title: "([^"]*)" label: "([^"]*)"', text, re.M):
            frame = re.search(r"(\d+) bytes \((\w[\w,]*)\)", label)
            name = title.split(":")[-1]
            if frame:
                if frame.group(2) != "static":
                    raise SystemExit(f"{path}: the frame of {name} is not of a fixed size")
                self.frames[name] = int(frame.group(1))
        for source, target in re.findall(r'^edge: \{ sourcename: "([^"]*)" targetname: "([^"]*)"', text, re.M):
            self.calls.setdefault(source.split(":")[-1], set()).add(target.split(":")[-1])

    def _reachable(self, roots):
        """Sections that the roots need, as (object, section index)."""
        seen, todo = set(), []
        for root in roots:
            if root not in self.home:
                raise SystemExit(f"{root} is not among the objects")
            todo.append(self.home[root])
        while todo:
            elf, section = todo.pop()
            if (id(elf), section) in seen:
                continue
            seen.add((id(elf), section))
            yield elf, section
            for index in elf.references.get(section, ()):
                symbol = elf.symbols[index]
                if symbol.section:
                    todo.append((elf, symbol.section))
                elif symbol.name in self.home:
                    todo.append(self.home[symbol.name])
                elif symbol.name in self.sizes:
                    self.library.add(symbol.name)

    def bytes_of(self, roots):
        """(code, constants) of all that the roots need. A call into the C library is named in `library`."""
        self.library = set()
        code = constants = 0
        for elf, section in self._reachable(roots):
            flags = elf.sections[section].flags
            for name in {s.name for s in elf.symbols if s.section == section and s.kind in (1, 2)} - NOT_COUNTED:
                if flags & elf32.SHF_EXECINSTR:
                    code += self.sizes.get(name, 0)
                elif flags & elf32.SHF_ALLOC and not flags & elf32.SHF_WRITE:
                    constants += self.sizes.get(name, 0)
        return code + sum(self.sizes[name] for name in self.library), constants

    def stack_of(self, root, path=()):
        """The deepest stack in bytes below and including the root's frame."""
        if root in path:
            raise SystemExit("recursion: " + " -> ".join(path[path.index(root) :] + (root,)))
        if root == "__indirect_call":
            raise SystemExit(f"an indirect call in {path[-1]}: its stack cannot be known")
        if root not in self.frames:
            if root in LIBRARY_FRAMES:
                return LIBRARY_FRAMES[root]
            raise SystemExit(f"{path[-1] if path else '?'} calls {root}, whose frame is not known")
        below = [self.stack_of(called, path + (root,)) for called in self.calls.get(root, ())]
        return self.frames[root] + max(below, default=0)

    def size_of(self, name):
        return self.sizes[name]
