"""What a batch is asked to do: TOML, folders, tables; names; mistakes."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kirisurf.batch.items import LONGEST_NAME, safe_name
from kirisurf.batch.reading import BatchSpec, read_batch
from kirisurf.batch.writing import batch_text
from kirisurf.errors import ParameterError, UnreadableError
from kirisurf.spec import FitSpec


def read(folder: Path, text: str, name: str = "batch.toml", **given: object) -> BatchSpec:
    (folder / name).write_text(text, encoding="utf-8")
    return read_batch(folder / name, given)


def test_targets_times_matrix(tmp_path: Path) -> None:
    spec = read(
        tmp_path,
        'targets = ["hypar", "sphere"]\n[options]\ntolerance = 1e-8\n'
        '[matrix]\ntessellation = ["quad", "kagome"]\ncells = ["2x2", "3x3", "4x4"]\n',
    )
    assert len(spec.items) == 12
    assert spec.varied == ("tessellation", "cells")
    assert spec.items[0].name == "hypar--quad--cells-2x2"
    assert {(each.target, each.spec.tessellation, each.spec.cells) for each in spec.items} == {
        (target, pattern, (n, n)) for target in ("hypar", "sphere") for pattern in ("quad", "kagome") for n in (2, 3, 4)
    }
    assert {each.spec.tolerance for each in spec.items} == {1e-8}


def test_a_target_has_options_of_its_own_and_the_matrix_is_stronger(tmp_path: Path) -> None:
    spec = read(
        tmp_path,
        'expect = 0\ntargets = [{ target = "hypar", tiles = 50, expect = [5, 6] }, "sphere"]\n'
        '[options]\ncells = "3x3"\n[matrix]\nprefer = ["open", "uniform"]\n',
    )
    first, *_, last = spec.items
    assert (first.spec.tiles, first.spec.cells, first.expect) == (50, None, (5, 6))
    assert (last.spec.tiles, last.spec.cells, last.expect) == (None, (3, 3), (0,))


def test_options_given_beside_the_file_win(tmp_path: Path) -> None:
    text = 'targets = ["hypar"]\n[options]\ncells = "3x3"\n'
    assert read(tmp_path, text, tiles=40).items[0].spec.tiles == 40
    with pytest.raises(ParameterError, match="--cells: expected options that the batch does not vary"):
        read(tmp_path, 'targets = ["hypar"]\n[matrix]\ncells = ["3x3"]\n', cells=(2, 2))


def test_patterns_of_files_are_found_beside_the_file(tmp_path: Path) -> None:
    (tmp_path / "m").mkdir()
    for name in ("b.stl", "a.stl", "c.obj", "a[1].stl"):
        (tmp_path / "m" / name).write_text("x")
    spec = read(tmp_path, 'targets = ["m/*.stl"]')
    assert [Path(each.spec.target) for each in spec.items[:3]] == [
        tmp_path / "m" / n for n in ("a.stl", "a[1].stl", "b.stl")
    ]


def test_a_folder_is_a_batch_of_all_its_targets(tmp_path: Path) -> None:
    (tmp_path / "inner" / ".hidden").mkdir(parents=True)
    for name in ("b.stl", "inner/a.OBJ", "inner/.hidden/c.stl", "readme.txt", ".d.stl", "e.svg"):
        (tmp_path / name).write_text("x")
    spec = read_batch(tmp_path, {"tiles": 30})
    assert [each.name for each in spec.items] == ["b.stl", "e.svg", "inner-a.OBJ"]
    assert {each.spec.tiles for each in spec.items} == {30}
    assert spec.notes == ("1 file left out, no mesh or outline by name: readme.txt.",)


@pytest.mark.parametrize(("name", "tab"), [("t.csv", ","), ("t.tsv", "\t")])
def test_a_table_has_one_fit_a_row(tmp_path: Path, name: str, tab: str) -> None:
    rows = ["target,tiles,cells,repair,min_edge,expect,name", "hypar,40,,,0.2,,", "sphere,,3x2,true,,3|4,ball", ""]
    spec = read(tmp_path, "\n".join(rows).replace(",", tab), name)
    first, second = spec.items
    assert (first.spec.tiles, first.spec.min_edge, first.expect) == (40, 0.2, (0, 1))
    assert (second.name, second.spec.cells, second.spec.repair, second.expect) == ("ball", (3, 2), True, (3, 4))
    assert set(spec.varied) == {"tiles", "cells", "repair", "min_edge"}


def test_a_wrong_option_spoils_its_item_alone(tmp_path: Path) -> None:
    spec = read(tmp_path, 'targets = ["hypar", { target = "hypar", tolerance = 7 }, "hyper"]')
    fine, wrong, unknown = spec.items
    assert fine.spec is not None and unknown.spec is not None
    assert wrong.spec is None and "--tolerance: expected a number from 1e-12" in wrong.problem


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "expected at least one target, got none"),
        ("targets = []", "expected at least one target, got none"),
        ("targets = 3", "expected a list of targets, got 3"),
        ("targets = [3]", "expected targets as names or as tables with a target, got 3"),
        ("targets = ['']", "expected targets as names or as tables with a target, got ''"),
        ("targets = [{ tiles = 3 }]", "expected targets as names or as tables"),
        ("targets = ['hypar', 'hypar']", "expected every item once, got 'hypar' again"),
        ("targets = ['hypar']\ntarget = 3", "got 'target' .did you mean 'targets'"),
        ("targets = ['hypar']\n[matrix]\ntiles = 3", "expected a list of values for tiles of the matrix, got 3"),
        ("targets = ['hypar']\n[matrix]\ntiles = []", "expected a list of values for tiles of the matrix"),
        ("targets = ['hypar']\n[matrix]\ntiels = [3]", "did you mean 'tiles'"),
        ("targets = ['hypar']\n[matrix]\ntarget = ['sphere']", "expected known names, got 'target'"),
        (
            "targets = ['hypar']\n[matrix]\ntiles = [3]\ncells = ['2x2']",
            "expected cells or tiles in the matrix, got both",
        ),
        ("targets = ['hypar']\nlimits = 3", r"expected a table .limits., got 3"),
        ("targets = ['hypar']\n[limits]\nseconds = 0", "expected seconds above 0"),
        ("targets = ['hypar']\n[limits]\nmemory_mb = 'a'", "expected memory_mb above 16"),
        ("targets = ['hypar']\n[limits]\nhours = 1", "expected known names, got 'hours'"),
        ("targets = ['hypar']\n[tolerances]\ndistance_rms = -1", "expected a relative change from 0"),
        ("targets = ['hypar']\nexpect = 'ok'", "expected exit codes for expect"),
        ("targets = ['hypar']\nexpect = [300]", "expected exit codes for expect"),
        ("targets = ['nothing/*.stl']", "expected files that match 'nothing/.*', got none"),
        ("[[items]]\ntiles = 4", "expected a table with a target for each of the items"),
        ("[[items]]\ntarget = 'hypar'\nname = 'a/b'", "expected names of items of letters"),
        ("[[items]]\ntarget = 'hypar'\nname = 'a'\n[[items]]\ntarget = 'sphere'\nname = 'a'", "got 'a' 2 times"),
        ("targets = [", "expected TOML"),
    ],
)
def test_mistakes_in_a_batch_are_named(tmp_path: Path, text: str, words: str) -> None:
    with pytest.raises(ParameterError, match=words):
        read(tmp_path, text)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("target\n", "expected a line of names and one line a fit"),
        ("target,tiles\nhypar\n", "expected 2 cells in line 2, got 1"),
        ("tiles\n3\n", "expected a column target"),
        ("target,target\na,b\n", "every column once"),
        ("target,tiels\nhypar,3\n", "did you mean 'tiles'"),
        ("target,tiles\n,3\n", "expected a target in line 2"),
        ('target\n"hypar\n', "expected a table"),
    ],
)
def test_mistakes_in_a_table_are_named(tmp_path: Path, text: str, words: str) -> None:
    with pytest.raises(ParameterError, match=words):
        read(tmp_path, text, "t.csv")


def test_what_is_no_batch_is_unreadable(tmp_path: Path) -> None:
    for name, content in (("b.txt", b"x"), ("b.toml", b"\xff\xfe\x00"), ("none.toml", None)):
        if content is not None:
            (tmp_path / name).write_bytes(content)
        with pytest.raises(UnreadableError):
            read_batch(tmp_path / name)
    os.mkfifo(tmp_path / "pipe.toml")
    with pytest.raises(UnreadableError, match="got a device or pipe"):
        read_batch(tmp_path / "pipe.toml")


@given(st.text())
def test_a_name_is_safe_whatever_the_text(text: str) -> None:
    name = safe_name(text)
    assert 0 < len(name.encode()) <= LONGEST_NAME and not name.startswith((".", "-")) and "/" not in name
    assert name.isascii() and safe_name(name) == name


@given(st.lists(st.text(min_size=1), unique=True, min_size=2, max_size=5))
def test_texts_that_differ_have_names_that_differ(texts: list[str]) -> None:
    assert len({safe_name(text) for text in texts}) == len(texts)


def test_items_whose_names_would_be_one_are_told_apart(tmp_path: Path) -> None:
    spec = read(tmp_path, 'targets = ["./A.stl", "./a.stl", "x/b.stl", "x-b.stl", "/tmp/h.stl", "/h.stl"]')
    names = [each.name.lower() for each in spec.items]
    assert len(set(names)) == 6


def test_the_resolved_batch_repeats_itself(tmp_path: Path) -> None:
    spec = read(
        tmp_path,
        'title = "round"\ntargets = ["hypar", { target = "x.stl", expect = 3 }]\n[matrix]\ntiles = [30, 60]\n'
        "[limits]\nseconds = 7\n[tolerances]\ncoverage = 0.1\n",
    )
    again = read(tmp_path, batch_text(spec), "again.toml")
    assert [each.spec for each in again.items] == [each.spec for each in spec.items]
    assert [(each.name, each.expect) for each in again.items] == [(each.name, each.expect) for each in spec.items]
    assert (again.title, again.limits, again.tolerances) == (spec.title, spec.limits, spec.tolerances)
    assert all(isinstance(each.spec, FitSpec) for each in again.items)
