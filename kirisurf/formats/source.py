"""From a path to the bytes of a file and the name of its format, with nothing believed on the way.

The suffix says what the file claims to be and the content must agree: a PLY that is called .off is
refused, since whoever renamed it may have meant another file. Without a suffix the content decides.
"""

from __future__ import annotations

import os
import re
import stat
from dataclasses import dataclass
from pathlib import Path

from kirisurf.errors import UnreadableError, UnusableError
from kirisurf.formats.polygons import shown
from kirisurf.naming import printable

FORMATS = {
    ".stl": "stl",
    ".obj": "obj",
    ".ply": "ply",
    ".off": "off",
    ".vtp": "vtp",
    ".vtk": "vtk",
    ".gltf": "gltf",
    ".glb": "glb",
}
LIMIT_MB = 512
_KNOWN_ELSEWHERE = (
    (b"\x89PNG", "a PNG picture"),
    (b"\xff\xd8\xff", "a JPEG picture"),
    (b"GIF8", "a GIF picture"),
    (b"%PDF", "a PDF document"),
    (b"PK\x03\x04", "a ZIP archive (also 3MF): unpack it, or export STL, OBJ or PLY"),
    (b"\x1f\x8b", "a gzip archive: unpack it first"),
    (b"\x93NUMPY", "a NumPy array"),
    (b"\x7fELF", "a program"),
    (b"\x89HDF", "an HDF5 file"),
)


@dataclass(frozen=True)
class Source:
    """The content of one file.

    Attributes
    ----------
    path : Path
    format : str
        One of the values of FORMATS.
    content : bytes
    """

    path: Path
    format: str
    content: bytes

    @property
    def name(self) -> str:
        """File name, for messages and for the surface."""
        return printable(self.path.name)


def load(path: str | os.PathLike[str], limit_mb: int | float = LIMIT_MB) -> Source:
    """Read the bytes of a file and recognize its format.

    Raises
    ------
    UnreadableError
        Where it is missing, no plain file, too large, of an unsupported format, or not what its suffix says.
    UnusableError
        Where it is empty.
    """
    path = Path(path)
    content = read_bytes(path, limit_mb)
    if not content.strip():
        raise UnusableError(f"{path}: expected a surface, got an empty file")
    if content.startswith(b"version https://git-lfs"):
        raise UnreadableError(
            f"{path}: expected a surface, got a Git LFS pointer: the file itself was never fetched (git lfs pull)"
        )
    if not content.strip(b"\0"):
        raise UnreadableError(f"{path}: expected {_list_of_formats()}, got {len(content)} zero bytes: it is damaged")
    suffix = path.suffix.lower()
    content = _plain_text(content, path)
    seen = _seen(content)
    wanted = FORMATS.get(suffix, "")
    if seen.startswith(("a ", "an ")) and not (wanted == "stl" and is_binary_stl(content)):
        raise UnreadableError(f"{path}: expected {_list_of_formats()}, got {seen}")
    if not wanted and suffix:
        raise UnreadableError(f"{path}: expected {_list_of_formats()}, got a file called {suffix}")
    if not wanted and not seen:
        raise UnreadableError(f"{path}: expected a suffix ({', '.join(FORMATS)}), got none and an unknown content")
    if wanted and seen and seen != wanted and not (wanted == "stl" and is_binary_stl(content)):
        raise UnreadableError(
            f"{path}: expected {wanted.upper()} content as the suffix says, got {seen.upper()}: rename it to what it is"
        )
    return Source(path, wanted or seen, content)


def is_binary_stl(content: bytes) -> bool:
    """Return True where the length is exactly that of the binary STL which the content announces."""
    return len(content) >= 84 and len(content) == 84 + 50 * int.from_bytes(content[80:84], "little")


def read_bytes(path: Path, limit_mb: int | float) -> bytes:
    """Return the content of a plain file of at most so many megabytes, whatever else the path may lead to.

    Raises
    ------
    UnreadableError
        Where it is missing, no plain file, or too large.
    """
    try:
        # Non-blocking, so that a named pipe answers instead of waiting for ever.
        handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    except (OSError, ValueError) as problem:
        reason = getattr(problem, "strerror", None) or str(problem)
        raise UnreadableError(f"{path}: expected a file that can be read, got: {reason}") from None
    found = os.fstat(handle)
    if not stat.S_ISREG(found.st_mode):
        os.close(handle)
        kind = "a folder" if stat.S_ISDIR(found.st_mode) else "a device or pipe"
        raise UnreadableError(f"{path}: expected a file, got {kind}")
    with os.fdopen(handle, "rb") as file:
        if found.st_size > limit_mb * 1e6:
            raise UnreadableError(f"{path}: expected at most {limit_mb:g} MB, got {found.st_size / 1e6:.4g} MB")
        if not found.st_size:  # empty, or a door to the system of which no end is known
            return b""
        try:
            # no more than there is: Python makes room for all that is asked for, whatever comes
            return file.read(found.st_size + 1)
        except OSError as problem:
            raise UnreadableError(f"{path}: expected a file that can be read, got: {problem.strerror}") from None


def _plain_text(content: bytes, path: Path) -> bytes:
    """Return UTF-16 text as UTF-8 and drop a byte order mark; other content as it is."""
    if content.startswith(b"\xef\xbb\xbf"):
        return content[3:]
    if content.startswith((b"\xfe\xff", b"\xff\xfe")):
        try:
            return content.decode("utf-16").encode("utf-8")
        except UnicodeDecodeError:
            raise UnreadableError(f"{path}: expected UTF-16 text after its byte order mark, got damaged text") from None
    return content


def _seen(content: bytes) -> str:
    """Name the format by its first bytes, or say in words what it is instead; empty where they tell nothing."""
    head = content[:4096].lstrip()
    for magic, what in _KNOWN_ELSEWHERE:
        if content.startswith(magic):
            return what
    if head.startswith(b"ply"):
        return "ply"
    if head.startswith(b"glTF"):
        return "glb"
    if re.match(rb"(ST)?C?N?4?n?OFF", head):
        return "off"
    if head.startswith(b"# vtk DataFile"):
        return "vtk"
    if head.startswith((b"<?xml", b"<VTKFile")):
        if b'"PolyData"' in content[:65536] or b"'PolyData'" in content[:65536]:
            return "vtp"
        return "an XML file that holds no VTK PolyData"
    if head.startswith(b"{"):
        return "gltf"
    if head.startswith(b"solid") or is_binary_stl(content):
        return "stl"
    if re.match(rb"(#[^\n]*\n\s*|(mtllib|o|g)\b[^\n]*\n\s*)*v[ \t]+[-+.\d]", head):
        return "obj"
    return ""


def _list_of_formats() -> str:
    return "STL, OBJ, PLY, OFF, VTP, VTK or glTF"


def text_lines(source: Source) -> list[bytes]:
    """Split a text format into lines; refuse content that holds NUL bytes.

    Raises
    ------
    UnreadableError
        Where the content is not text.
    """
    position = source.content.find(b"\0")
    if position >= 0:
        raise UnreadableError(
            f"{source.name}: expected {source.format.upper()} text, got binary content "
            f"({shown(source.content[max(0, position - 8) : position + 8])} at byte {position})"
        )
    return source.content.splitlines()
