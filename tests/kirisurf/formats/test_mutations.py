"""Damaged meshes: a reader returns a surface that passes the gate, or says in one line what is wrong. Nothing else.

KIRISURF_MUTATIONS=100 tries a hundred times as many.
"""

from __future__ import annotations

import copy
import json
import os
import random
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from kirisurf.errors import KirisurfError, UnreadableError, UnusableError
from kirisurf.formats import read_surface, read_surface_with_notes
from kirisurf.gate import check_native
from tests.kirisurf.formats.seeds import binary_off, document, glb, ply, seeds
from tests.kirisurf.mutations import check_message, mutated, rounds, truncated

OURS = ("obj", "ply", "off", "stl", "gltf", "glb")
"""Formats that our own parsers read; the others go through vtk in a process of their own."""


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[bytes, ...]]:
    return seeds(tmp_path_factory.mktemp("seeds"))


def _holds(path: Path, content: bytes) -> bool:
    """Check the law on one file; return whether it was read."""
    path.write_bytes(content)
    try:
        surface, notes = read_surface_with_notes(path)
    except KirisurfError as problem:
        check_message(problem, path.name)
        return False
    check_native(surface.vertices, surface.faces)
    assert all(note.isprintable() for note in notes)
    return True


@pytest.mark.parametrize("kind", OURS)
def test_damage_is_read_or_refused(kind: str, sound: dict[str, tuple[bytes, ...]], tmp_path: Path) -> None:
    path = tmp_path / f"damaged.{kind}"
    assert all(_holds(path, content) for content in sound[kind])
    ends = [_holds(path, mutated(content, seed)) for seed in rounds(60) for content in sound[kind]]
    assert 0 < sum(ends) < len(ends)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["vtp", "vtk"])
def test_damage_that_vtk_reads(kind: str, sound: dict[str, tuple[bytes, ...]], tmp_path: Path) -> None:
    path = tmp_path / f"damaged.{kind}"
    assert all(_holds(path, content) for content in sound[kind])
    for seed in rounds(6):
        _holds(path, mutated(random.Random(seed).choice(sound[kind]), seed))


@pytest.mark.parametrize("kind", OURS)
def test_every_beginning_is_read_or_refused(kind: str, sound: dict[str, tuple[bytes, ...]], tmp_path: Path) -> None:
    beginnings = list(truncated(min(sound[kind], key=len)))
    for beginning in [*beginnings[:200], *beginnings[200::5]]:
        _holds(tmp_path / f"cut.{kind}", beginning)


@pytest.mark.parametrize("content", [ply(), ply(">", "double"), binary_off(), glb(document())])
def test_no_beginning_of_a_binary_file_is_read(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / f"cut.{'ply' if content[:1] == b'p' else 'off' if content[:1] == b'C' else 'glb'}"
    assert _holds(path, content)
    assert not any(_holds(path, beginning) for beginning in truncated(content))


HOSTILE: tuple[Any, ...] = (
    None, True, -1, 0, 3, 10**30, 10**400, 1.5, 1e308, float("nan"), float("inf"), "", "1", [], {}, [[]], ["1"] * 3,
    [True] * 3, [1e60] * 3, [1e59] * 16, "\ud800", "a\nb\x1b[31m", 2**31 - 1, 2**63, [None], "data:;base64,AAAA",
)  # fmt: skip


def _places(value: Any, above: tuple = ()) -> Iterator[tuple]:
    for key in value if isinstance(value, dict) else range(len(value)) if isinstance(value, list) else ():
        yield (*above, key)
        yield from _places(value[key], (*above, key))


def test_a_gltf_document_with_hostile_values(tmp_path: Path) -> None:
    sound = document()
    for seed in rounds(150):
        chance, damaged = random.Random(seed), copy.deepcopy(sound)
        *way, last = chance.choice(list(_places(damaged)))
        here = damaged
        for key in way:
            here = here[key]
        here[last] = chance.choice(HOSTILE)
        _holds(tmp_path / "damaged.gltf", json.dumps(damaged).encode())


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("translation", ["1", "2", "3"]),
        ("translation", [True, False, True]),
        ("scale", [10**400, 1, 1]),
        ("rotation", [1e200, 0, 0, 1]),
        ("matrix", [[1], [2]]),
    ],
)
def test_a_transformation_of_no_numbers(key: str, value: Any, tmp_path: Path) -> None:
    described = document()
    described["nodes"][1][key] = value
    (tmp_path / "a.gltf").write_text(json.dumps(described))
    with pytest.raises(UnreadableError, match=f"a.gltf: expected .* for {key}"):
        read_surface(tmp_path / "a.gltf")


