"""Draw the README's pictures again: `python docs/pictures/make.py`, from anywhere, in less than a minute."""

from __future__ import annotations

from pathlib import Path

import kirisurf
from docs.pictures.strip import TITLES, outlines, surfaces
from kirisurf.reproducing_figures import FIGURES

FOLDER = Path(__file__).resolve().parent
PUBLISHED = ("hypar", "paraboloid", "peaks", "mexicanhat2")


def main() -> None:
    """Write every picture."""
    practical = kirisurf.fit("saddle_roof", tiles=160), kirisurf.fit("face_mask", tiles=300)
    surfaces([("", design) for design in practical], FOLDER / "overview.png", (360, 250), tuple(TITLES))
    published = [(name, kirisurf.fit(name, cells=(4, 4))) for name in PUBLISHED]
    surfaces(published, FOLDER / "published.png", (350, 260), tuple(TITLES))
    planar = [(wanted.spec.target, kirisurf.fit(wanted.spec)) for wanted in FIGURES["fig2a"]]
    outlines(planar, FOLDER / "outlines.png", (450, 470))


if __name__ == "__main__":
    main()
