"""A program that fits some targets in a row and prints the hash of every number it wrote.

    python fits_in_a_row.py FOLDER CASE...

One JSON object: {"cases": {case: {file: hash}}, "workers": threads of the largest factorization}.
"""

from __future__ import annotations

import hashlib
import json
import sys
from pathlib import Path

import numpy as np

import kirisurf
from kirisurf.solvers.symbolic import Symbolic

CASES = {
    "quad": ("hypar", {"cells": (4, 4)}),
    "mesh": ("mesh", {"tiles": 120}),
    "kagome": ("hypar", {"cells": (4, 4), "tessellation": "kagome"}),
    "hexagon": ("paraboloid", {"cells": (3, 3), "tessellation": "hexagon"}),
    "islamic": ("hypar", {"cells": (2, 2), "tessellation": "islamic-quad"}),
    "morphed": ("circle", {"cells": (3, 3)}),
    "trimmed": ("heart", {"tiles": 80}),
    "exact": ("hypar", {"cells": (3, 3), "closeness": "exact"}),
    "rectangle": ("hypar", {"cells": (3, 3), "contracted": "rectangle"}),
    "bending": ("hypar", {"cells": (3, 3), "prefer": "curvature"}),
    "large": ("peaks", {"cells": (16, 16)}),
}
"""Every way from a target to a sheet; the large one is factored by a team of threads."""


def hashes(case: str, folder: Path) -> dict[str, str]:
    """Fit a case, save it, and return the hash of every file; of the record without what is measured in seconds."""
    name, options = CASES[case]
    target = _mesh() if name == "mesh" else name
    run = kirisurf.fit(target, **options).save(folder / case, pictures=False)
    found = {path.name: path.read_bytes() for path in sorted(run.folder.iterdir())}
    record = {key: value for key, value in json.loads(found["result.json"]).items() if key != "seconds"}
    found["result.json"] = json.dumps(record).encode()
    return {name: hashlib.sha256(content).hexdigest() for name, content in found.items()}


def _mesh() -> tuple[np.ndarray, np.ndarray]:
    """A mesh without a formula and without four corners: a bumpy disk."""
    rings, spokes = 12, 36
    angle = 2 * np.pi * np.arange(spokes) / spokes
    radius = np.arange(1, rings + 1)[:, None] / rings
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    points = np.stack([x, y, 0.15 * np.sin(3 * x) * np.cos(2 * y)], axis=2).reshape(-1, 3)
    ring, spoke = np.divmod(np.arange((rings - 1) * spokes), spokes)
    a, b = 1 + ring * spokes + spoke, 1 + ring * spokes + (spoke + 1) % spokes
    fan = np.stack([np.zeros(spokes, int), 1 + np.arange(spokes), 1 + (np.arange(spokes) + 1) % spokes], axis=1)
    quads = np.concatenate([np.stack([a, a + spokes, b + spokes], axis=1), np.stack([a, b + spokes, b], axis=1)])
    return np.concatenate([np.zeros((1, 3)), points]), np.concatenate([fan, quads])


def main(folder: str, *cases: str) -> None:
    """Fit the cases in the order that they have here."""
    workers = [0]
    share = Symbolic._share

    def watched(symbolic: Symbolic, parents: np.ndarray, flops: np.ndarray) -> None:
        share(symbolic, parents, flops)
        workers.append(symbolic.n_workers)

    Symbolic._share = watched  # type: ignore[method-assign]
    found = {case: hashes(case, Path(folder)) for case in cases}
    sys.stdout.write(json.dumps({"cases": found, "workers": max(workers)}))


if __name__ == "__main__":
    main(*sys.argv[1:])
