"""What is measured: targets, sizes, and the solvers that can treat them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from kirisurf.errors import ParameterError
from kirisurf.solvers.optional import is_installed

OURS = "newton"
DENSE = ("slsqp", "trust-constr")
SPARSE = ("ipopt", "uno")
PEERS = (*DENSE, *SPARSE)
GRIDS = {"hypar": (8, 16, 32, 64), "peaks": (8, 16, 32, 64), "mexicanhat2": (16, 32)}
LARGE = {"hypar": (128, 256), "peaks": (128, 256)}
TRIMMED = ("car_hood", "dome", "face_mask", "saddle_roof", "terrain", "vault")
TRIMMED_TILES = 360
MESHES = (".stl", ".obj", ".ply", ".off", ".vtp", ".vtk", ".glb", ".gltf")
MOST_TILES = {**dict.fromkeys(DENSE, 64), **dict.fromkeys(SPARSE, 256)}
"""Sizes that every peer is asked for: beyond, its rows would be time limits."""
COMPARED = ("hypar", "peaks")


@dataclass(frozen=True)
class Problem:
    """A target and a size.

    Attributes
    ----------
    target : str
        A sample's name, or a file.
    grid : int
        Tiles a side, or 0.
    tiles : int
        Tiles of a trimmed pattern, or 0.
    """

    target: str
    grid: int = 0
    tiles: int = 0

    @property
    def name(self) -> str:
        """What the table calls it."""
        target = Path(self.target).stem if "/" in self.target else self.target
        return f"{target} {self.grid}x{self.grid}" if self.grid else f"{target} ~{self.tiles}"

    @property
    def options(self) -> dict[str, Any]:
        """Options of a fit."""
        return {"cells": (self.grid // 2, self.grid // 2)} if self.grid else {"tiles": self.tiles}

    def solvers(self, peers: Sequence[str]) -> list[str]:
        """Our solver, then the peers that can treat this size."""
        if not self.grid or self.target not in COMPARED:
            return [OURS]
        return [OURS, *(peer for peer in peers if self.grid**2 <= MOST_TILES[peer])]


def parsed(text: str) -> Problem:
    """Read NAME:NxN (a grid of tiles) or NAME:N (about so many tiles, trimmed).

    Raises
    ------
    ParameterError
        Where the text has another form.
    """
    match = re.fullmatch(r"(.+):(\d+)(?:x(\d+))?", text)
    if match is None or match[3] not in (None, match[2]) or (match[3] and int(match[2]) % 2):
        raise ParameterError(f"--problems: expected NAME:NxN with an even N, or NAME:N, got {text!r}")
    size = int(match[2])
    return Problem(match[1], grid=size) if match[3] else Problem(match[1], tiles=size)


def standard(large: bool = False, meshes: Path | None = None) -> list[Problem]:
    """The problems of `make bench`."""
    found = [Problem(target, grid=size) for target, sizes in GRIDS.items() for size in sizes]
    if large:
        found += [Problem(target, grid=size) for target, sizes in LARGE.items() for size in sizes]
    found += [Problem(target, tiles=TRIMMED_TILES) for target in TRIMMED]
    if meshes is not None:
        files = sorted(path for path in meshes.iterdir() if path.suffix.lower() in MESHES)
        found += [Problem(str(path.absolute()), tiles=TRIMMED_TILES) for path in files]
    return found


def installed_peers() -> tuple[str, ...]:
    """The peers that can be run here."""
    return tuple(peer for peer in PEERS if is_installed(peer))