def test_an_accessor_of_a_type_that_cannot_be_looked_up(tmp_path: Path) -> None:
    described = document()
    described["accessors"][0]["componentType"] = []
    (tmp_path / "a.gltf").write_text(json.dumps(described))
    with pytest.raises(UnreadableError, match="accessor"):
        read_surface(tmp_path / "a.gltf")


SIGNALING = np.array([0x7F800001], "<u4").tobytes()
"""A NaN of which the processor makes an exception, and NumPy a warning, where it is converted."""


@pytest.mark.parametrize("kind", ["stl", "ply", "off", "glb"])
def test_a_signaling_nan_is_not_finite(kind: str, sound: dict[str, tuple[bytes, ...]], tmp_path: Path) -> None:
    content = {"stl": sound["stl"][0], "ply": ply(), "off": binary_off(), "glb": glb(document())}[kind]
    one = np.array([1.0], ">f4" if kind == "off" else "<f4").tobytes()
    # of OFF the second vertex: the first has ones in its color alone
    at = content.index(one, 52 if kind == "off" else 0)
    (tmp_path / f"a.{kind}").write_bytes(content[:at] + SIGNALING[:: -1 if kind == "off" else 1] + content[at + 4 :])
    with pytest.raises(UnusableError, match="finite"):
        read_surface(tmp_path / f"a.{kind}")


@pytest.mark.parametrize("token", ["1_0", "0x1", "１", "1d0", "1e", "--1"])
@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 {} 0\nf 1 2 3\n"),
        ("b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 {}\n"),
        ("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 {} 0\n3 0 1 2\n"),
        ("b.off", "OFF\n3 {} 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"),
        ("c.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 {} 2\n"),
        ("a.stl", "solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 {} 0\nendloop\nendfacet\nendsolid\n"),
        (
            "a.ply",
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
            "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 {} 0\n3 0 1 2\n",
        ),
        (
            "b.ply",
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
            "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n{} 0 1 2\n",
        ),
    ],
)
def test_what_only_python_calls_a_number(name: str, content: str, token: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(content.replace("{}", token), encoding="utf-8")
    with pytest.raises(UnreadableError, match=f"{name}: expected"):
        read_surface(tmp_path / name)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("property float y", "property float x", "two called 'x'"),
        ("element face 2", "element vertex 4\nproperty float x\nelement face 2", "two called 'vertex'"),
    ],
)
def test_two_things_of_one_name(old: str, new: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "a.ply").write_bytes(ply().replace(old.encode(), new.encode()))
    with pytest.raises(UnreadableError, match=said):
        read_surface(tmp_path / "a.ply")


