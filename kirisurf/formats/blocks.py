"""Multiblock files (VTM) and time series (PVD): small XML files that name the VTP files they consist of."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from xml.sax.saxutils import quoteattr

from kirisurf.errors import OutputError
from kirisurf.formats.pieces import pieces_folder, write_with_pieces
from kirisurf.naming import printable


def vtm_text(files: Mapping[str, str]) -> str:
    """Return a multiblock file of named blocks.

    Parameters
    ----------
    files : mapping of str to str
        Name of a block to its VTP file, relative to the multiblock file.

    Examples
    --------
    >>> print(vtm_text({"tiles": "deployed.vtp"}).splitlines()[3].strip())
    <DataSet index="0" name="tiles" file="deployed.vtp"/>
    """
    lines = [
        f"    <DataSet index={quoteattr(str(k))} name={quoteattr(name)} file={quoteattr(file)}/>"
        for k, (name, file) in enumerate(files.items())
    ]
    return _xml("vtkMultiBlockDataSet", "1.0", lines)


def pvd_text(steps: Sequence[tuple[float, Mapping[str, str]]]) -> str:
    """Return a time series.

    Parameters
    ----------
    steps : sequence of (float, mapping of str to str)
        Time and, for every part, its name and VTP file; the same parts in every step.

    Examples
    --------
    >>> print(pvd_text([(0.5, {"tiles": "a.vtp"})]).splitlines()[3].strip())
    <DataSet timestep="0.5" group="" part="0" name="tiles" file="a.vtp"/>
    """
    lines = [
        f'    <DataSet timestep={quoteattr(repr(float(time)))} group="" part={quoteattr(str(k))} '
        f"name={quoteattr(name)} file={quoteattr(file)}/>"
        for time, parts in steps
        for k, (name, file) in enumerate(parts.items())
    ]
    return _xml("Collection", "0.1", lines)


def write_vtm(path: str | os.PathLike[str], blocks: Mapping[str, bytes]) -> None:
    """Write a multiblock file, its blocks as VTP files in a folder beside it.

    Parameters
    ----------
    path : path
    blocks : mapping of str to bytes
        Name of a block to the content of its VTP file; any names.

    Raises
    ------
    OutputError
        Where something cannot be written; what was there is untouched.
    """
    names = {name: _file(k, name) for k, name in enumerate(blocks)}
    index = vtm_text({name: _beside(path, file) for name, file in names.items()})
    write_with_pieces(path, index, ((names[name], content) for name, content in blocks.items()))


def write_pvd(
    path: str | os.PathLike[str], times: Sequence[float], parts: Sequence[str], frames: Iterable[Sequence[bytes]]
) -> None:
    """Write a time series, its frames as VTP files in a folder beside it.

    Parameters
    ----------
    path : path
    times : sequence of float
    parts : sequence of str
        Names of the parts of every frame.
    frames : iterable of sequence of bytes
        Contents of the VTP files of every frame, one for each part; taken one after the other.

    Raises
    ------
    OutputError
        Where something cannot be written; what was there is untouched.
    """
    names = [{part: f"{k:04d}_{_file(j, part)}" for j, part in enumerate(parts)} for k in range(len(times))]
    steps = [
        (time, {part: _beside(path, file) for part, file in files.items()})
        for time, files in zip(times, names, strict=True)
    ]

    def pieces() -> Iterator[tuple[str, bytes]]:
        for files, contents in zip(names, frames, strict=True):
            yield from zip(files.values(), contents, strict=True)

    write_with_pieces(path, pvd_text(steps), pieces())


def _file(number: int, name: str) -> str:
    """File name of a block: its own name where that is a plain word."""
    return f"{name}.vtp" if name.isascii() and name.isalnum() else f"block{number}.vtp"


def _beside(path: str | os.PathLike[str], file: str) -> str:
    folder = pieces_folder(path).name
    if not printable(folder) == folder:
        raise OutputError(f"{os.fsdecode(path)!r}: expected a name that can stand in an XML file, got another")
    return f"{folder}/{file}"


def _xml(kind: str, version: str, lines: Sequence[str]) -> str:
    return "\n".join(
        [
            '<?xml version="1.0" encoding="UTF-8"?>',
            f'<VTKFile type="{kind}" version="{version}" byte_order="LittleEndian">',
            f"  <{kind}>",
            *lines,
            f"  </{kind}>",
            "</VTKFile>",
            "",
        ]
    )
