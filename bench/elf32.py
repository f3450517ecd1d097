"""Reads sections, symbols and relocations of a 32-bit little-endian ELF file."""
import struct
from dataclasses import dataclass, field

SHT_SYMTAB, SHT_RELA, SHT_REL = 2, 4, 9
SHF_ALLOC, SHF_EXECINSTR, SHF_WRITE = 2, 4, 1
STT_OBJECT, STT_FUNC = 1, 2


@dataclass
class Section:
    name: str
    kind: int
    flags: int
    offset: int
    size: int
    link: int
    info: int


@dataclass
class Symbol:
    name: str
    value: int
    size: int
    kind: int
    section: int


@dataclass
class Elf:
    path: str
    sections: list = field(default_factory=list)
    symbols: list = field(default_factory=list)
    # Section index -> indices of the symbols that the section refers to.
    references: dict = field(default_factory=dict)


def _text(table, start):
    return table[start : table.index(b"\0", start)].decode()


def read(path):
    with open(path, "rb") as file:
        data = file.read()
    if data[:6] != b"\x7fELF\x01\x01":
        raise ValueError(f"{path}: no 32-bit little-endian ELF file")
    elf = Elf(str(path))
    (table_at,) = struct.unpack_from("<I", data, 32)
    entry_size, count, names = struct.unpack_from("<HHH", data, 46)
    raw = [struct.unpack_from("<10I", data, table_at + k * entry_size) for k in range(count)]
    name_table = data[raw[names][4] : raw[names][4] + raw[names][5]]
    for name, kind, flags, _, offset, size, link, info, _, _ in raw:
        elf.sections.append(Section(_text(name_table, name), kind, flags, offset, size, link, info))
    for section in elf.sections:
        if section.kind == SHT_SYMTAB:
            strings = elf.sections[section.link]
            table = data[strings.offset : strings.offset + strings.size]
            for at in range(section.offset, section.offset + section.size, 16):
                name, value, size, info, _, index = struct.unpack_from("<IIIBBH", data, at)
                elf.symbols.append(Symbol(_text(table, name), value, size, info & 15, index))
    for section in elf.sections:
        if section.kind in (SHT_REL, SHT_RELA):
            step = 8 if section.kind == SHT_REL else 12
            targets = elf.references.setdefault(section.info, set())
            for at in range(section.offset, section.offset + section.size, step):
                targets.add(struct.unpack_from("<II", data, at)[1] >> 8)
    return elf
