"""Damage to files, reproducible: bytes flipped, cut, repeated and swapped, numbers replaced by hostile ones."""

from __future__ import annotations

import os
import random
import re
import struct
from collections.abc import Callable, Iterator

TOKENS = (
    b"nan", b"inf", b"-inf", b"infinity", b"1e309", b"-1e400", b"1e-320", b"1e999999999", b"-1", b"0", b"-0", b"1e60",
    b"2147483648", b"4294967296", b"9223372036854775808", b"99999999999999999999999", b"9" * 5000, b"0x10", b"", b"-",
    b"1_000", b"1_0.5", b"\xd9\xa1\xd9\xa2", b"\xef\xbc\x91", b"1,5", b"1.#IND", b"1e", b"1d3", b"+-1", b"1.5.2", b".",
    b"\xff\xfe", b"\0", b"1e-400", b"True", b"null", b"[]", b"{}", b'"', b"<", b"&", b"%s", b"3.999999999999999999999",
)  # fmt: skip
"""What stands in hostile files where a number should."""

WORDS = tuple(
    struct.pack(order + code, value)
    for order in "<>"
    for code, values in (
        ("I", (0, 1, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0x7FC00000, 0x7F800000, 0x00000001)),
        ("d", (float("nan"), float("inf"), 1e308, 5e-324)),
    )
    for value in values
)
"""The same in binary: counts, indices, and numbers that are not finite."""

_NUMBER = re.compile(rb"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")


def _flipped(content: bytes, chance: random.Random) -> bytes:
    changed = bytearray(content)
    for _ in range(chance.choice((1, 1, 2, 8))):
        changed[chance.randrange(len(changed))] ^= 1 << chance.randrange(8)
    return bytes(changed)


def _cut(content: bytes, chance: random.Random) -> bytes:
    return content[: chance.randrange(len(content))]


def _span(content: bytes, chance: random.Random) -> tuple[int, int]:
    start = chance.randrange(len(content))
    return start, min(len(content), start + chance.choice((1, 2, 4, 16, 64, 256)))


def _without(content: bytes, chance: random.Random) -> bytes:
    start, end = _span(content, chance)
    return content[:start] + content[end:]


def _repeated(content: bytes, chance: random.Random) -> bytes:
    start, end = _span(content, chance)
    return content[:end] + content[start:end] * chance.choice((1, 2, 50)) + content[end:]


def _swapped(content: bytes, chance: random.Random) -> bytes:
    (a, b), (c, d) = sorted((_span(content, chance), _span(content, chance)))
    c, d = max(b, c), max(b, d)
    return content[:a] + content[c:d] + content[b:c] + content[a:b] + content[d:]


def _inserted(content: bytes, chance: random.Random) -> bytes:
    at = chance.randrange(len(content) + 1)
    return content[:at] + chance.choice((chance.randbytes(chance.randrange(1, 9)), *TOKENS)) + content[at:]


def _hostile(content: bytes, chance: random.Random) -> bytes:
    found = list(_NUMBER.finditer(content))
    if not found:
        return _inserted(content, chance)
    for match in sorted(
        chance.sample(found, min(len(found), chance.choice((1, 1, 1, 2, 5)))), key=lambda m: -m.start()
    ):
        content = content[: match.start()] + chance.choice(TOKENS) + content[match.end() :]
    return content


def _hostile_everywhere(content: bytes, chance: random.Random) -> bytes:
    """One number becomes the same hostile one wherever it stands."""
    found = sorted({match[0] for match in _NUMBER.finditer(content)})
    return content.replace(chance.choice(found), chance.choice(TOKENS)) if found else _inserted(content, chance)


def _renumbered(content: bytes, chance: random.Random) -> bytes:
    """One number becomes another of the same file: indices and counts that lie but look right."""
    found = list(_NUMBER.finditer(content))
    if len(found) < 2:
        return _flipped(content, chance)
    here, other = chance.sample(found, 2)
    return content[: here.start()] + other[0] + content[here.end() :]


def _overwritten(content: bytes, chance: random.Random) -> bytes:
    word = chance.choice(WORDS)
    at = chance.randrange(max(1, len(content) - len(word)))
    at -= at % chance.choice((1, 4))
    return content[:at] + word + content[at + len(word) :]


def _reordered(content: bytes, chance: random.Random) -> bytes:
    lines = content.splitlines(keepends=True)
    a, b = chance.randrange(len(lines)), chance.randrange(len(lines))
    match chance.randrange(3):
        case 0:
            lines[a], lines[b] = lines[b], lines[a]
        case 1:
            del lines[a]
        case _:
            lines[a:a] = [lines[b]] * chance.choice((1, 3))
    return b"".join(lines)


MUTATIONS: tuple[Callable[[bytes, random.Random], bytes], ...] = (
    _flipped, _cut, _without, _repeated, _swapped, _inserted, _hostile, _hostile, _hostile_everywhere, _renumbered,
    _overwritten, _reordered,
)  # fmt: skip


def mutated(content: bytes, seed: int) -> bytes:
    """Return a damaged copy; the same seed gives the same damage."""
    chance = random.Random(seed)
    for _ in range(chance.choice((1, 1, 1, 2, 4))):
        if content:
            content = chance.choice(MUTATIONS)(content, chance)
    return content


def truncated(content: bytes) -> Iterator[bytes]:
    """Return every beginning of a content."""
    return (content[:length] for length in range(len(content)))


def rounds(usual: int) -> range:
    """Return the seeds of a test: as many as usual, or KIRISURF_MUTATIONS times as many for a long run by hand."""
    return range(int(usual * float(os.environ.get("KIRISURF_MUTATIONS", "1"))))


def check_message(problem: Exception, name: str) -> None:
    """Hold an error to its form: one printable line that names the file."""
    message = str(problem)
    assert message.isprintable(), message
    assert name in message, message
    assert len(message) < 500, message
