"""Draw the gallery again and write its page: `python docs/gallery/make.py [NAME ...]`, from anywhere.

Without names all is made, in some minutes; with names only those pictures are drawn, and their numbers on the page
replaced.
"""

from __future__ import annotations

import re
import sys
import textwrap
from pathlib import Path

import kirisurf
from docs.gallery.example import Example, Measured
from docs.gallery.outlines import OUTLINES
from docs.gallery.surfaces import SURFACES
from docs.pictures.strip import outlines, surfaces
from kirisurf.outlines import title
from sample_surfaces import spec

FOLDER = Path(__file__).resolve().parent
PAGE = FOLDER.parent / "gallery.md"
COLUMNS = ("target", "pattern", "deployed", "gaussian_curvature")
LEAD = """\
# Gallery

Every sample surface and every planar outline that comes along, as an example: the picture, the line that makes the
sheet, and one number of it that has to be what the formula of the sample says, within what the size of the tiles
leaves. The expected values are worked out apart from the code that makes the sheets, in `docs/gallery/surfaces.py` and
`docs/gallery/outlines.py`; `tests/sample_surfaces/test_gallery.py` makes every sheet again and asserts its number, and
`.venv/bin/python docs/gallery/make.py` draws this page.

All pictures of a row have one scale. Holes are colored by the Gaussian curvature of a patch through the tiles round
them, red where it is positive as on a sphere, blue where it is negative as on a saddle, gray without; the bar ends at
the 98th percentile of all holes. Planar outlines are drawn in blue, over the open sheet. h is the side of the square
that every tile has of the target.
"""


def main(names: list[str]) -> None:
    """Write the pictures of the examples, and the page."""
    known = [each.name for each in SURFACES + OUTLINES]
    if unknown := set(names) - set(known):
        raise SystemExit(f"expected some of {', '.join(known)}, got {', '.join(sorted(unknown))}")
    page = PAGE.read_text(encoding="utf-8") if names else ""
    parts = [LEAD]
    for heading, examples in (("Surfaces", SURFACES), ("Outlines", OUTLINES)):
        parts.append(f"\n## {heading}\n\n{_index(examples)}\n")
        for example in examples:
            if names and example.name not in names:
                parts.append(_kept(page, example))
                continue
            design = example.design()
            _draw(example, design)
            parts.append(_section(example, design, example.measure(design)))
    PAGE.write_text("".join(parts), encoding="utf-8")


def _draw(example: Example, design: kirisurf.Design) -> None:
    picture = FOLDER / f"{example.name}.png"
    if example in SURFACES:
        surfaces([("", design)], picture, (320, 230), COLUMNS)
    else:
        outlines([("", design)], picture, (470, 370))


def _section(example: Example, design: kirisurf.Design, measured: Measured) -> str:
    if not (design.certificate.passed and measured.is_met):
        raise SystemExit(f"{example.name}: expected a certified sheet that meets its number, got {measured}")
    sample = spec(example.name) if example in SURFACES else None
    words = title(example.name) if sample is None else f"{sample.title}: {sample.formula}"
    if sample is not None and sample.units != "1":
        words += f" (in {sample.units})"
    pattern = design.tessellation.name
    unit = example.unit if example.unit == "°" or not example.unit else f" {example.unit}"
    digits = 6 if measured.tolerance < 1e-6 * max(abs(measured.expected), 1) else 4
    value, expected = (_text(number, digits) for number in (measured.value, measured.expected))
    if abs(measured.value) <= 1e-9 and measured.expected == 0:
        value = _text(measured.value, 1)
    text = (
        f"{design.tessellation.n_tiles} tiles ({pattern}). {_sentence(example.quantity)}: **{value}{unit}**, expected "
        f"{expected} ± {_text(measured.tolerance, 1)} ({example.derivation}). {example.reason}"
    )
    return f"""
### {example.name}

{textwrap.fill(words + ".", 119)}

![{example.name}: {design.tessellation.n_tiles} tiles ({pattern}), {_columns(example)}](gallery/{example.name}.png)

```sh
{example.command}
```

{textwrap.fill(text, 119)}
"""


def _index(examples: tuple[Example, ...]) -> str:
    links = " ·\n".join(f"[{each.name}](#{each.name})" for each in examples)
    return textwrap.fill(links, 119, break_on_hyphens=False)


def _columns(example: Example) -> str:
    if example in SURFACES:
        return "target, flat and closed, opened on the target, Gaussian curvature of the holes"
    return "flat and closed, open in its outline"


def _kept(page: str, example: Example) -> str:
    found = re.search(rf"\n### {re.escape(example.name)}\n.*?(?=\n##|\Z)", page, re.S)
    if found is None:
        raise SystemExit(f"{PAGE}: expected a section on {example.name}, got none; make it with all others")
    return found.group()


def _sentence(words: str) -> str:
    return words[:1].upper() + words[1:]


def _text(number: float, digits: int) -> str:
    return f"{number:.{digits}g}".replace("e-0", "e-").replace("-", "\N{MINUS SIGN}")


if __name__ == "__main__":
    main(sys.argv[1:])