CONCAVE = "".join(f"v {k} {k % 2 * 3} 0\n" for k in range(2999))
ROUND = " ".join(str(k + 1) for k in range(2999))


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("deep.gltf", "[" * 100_000, "recursion"),
        ("deep.gltf", '{"asset":' + '{"a":' * 50_000, "recursion"),
        ("many.obj", CONCAVE + f"f {ROUND}\n" * 50, "export the surface as triangles"),
        ("long.obj", CONCAVE + f"f {ROUND} {ROUND} {ROUND}\n", "export the surface as triangles"),
        ("none.ply", "ply\nformat ascii 1.0\nelement vertex 0\n" + "property float x\n" * 200_000, "end_header"),
        ("lying.off", "OFF\n1000000000 1000000000 0\n", "as announced"),
        ("lying.ply", ply().replace(b"face 2", b"face 999999999999999999").decode("latin-1"), "as announced"),
        (
            "lying.vtk",
            "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 99999999999999999999 float\n",
            "cut",
        ),
        ("open.stl", "solid " + "x" * 1_000_000, "cut off"),
    ],
)
def test_bombs_are_refused_at_once(name: str, content: str, said: str, tmp_path: Path) -> None:
    (tmp_path / name).write_bytes(content.encode("latin-1"))
    with pytest.raises(KirisurfError, match=said) as caught:
        read_surface(tmp_path / name)
    check_message(caught.value, name)


@pytest.mark.slow
def test_no_file_is_opened_but_the_named_one(sound: dict[str, tuple[bytes, ...]], tmp_path: Path) -> None:
    """In a child, since a hook stays for the life of a process; what vtk reads is a copy in a folder for this alone."""
    other = tmp_path / "other.bin"
    other.write_bytes(b"x" * 10_000)
    described = document()
    described["buffers"][0]["uri"] = str(other)
    drawing = f'<svg xmlns:xlink="x"><image xlink:href="{other}"/><use href="{other}#a"/><circle r="9"/></svg>'
    named = {
        "a.obj": b"mtllib %b\nusemtl %b\n" % (os.fsencode(other), os.fsencode(other)) + sound["obj"][0],
        "a.gltf": json.dumps(described).encode(),
        "b.gltf": sound["gltf"][0],
        "a.ply": ply().replace(b"element vertex", b"comment TextureFile %b\nelement vertex" % os.fsencode(other)),
        "a.off": sound["off"][0],
        "a.stl": sound["stl"][0],
        "a.glb": sound["glb"][0],
        "a.vtp": sound["vtp"][0].replace(b"<PolyData>", b'<!-- file="%b" --><PolyData>' % os.fsencode(other)),
        "a.vtk": sound["vtk"][0],
        "a.svg": f'<!DOCTYPE svg SYSTEM "{other}">{drawing}'.encode(),
        "a.csv": b"0,0\n1,0\n1,1\n0,1\n",
        "a.dxf": b"0\nSECTION\n2\nENTITIES\n0\nCIRCLE\n8\n0\n1\n%b\n10\n0\n20\n0\n40\n9\n0\nENDSEC\n0\nEOF\n"
        % os.fsencode(other),
    }
    for name, content in named.items():
        (tmp_path / name).write_bytes(content)
    code = (
        "import sys, os; from kirisurf.errors import KirisurfError; from kirisurf.targets import load_with_notes\n"
        "opened = []\n"
        "sys.addaudithook(lambda event, given: opened.append(os.fsdecode(given[0])) "
        "if event == 'open' and isinstance(given[0], (str, bytes)) and os.fsdecode(given[0]).startswith(sys.argv[1]) "
        "else print(event, given, file=sys.stderr) if event in ('socket.connect', 'urllib.Request') else None)\n"
        "for name in sys.argv[2:]:\n"
        "    opened.clear()\n"
        "    try: load_with_notes(os.path.join(sys.argv[1], name)); ended = 'read'\n"
        "    except KirisurfError: ended = 'refused'\n"
        "    print(name, ended, *sorted({os.path.basename(path) for path in opened}))\n"
    )
    environment = {**os.environ, "TMPDIR": str(tmp_path.parent)}
    child = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path), *named], capture_output=True, text=True, env=environment, check=True
    )
    assert child.stderr == ""
    ends = {name: "refused" if name == "a.gltf" else "read" for name in named}
    assert child.stdout.splitlines() == [f"{name} {ends[name]} {name}" for name in named]
