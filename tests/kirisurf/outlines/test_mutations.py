"""Damaged drawings: a reader returns a closed outline that can be filled, or says in one line what is wrong.

KIRISURF_MUTATIONS=100 tries a hundred times as many.
"""

from __future__ import annotations

import logging
import math
from pathlib import Path

import numpy as np
import pytest

from kirisurf.errors import KirisurfError, UnreadableError, UnusableError
from kirisurf.outlines import closing, planar_surface, read_outline
from tests.kirisurf.mutations import check_message, mutated, rounds, truncated


def _entities(*entities: str) -> bytes:
    """Return a DXF of entities, their groups written as CODE VALUE CODE VALUE."""
    pairs = " ".join(
        ["0 SECTION 2 HEADER 9 $ACADVER 1 AC1015 0 ENDSEC 0 SECTION 2 ENTITIES", *entities, "0 ENDSEC 0 EOF"]
    ).split()
    return ("\n".join(pairs) + "\n").encode()


RING = (
    "0 LWPOLYLINE 100 AcDbEntity 8 0 100 AcDbPolyline 90 4 70 1 "
    "10 0.0 20 0.0 42 0.5 10 10.0 20 0.0 10 10.0 20 8.0 10 0.0 20 8.0"
)
SPLINE = (
    "0 SPLINE 100 AcDbEntity 8 0 100 AcDbSpline 70 8 71 3 72 8 73 4 40 0 40 0 40 0 40 0 40 1 40 1 40 1 40 1 "
    "10 0 20 0 10 1 20 2 10 3 20 1 10 5 20 0"
)
SEEDS: dict[str, tuple[bytes, ...]] = {
    "svg": (
        b'<svg xmlns="http://www.w3.org/2000/svg" width="100mm" viewBox="0 0 100 80"><g transform="translate(5 5) '
        b'rotate(10 3 4) scale(1.1)"><path d="M 10 10 L 60 10 C 70 10 80 20 80 30 S 70 50 60 60 Q 50 70 40 60 T 20 40 '
        b'A 10 12 30 0 1 10 20 Z"/></g><rect x="2" y="3" width="10" height="5" rx="1" style="display:none"/></svg>',
        b'<svg width="2in"><polygon points="1,1 5,1 6,4 2,8 0,4"/><ellipse cx="5" cy="6" rx="2" ry="3" '
        b'transform="matrix(1 0 0.2 1 4 5)"/><svg x="3" width="10" viewBox="0 0 5 5"><rect width="2" height="1"/></svg>'
        b"</svg>",
    ),
    "dxf": (
        _entities(RING, "0 ARC 8 0 10 1.0 20 2.0 40 3.0 50 10.0 51 90.0", "0 CIRCLE 8 0 10 3.0 20 3.0 40 2.0"),
        _entities(
            "0 ELLIPSE 100 AcDbEntity 8 0 100 AcDbEllipse 10 1.0 20 1.0 11 2.0 21 0.5 40 0.5 41 0.0 42 6.283185307",
            SPLINE,
        ),
    ),
    "csv": (
        "\n".join(f"{math.cos(t):.6f},{math.sin(t):.6f}" for t in np.arange(24) * math.pi / 12).encode(),
        b"x;y;corner\n0,0;0,0;1\n5,5;0,0;1\n5,5;3,2;1\n2,0;4,0;0\n0,0;3,0;1\n",
    ),
}


def _holds(path: Path, content: bytes, is_filled: bool = False) -> bool:
    """Check the law on one file; return whether it was read."""
    path.write_bytes(content)
    try:
        outline, notes = read_outline(path)
        if is_filled:
            assert planar_surface(outline).area > 0
    except KirisurfError as problem:
        check_message(problem, path.name)
        return False
    assert all(note.isprintable() for note in notes)
    assert outline.area > 0
    points = outline.polyline(outline.diagonal / 50)
    assert np.isfinite(points).all()
    for side, following in zip(outline.sides, outline.sides[1:] + outline.sides[:1], strict=True):
        assert np.linalg.norm(side.end - following.start) <= 1e-9 * outline.diagonal
    return True


