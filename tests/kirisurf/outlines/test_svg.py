"""Outlines from SVG: every shape and command, transforms, units, and what must be refused."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from kirisurf.errors import KirisurfError, UnreadableError, UnusableError
from kirisurf.outlines import Outline, read_outline

PAGE = 'width="200mm" height="100mm" viewBox="0 0 200 100"'


def _read(folder: Path, body: str, page: str = PAGE, units: str | None = None) -> tuple[Outline, tuple[str, ...]]:
    path = folder / "drawing.svg"
    path.write_text(f'<?xml version="1.0"?><svg xmlns="http://www.w3.org/2000/svg" {page}>{body}</svg>')
    return read_outline(path, units)


SHAPES = {
    '<rect x="10" y="20" width="30" height="40"/>': (1200, 4, (10, 40, 40, 80)),
    '<rect x="10" y="20" width="30" height="40" rx="5"/>': (1200 - 25 * (4 - math.pi), 0, (10, 40, 40, 80)),
    '<rect x="10" y="20" width="30" height="40" rx="15" ry="99"/>': (math.pi * 15 * 20, 0, (10, 40, 40, 80)),
    '<circle cx="50" cy="50" r="20"/>': (400 * math.pi, 0, (30, 30, 70, 70)),
    '<ellipse cx="50" cy="50" rx="20" ry="10"/>': (200 * math.pi, 0, (30, 40, 70, 60)),
    '<polygon points="0,0 40,0 40,30"/>': (600, 3, (0, 70, 40, 100)),
    '<polyline points="0,0 40,0 40,30 0 0"/>': (600, 3, (0, 70, 40, 100)),
    '<path d="M10 10H40V30H10Z"/>': (600, 4, (10, 70, 40, 90)),
    '<path d="m10,10 30,0 0,20-30,0z"/>': (600, 4, (10, 70, 40, 90)),
    '<path d="m10 10h30v20h-30v-20"/>': (600, 4, (10, 70, 40, 90)),
    '<path d="M30,50\na20,20\n0 1\n0 40,0 a20 20 0 1 0-40 0Z"/>': (400 * math.pi, 0, (30, 30, 70, 70)),
    '<path d="M30 50A20 10 0 0 1 70 50A20,10,0,01,30,50"/>': (200 * math.pi, 0, (30, 40, 70, 60)),
    '<path d="M30 50A1 1 0 0 1 70 50A1,1,0,01,30,50"/>': (400 * math.pi, 0, (30, 30, 70, 70)),
    '<path d="M0 50A30 20 90 0 1 40 50A30 20 90 0 1 0 50"/>': (600 * math.pi, 0, (0, 20, 40, 80)),
    # Parabolas: two thirds of chord times height, the height being half that of the control point.
    '<path d="M0 50Q20 10 40 50L0 50"/>': (2 / 3 * 40 * 20, 2, (0, 50, 40, 70)),
    '<path d="M0 50q20-40 40 0t40 0V80H0z"/>': (80 * 30, 4, None),
    '<path d="M0 50C0 10 40 10 40 50S0 90 0 50"/>': (None, 0, (0, 20, 40, 80)),
    '<path d="M0 50c0-40 40-40 40 0s-40 40-40 0"/>': (None, 0, (0, 20, 40, 80)),
    '<line x1="0" y1="0" x2="40" y2="0"/><path d="M40 0 40 30L0 0"/>': (600, 3, (0, 70, 40, 100)),
    '<path d="M 1e1 1.E1 L 4.e+1 010 L 40 30. z"/>': (300, 3, (10, 70, 40, 90)),
}


@pytest.mark.parametrize("body", SHAPES)
def test_shapes_have_their_area_and_place(body: str, tmp_path: Path) -> None:
    area, corners, box = SHAPES[body]
    found, notes = _read(tmp_path, body)
    assert found.units == "mm" and found.n_corners == corners and notes == ()
    if area is not None:
        np.testing.assert_allclose(found.area, area, rtol=1e-13)
    if box is not None:
        np.testing.assert_allclose(found.box.ravel(), box, atol=0.05)


def test_smooth_and_reflected_commands_agree_with_plain_ones(tmp_path: Path) -> None:
    short, _ = _read(tmp_path, '<path d="M0 50C0 10 40 10 40 50S0 90 0 50Z"/>')
    plain, _ = _read(tmp_path, '<path d="M0 50C0 10 40 10 40 50C40 90 0 90 0 50Z"/>')
    np.testing.assert_array_equal(short.curve.polynomials, plain.curve.polynomials)


@pytest.mark.parametrize(
    ("transform", "matrix"),
    [
        ("translate(5)", [[1, 0, 5], [0, 1, 0]]),
        ("translate(5 -3)", [[1, 0, 5], [0, 1, -3]]),
        ("scale(2)", [[2, 0, 0], [0, 2, 0]]),
        ("scale(2,0.5)", [[2, 0, 0], [0, 0.5, 0]]),
        ("rotate(90)", [[0, -1, 0], [1, 0, 0]]),
        ("rotate(180,10,20)", [[-1, 0, 20], [0, -1, 40]]),
        ("skewX(45)", [[1, 1, 0], [0, 1, 0]]),
        ("skewY(45)", [[1, 0, 0], [1, 1, 0]]),
        ("matrix(1 2 3 4 5 6)", [[1, 3, 5], [2, 4, 6]]),
        ("translate(5,5),scale(2) rotate(90)", [[0, -2, 5], [2, 0, 5]]),
    ],
)
@pytest.mark.parametrize("place", ["element", "group"])
def test_transforms_move_the_corners(transform: str, matrix: list[list[float]], place: str, tmp_path: Path) -> None:
    shape = '<path d="M0 0 30 0 0 20z"{}/>'
    body = (
        shape.format(f' transform="{transform}"')
        if place == "element"
        else f'<g transform="{transform}"><g>{shape.format("")}</g></g>'
    )
    found, _ = _read(tmp_path, body)
    m = np.array(matrix, dtype=float)
    expected = np.array([[0, 0], [30, 0], [0, 20]]) @ m[:, :2].T + m[:, 2]
    expected = np.stack([expected[:, 0], 100 - expected[:, 1]], axis=1)
    np.testing.assert_allclose(np.sort(found.corners, axis=0), np.sort(expected, axis=0), atol=1e-12)


@pytest.mark.parametrize(
    ("page", "units", "side"),
    [
        ('width="100mm" viewBox="0 0 200 200"', "mm", 5.0),
        ('width="100cm" height="100cm" viewBox="0 0 200 200"', "cm", 5.0),
        ('width="4in" height="4in" viewBox="0 0 40 40"', "in", 1.0),
        ('width="96" height="96"', "mm", 10 * 25.4 / 96),
        ('width="96px" height="96px" viewBox="0 0 96 96"', "mm", 10 * 25.4 / 96),
        ('width="72pt" height="72pt" viewBox="0 0 10 10"', "mm", 25.4),
        ('width="100%" height="100%" viewBox="0 0 96 96"', "mm", 10 * 25.4 / 96),
        ("", "mm", 10 * 25.4 / 96),
        ('width="100mm" height="50mm" viewBox="0 0 100 100"', "mm", 5.0),
        ('width="100mm" height="50mm" viewBox="0 0 100 100" preserveAspectRatio="xMidYMid slice"', "mm", 10.0),
    ],
)
def test_units_are_those_of_the_page(page: str, units: str, side: float, tmp_path: Path) -> None:
    body = '<rect width="10" height="10"/>'
    found, notes = _read(tmp_path, body, page)
    assert found.units == units
    np.testing.assert_allclose(found.area, side**2, rtol=1e-13)
    assert any("96 px" in note for note in notes) == ("mm" not in page and "cm" not in page and "in" not in page[:12])
    inches, said = _read(tmp_path, body, page, "in")
    assert inches.units == "in"
    factor = {"mm": 1.0, "cm": 10.0, "in": 25.4}[units] / 25.4
    np.testing.assert_allclose(inches.area, (side * factor) ** 2, rtol=1e-13)
    assert any("converted" in note for note in said) == (units != "in")


def test_a_page_may_be_stretched_and_nested(tmp_path: Path) -> None:
    page = 'width="100mm" height="50mm" viewBox="0 0 100 100" preserveAspectRatio="none"'
    found, _ = _read(tmp_path, '<circle cx="50" cy="50" r="10"/>', page)
    np.testing.assert_allclose(found.area, math.pi * 10 * 5, rtol=1e-13)
    nested = '<svg x="10" y="20" width="50" height="50" viewBox="0 0 10 10"><rect width="2" height="2"/></svg>'
    found, _ = _read(tmp_path, nested)
    np.testing.assert_allclose(found.box, [[10, 70], [20, 80]], atol=1e-12)


def test_the_largest_curve_is_taken_and_holes_are_told_of(tmp_path: Path) -> None:
    found, notes = _read(
        tmp_path, '<path d="M0 0H90V90H0Z M10 10H20V20H10Z"/><circle cx="150" cy="50" r="5"/><path d="M0 0 9 9"/>'
    )
    assert found.area == pytest.approx(8100)
    assert (
        "The largest of 3 closed curves is the outline. 1 inside it was left out: an outline has no holes" in notes[0]
    )
    assert "1 open curve was left out." in notes


def test_what_is_drawn_elsewhere_or_hidden_is_no_outline(tmp_path: Path) -> None:
    big = '<rect width="90" height="90"/>'
    body = (
        f'<defs>{big}</defs><clipPath id="c">{big}</clipPath><g style="display: none">{big}</g>'
        f'<g display="none"><g>{big}</g></g><symbol>{big}</symbol><text>{big}</text><use href="#c"/><use href="#c"/>'
        '<rect width="10" height="10"/>'
    )
    found, notes = _read(tmp_path, body)
    assert found.area == pytest.approx(100)
    assert notes == ("Left out: 1 text, 2 use (draw the outline itself as a path).",)


def test_pieces_are_joined_in_any_order_and_direction(tmp_path: Path) -> None:
    body = '<path d="M0 0H30"/><path d="M30 20L30 0"/><path d="M0 20V0"/><path d="M30 20H0"/><path d="M30 0H0"/>'
    found, notes = _read(tmp_path, body)
    assert found.area == pytest.approx(600) and found.n_corners == 4
    assert notes == ("1 copies of lines or curves were left out.",)


def test_small_gaps_are_closed_and_told_of(tmp_path: Path) -> None:
    found, notes = _read(tmp_path, '<path d="M0 0H30V20H0V0.4"/>')
    assert found.area == pytest.approx(600) and found.n_corners == 4
    assert "closed by a straight segment of length 0.4 from (0, 99.6) to (0, 100)" in notes[0]
    found, notes = _read(tmp_path, '<path d="M0 0H30V20H0V0.0005"/>')
    assert "Gaps of up to 0.0005" in notes[0] and found.n_corners == 4
    with pytest.raises(UnusableError, match=r"1 open ones; the longest goes from \(0, 100\) to \(0, 90\)"):
        _read(tmp_path, '<path d="M0 0H30V20H0V10"/>')


def test_a_cusp_free_curve_of_short_lines_becomes_smooth(tmp_path: Path) -> None:
    t = np.linspace(0, 2 * np.pi, 101)[:-1]
    points = " ".join(f"{50 + 20 * np.cos(a):.6f},{50 + 20 * np.sin(a):.6f}" for a in t)
    found, notes = _read(tmp_path, f'<polygon points="{points}"/>')
    assert found.is_smooth and "smooth spline" in notes[-1]
    np.testing.assert_allclose(found.area, 400 * np.pi, rtol=1e-6)


BODIES_UNREADABLE = {
    '<path d="M0 0 L nan 3 L 4 4z"/>': "SVG path data, got 'nan",
    '<path d="L0 0 3 3z"/>': "moveto",
    '<path d="M0 0 L 3"/>': "Not enough coordinates",
    '<path d="M0 0 A 3 3 0 2 1 5 5"/>': "path data",
    '<path d="M0 0 A 3 3 0"/>': "path data",
    '<path d="M0 0 &#0; 3"/>': "damaged XML",
    '<path d="M0 0 10,0;5,5z"/>': "';5,5z'",
    '<g transform="spin(3)"><rect width="1" height="1"/></g>': "got spin with 1 numbers",
    '<g transform="rotate(3"><rect width="1" height="1"/></g>': "expected transforms",
    '<g transform="scale(1,2,3)"><rect width="1" height="1"/></g>': "scale with 3 numbers",
    '<rect width="3em" height="1"/>': "expected a length in px",
    '<rect width="wide" height="1"/>': "expected a length for width of rect, got 'wide'",
    '<polygon points="1,2 a,b"/>': "expected a number for points, got 'a'",
    '<svg viewBox="0 0 1"><rect width="1" height="1"/></svg>': "viewBox",
    "<g>" * 300 + "</g>" * 300: "at most 256 nested elements",
    "<g>": "damaged XML",
    "&bomb;": "damaged XML",
}

BODIES_UNUSABLE = {
    "": "drawing without curves",
    "<text>O</text>": "Left out: 1 text",
    '<path d=""/><rect width="0" height="3"/><circle r="-1"/><line x1="1" x2="1"/>': "without curves",
    '<path d="M0 0 L1e400 0 L0 3z"/>': "finite numbers for coordinates, got inf",
    '<path d="M0 0 L1e99 0 L0 3z"/>': "smaller numbers for coordinates",
    '<g transform="scale(1e50)"><rect transform="scale(1e50)" width="1" height="1"/></g>': "transforms",
    '<path d="M0 0 L10 10 L10 0 L0 10z"/>': r"cross itself, got one that does at \(5, 95\)",
    '<path d="M0 0 L10 10z"/>': "expected a curve",
    '<path d="M0 0 L10 0 L5 0z"/>': "expected a curve",
    '<path d="M0 0 L10 10 L10 0"/>': "1 open ones",
    '<path d="M5 5z M6 6"/>': "without curves",
    '<path d="M' + "0 0 1 1 " * 2_000_000 + '"/>': "at most 100000 points",
    '<polygon points="' + "0 0 1 1 " * 100_000 + '"/>': "at most 100000 points",
}


@pytest.mark.parametrize("body", BODIES_UNREADABLE, ids=lambda body: body[:30])
def test_damaged_drawings_are_unreadable(body: str, tmp_path: Path) -> None:
    with pytest.raises(UnreadableError, match=BODIES_UNREADABLE[body]):
        _read(tmp_path, body)


@pytest.mark.parametrize("body", BODIES_UNUSABLE, ids=lambda body: body[:30])
def test_drawings_without_an_outline_are_unusable(body: str, tmp_path: Path) -> None:
    with pytest.raises(UnusableError, match=BODIES_UNUSABLE[body]):
        _read(tmp_path, body)


@pytest.mark.parametrize("body", ['<path d="M0 0 {}"/>', '<path d="M0 0 {}z"/>', "{}"])
def test_drawings_of_too_many_pieces_are_unusable(body: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("kirisurf.outlines.drawing.MOST_PIECES", 100)
    many = body.format('<circle r="1"/>' * 26 if body == "{}" else "1 1 0 0 " * 51)
    with pytest.raises(UnusableError, match=r"at most 100 points, lines and curves, got 10[1-4] or more"):
        _read(tmp_path, many)


BOMB = "".join(f'<!ENTITY a{k} "{f"&a{k - 1};" * 10 if k else "ha"}">' for k in range(9))


@pytest.mark.parametrize(
    "content",
    [
        f"<!DOCTYPE svg [{BOMB}]><svg>&a8;</svg>",
        '<!DOCTYPE svg [<!ENTITY x SYSTEM "file:///etc/hostname">]><svg><text>&x;</text></svg>',
        '<!DOCTYPE svg [<!ENTITY % x SYSTEM "file:///etc/hostname"> %x;]><svg/>',
    ],
)
def test_entities_are_refused(content: str, tmp_path: Path) -> None:
    path = tmp_path / "bomb.svg"
    path.write_text(content)
    with pytest.raises(UnreadableError, match="expected SVG without entities"):
        read_outline(path)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"<html/>", "with the element 'html'"),
        (b"\x89PNG\r\n\x1a\n\x00\x00", "damaged XML"),
        (b"\x1f\x8b\x08\x00", "gzip"),
        (b'<?xml version="1.0" encoding="no-such"?><svg/>', "SVG"),
        (b"<svg>\xff\xfe\xfa</svg>", "damaged XML"),
        (b"<svg", "damaged XML"),
        (b"\0" * 100, "damaged XML"),
        (b"<g>" * 1_000_000, "expected SVG, got XML with the element 'g'"),
    ],
)
def test_other_content_is_unreadable(content: bytes, message: str, tmp_path: Path) -> None:
    path = tmp_path / "drawing.svg"
    path.write_bytes(content)
    with pytest.raises(UnreadableError, match=message):
        read_outline(path)


def test_a_doctype_without_entities_and_other_encodings_are_read(tmp_path: Path) -> None:
    path = tmp_path / "drawing.svg"
    public = '<!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN" "http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd">'
    body = f'{public}<s:svg xmlns:s="http://www.w3.org/2000/svg" {PAGE}><s:rect width="3" height="4" id="ä"/></s:svg>'
    for encoding in ("utf-8", "utf-16", "latin-1"):
        path.write_bytes(f'<?xml version="1.0" encoding="{encoding}"?>{body}'.encode(encoding))
        assert read_outline(path)[0].area == pytest.approx(12)


def test_truncated_drawings_never_end_in_another_error(tmp_path: Path) -> None:
    path = tmp_path / "drawing.svg"
    whole = (
        f'<svg xmlns="http://www.w3.org/2000/svg" {PAGE}><g transform="rotate(30)">'
        '<path d="M0 50C0 10 40 10 40 50S0 90 0 50A 3 4 5 0 1 2 2z"/><rect width="3mm" height="2" rx="1"/></g></svg>'
    ).encode()
    rng = np.random.default_rng(0)
    for k in range(0, len(whole), 3):
        path.write_bytes(whole[:k])
        with pytest.raises(KirisurfError):
            read_outline(path)
    for _ in range(300):
        damaged = bytearray(whole)
        for place in rng.integers(0, len(whole), 3):
            damaged[place] = int(rng.integers(32, 127))
        path.write_bytes(bytes(damaged))
        try:
            found, _notes = read_outline(path)
        except KirisurfError:
            continue
        assert found.area > 0
