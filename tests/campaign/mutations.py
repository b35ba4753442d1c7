# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Damage to a file: what copies, disks, editors and attackers do to it."""

import re

NUMBERS = [b"nan", b"inf", b"-inf", b"-1", b"0", b"1e308", b"-1e308", b"1e-308", b"2147483648", b"-2147483649",
           b"18446744073709551616", b"", b"x", b"0x10", b"1e", b"1,5", b"\xc2\xa01"]
WORDS = [0, 1, 0x7F, 0x80, 0xFF, 0x7FFF, 0x8000, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 2**63 - 1, 2**63, 2**64 - 1]
NUMBER = re.compile(rb"[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")


def cut(data, chance):
    return data[:chance.randrange(len(data))]


def flip(data, chance):
    changed = bytearray(data)
    for _ in range(chance.choice([1, 1, 4, 32])):
        changed[chance.randrange(len(changed))] ^= 1 << chance.randrange(8)
    return bytes(changed)


def span(data, chance):
    begin = chance.randrange(len(data))
    return begin, min(len(data), begin + 1 + int(len(data) * chance.random() ** 4))


def leave_out(data, chance):
    begin, end = span(data, chance)
    return data[:begin] + data[end:]


def repeat(data, chance):
    begin, end = span(data, chance)
    return data[:end] + data[begin:end] * chance.choice([1, 3]) + data[end:]


def overwrite(data, chance):
    begin, end = span(data, chance)
    return data[:begin] + chance.choice([bytes(end - begin), b"\xff" * (end - begin), chance.randbytes(end - begin)]) + data[end:]


def word(data, chance):
    """An integer of a binary file, in either byte order, is an extreme one."""
    size = chance.choice([1, 2, 4, 8])
    at = chance.randrange(max(1, len(data) - size))
    value = chance.choice(WORDS) % 256**size
    return data[:at] + value.to_bytes(size, chance.choice(["little", "big"])) + data[at + size:]


def number(data, chance):
    """A number of a text file is another one."""
    found = list(NUMBER.finditer(data[:200000]))
    if not found:
        return flip(data, chance)
    for match in sorted(chance.sample(found, min(len(found), chance.choice([1, 1, 3]))), key=lambda m: -m.start()):
        data = data[:match.start()] + chance.choice(NUMBERS) + data[match.end():]
    return data


def lines(data, chance):
    """Lines are left out, exchanged, joined, or have one more beside them."""
    parts = data.split(b"\n")
    at, other = chance.randrange(len(parts)), chance.randrange(len(parts))
    kind = chance.randrange(5)
    if kind == 0:
        del parts[at]
    elif kind == 1:
        parts[at], parts[other] = parts[other], parts[at]
    elif kind == 2:
        parts[at] += parts[other]
    elif kind == 3:
        parts.insert(at, chance.choice([b"\0" * 8, b"\xff\xfe", b"'\"<script>&", b"9" * 5000, b"../" * 50, b"%s%n"]))
    else:
        parts = [part + b"\r" for part in parts]
    return b"\n".join(parts)


def empty(_data, _chance):
    return b""


MUTATIONS = [cut, flip, leave_out, repeat, overwrite, word, number, number, lines, lines, empty]


def mutate(data, chance):
    """The damaged bytes, and the names of what was done to them."""
    names = []
    for _ in range(chance.choice([1, 1, 1, 2, 4])):
        if not data:
            break
        mutation = chance.choice(MUTATIONS)
        data = mutation(data, chance)
        names.append(mutation.__name__)
    return data, names