@pytest.mark.parametrize("kind", SEEDS)
def test_damage_is_read_or_refused(kind: str, tmp_path: Path) -> None:
    path = tmp_path / f"damaged.{kind}"
    # the spline and the arc are open curves beside closed ones
    assert all(_holds(path, content, is_filled=True) for content in SEEDS[kind])
    ends = [_holds(path, mutated(content, seed), seed % 10 == 0) for seed in rounds(50) for content in SEEDS[kind]]
    assert 0 < sum(ends) < len(ends)


@pytest.mark.parametrize("kind", SEEDS)
def test_every_beginning_is_read_or_refused(kind: str, tmp_path: Path) -> None:
    beginnings = list(truncated(min(SEEDS[kind], key=len)))
    for beginning in beginnings if kind == "csv" else beginnings[::5]:
        read = _holds(tmp_path / f"cut.{kind}", beginning)
        assert not read or kind != "svg"


@pytest.mark.parametrize("token", ["1_0", "１0", "0x10", "1d1", "ten"])
@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.svg", '<svg><circle r="{}"/></svg>'),
        ("b.svg", '<svg><polygon points="0,0 {},0 0,{}"/></svg>'),
        ("c.svg", '<svg><path d="M0 0 L {} 0 L 0 9 Z"/></svg>'),
        ("d.svg", '<svg><rect width="5" height="5" transform="scale({})"/></svg>'),
        ("e.svg", '<svg viewBox="0 0 {} 10"><rect width="5" height="5"/></svg>'),
        ("a.csv", "x,y\n0,0\n{},0\n10,10\n0,10\n"),
        ("b.csv", "{},0\n0,0\n10,10\n0,10\n"),
        ("a.dxf", _entities("0 CIRCLE 8 0 10 0 20 0 40 {}").decode()),
        ("b.dxf", _entities("0 CIRCLE 8 0 10 {} 20 0 40 5").decode()),
    ],
)
def test_what_only_python_or_a_guess_calls_a_number(name: str, content: str, token: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(content.replace("{}", token), encoding="utf-8")
    with pytest.raises(UnreadableError, match=f"{name}: expected"):
        read_outline(tmp_path / name)


def test_names_may_look_like_such_numbers(tmp_path: Path) -> None:
    (tmp_path / "a.dxf").write_bytes(_entities("0 CIRCLE 8 1_0 10 0 20 0 40 5"))
    outline, _ = read_outline(tmp_path / "a.dxf")
    assert math.isclose(outline.area, 25 * math.pi, rel_tol=1e-9)


def test_a_whole_number_with_a_point_is_one(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    (tmp_path / "a.dxf").write_bytes(_entities("0 CIRCLE 8 0 62 7.0 10 0 20 0 40 5"))
    outline, notes = read_outline(tmp_path / "a.dxf")
    assert math.isclose(outline.area, 25 * math.pi, rel_tol=1e-9)
    assert not any("fault" in note for note in notes)
    # what ezdxf says goes to whoever listens, never to standard error by default
    assert any(isinstance(handler, logging.NullHandler) for handler in logging.getLogger("ezdxf").handlers)


@pytest.mark.parametrize(
    "content",
    [
        b'<svg><path d="M0 0 L1 0 L1e59 1e-300 L 0 1Z"/><circle r="1e-200"/></svg>',
        b'<svg width="2in"><polygon points="1e-320,1e-320 5,1e-320 6,4 2,8 0,4"/><line x2="3" y2="1e-320"/></svg>',
        b'<svg><path d="M 10 10 L 60 10 A 10 1e-320 30 0 1 10 20 Z"/></svg>',
        b'<svg><path d="M 0 0 L 60 10 L 4294967296 30 L 0 1Z"/></svg>',
    ],
)
def test_parts_of_very_different_size_end_in_a_sentence(content: bytes, tmp_path: Path) -> None:
    _holds(tmp_path / "a.svg", content, is_filled=True)


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("deep.svg", "<svg>" + "<g>" * 100_000, "nested"),
        ("bomb.svg", '<!DOCTYPE x [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]><svg>&b;</svg>', "entities"),
        ("path.svg", '<svg><path d="M0 0 ' + "L1 1 L2 0 " * 200_000 + 'Z"/></svg>', "at most 100000 points"),
        ("moves.svg", '<svg><g transform="' + "rotate(1)" * 100_001 + '"><circle r="5"/></g></svg>', "transforms"),
        ("exponent.svg", '<svg><path d="M0 0 L1e999999999 0 L1 1Z"/></svg>', "finite"),
        (
            "self.dxf",
            "0\nSECTION\n2\nBLOCKS\n0\nBLOCK\n2\nA\n0\nINSERT\n2\nA\n0\nENDBLK\n0\nENDSEC\n0\nEOF\n",
            "curves",
        ),
        ("wide.csv", "1,2," * 500_000, "extent"),
    ],
)
def test_bombs_are_refused_at_once(name: str, content: str, said: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(content)
    with pytest.raises(KirisurfError, match=said) as caught:
        read_outline(tmp_path / name)
    check_message(caught.value, name)


def test_very_many_ends_in_one_place_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(closing, "_MOST_PAIRS", 30_000)
    star = "".join(f'<line x2="{k % 20 + 1}" y2="{k // 20 + 1}"/>' for k in range(200))
    (tmp_path / "a.svg").write_text(f"<svg>{star}</svg>")
    with pytest.raises(UnusableError, match=r"a.svg: expected a drawing of which few ends meet"):
        read_outline(tmp_path / "a.svg")


def test_a_use_of_itself_is_left_out_and_told_of(tmp_path: Path) -> None:
    text = '<svg xmlns:xlink="x"><g id="a"><use xlink:href="#a"/><circle r="5"/></g></svg>'
    (tmp_path / "a.svg").write_text(text)
    _, notes = read_outline(tmp_path / "a.svg")
    assert any("1 use" in note for note in notes)


def test_a_damaged_first_point_is_no_header(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("O,0\n1,0\n1,1\n0,1\n")
    with pytest.raises(UnreadableError, match="line 1, got 'O 0'"):
        read_outline(tmp_path / "a.csv")


def test_many_curves_take_little_memory(tmp_path: Path) -> None:
    """A sheet full of holes: what is kept of every curve is small, and the largest is the outline."""
    holes = "".join(f'<circle r="0.4" cx="{k % 40}" cy="{k // 40}"/>' for k in range(200))
    (tmp_path / "a.svg").write_text(f'<svg><rect x="-1" y="-1" width="41" height="6"/>{holes}</svg>')
    outline, notes = read_outline(tmp_path / "a.svg")
    assert outline.n_corners == 4
    assert any("200 inside it were left out" in note for note in notes)


def test_names_that_cannot_be_printed_stand_escaped(tmp_path: Path) -> None:
    (tmp_path / "a\nb\x1b.csv").write_text("0,0\n1,0\n1,1\n")
    assert read_outline(tmp_path / "a\nb\x1b.csv")[0].name == r"a\nb\x1b.csv"
    (tmp_path / "a\nb.csv").write_text("0,0\n")
    with pytest.raises(UnusableError) as caught:
        read_outline(tmp_path / "a\nb.csv")
    assert str(caught.value).isprintable()


@pytest.mark.parametrize(("scale", "shift"), [(1e-9, 0.0), (1e-3, 0.0), (1e9, 0.0), (1.0, 1e6)])
@pytest.mark.parametrize("shape", ["circle", "corners"])
def test_size_and_place_change_no_outline(shape: str, scale: float, shift: float, tmp_path: Path) -> None:
    """Tolerances are relative: an outline is the same at any scale and anywhere, to rounding."""
    t = np.arange(40) * math.pi / 20
    circle = np.column_stack([np.cos(t), np.sin(t)])
    points = circle if shape == "circle" else np.array([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]], float)
    found = []
    for factor, moved in ((1.0, 0.0), (scale, shift)):
        rows = factor * points + moved * 2.8
        (tmp_path / "a.csv").write_text("\n".join(f"{x!r},{y!r}" for x, y in rows.tolist()))
        outline, notes = read_outline(tmp_path / "a.csv")
        found.append((outline.n_corners, len(notes), outline.area / factor**2))
    assert found[0][:2] == found[1][:2]
    assert found[1][2] == pytest.approx(found[0][2], rel=1e-7)
