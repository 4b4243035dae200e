"""A batch from its spec to its summary: what is kept, what is made again, what is told; with an engine of the test."""

from __future__ import annotations

import errno
import json
import shutil
from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest

from kirisurf.batch.baseline import baseline_text, comparison, read_baseline
from kirisurf.batch.engines import Engine
from kirisurf.batch.folder import BatchFolder
from kirisurf.batch.making import make
from kirisurf.batch.order import Answer, Order
from kirisurf.batch.outcome import Outcome
from kirisurf.batch.reading import BatchSpec, read_batch
from kirisurf.batch.running import Asking, Told, run_batch
from kirisurf.batch.writing import batch_text
from kirisurf.errors import OutputError, ParameterError, UnreadableError
from kirisurf.provenance import inputs, key
from tests.kirisurf.batch.trees import differences

TEXT = """
targets = ["hypar", "./junk.obj"]
[matrix]
cells = ["1x1", "2x2"]
"""


class Made:
    """An engine that makes runs in this process, and remembers which."""

    def __init__(self, stop_after: int = 10**9) -> None:
        self.names: list[str] = []
        self.stop_after = stop_after

    def __call__(self, orders: Sequence[Order]) -> Iterator[tuple[int, Answer]]:
        for k, order in enumerate(orders):
            if len(self.names) == self.stop_after:
                raise KeyboardInterrupt
            self.names.append(Path(order.folder).name)
            code, message = make(order)
            yield k, Answer(code, message, seconds=1.0, peak_mb=2.0)


def read(folder: Path, text: str = TEXT) -> BatchSpec:
    (folder / "junk.obj").write_text("v 0 0 0\n")
    (folder / "batch.toml").write_text(text)
    return read_batch(folder / "batch.toml")


def run(spec: BatchSpec, out: Path, engine: Engine, asking: Asking | None = None) -> dict:
    with BatchFolder(out, batch_text(spec)) as folder:
        return run_batch(spec, folder, engine, asking or Asking(), Told())


def changed(before: Path, now: Path) -> list[str]:
    """What differs, but for the paths of the targets in the spec: the batch was moved."""
    return [name for name in differences(before, now) if name != "batch.toml"]


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    home = tmp_path_factory.mktemp("finished")
    run(read(home), home / "out", Made())
    return home


@pytest.fixture
def home(finished: Path, tmp_path: Path) -> Path:
    """A finished batch that may be spoiled."""
    shutil.copytree(finished, tmp_path / "home")
    return tmp_path / "home"


def test_the_folder_holds_what_is_promised(finished: Path) -> None:
    out = finished / "out"
    names = ["hypar--cells-1x1", "hypar--cells-2x2"]
    assert sorted(each.name for each in out.iterdir()) == [
        "batch.toml", "outcomes", "report.html", "runs", "summary.csv", "summary.json",
    ]  # fmt: skip
    assert sorted(each.name for each in (out / "runs").iterdir()) == names
    summary = json.loads((out / "summary.json").read_text())
    assert summary["counts"] == {"done": 2, "unusable": 2, "total": 4, "unexpected": 2}
    assert [each["name"] for each in summary["items"] if not each["is_expected"]] == [
        "junk.obj--cells-1x1", "junk.obj--cells-2x2",
    ]  # fmt: skip
    for item in summary["items"]:
        assert json.loads((out / "outcomes" / f"{item['name']}.json").read_text()) == item
    lines = (out / "summary.csv").read_text().splitlines()
    assert len(lines) == 5 and lines[0].startswith("name,target,code,outcome,is_expected,certified,status,tiles")
    page = (out / "report.html").read_text()
    assert all(name in page for name in names)


def test_what_is_finished_is_kept_and_the_rest_is_made(home: Path) -> None:
    shutil.copytree(home / "out", home / "before")
    made = Made()
    run(read(home), home / "out", made)
    # what failed has no commit record
    assert made.names == ["junk.obj--cells-1x1", "junk.obj--cells-2x2"]
    assert changed(home / "before", home / "out") == []


def spoil_record(run_folder: Path) -> None:
    (run_folder / "result.json").unlink()


def spoil_file(run_folder: Path) -> None:
    with open(run_folder / "deployed.obj", "ab") as file:
        file.write(b"#")


def spoil_missing(run_folder: Path) -> None:
    (run_folder / "pattern.svg").unlink()


def spoil_key(run_folder: Path) -> None:
    result = json.loads((run_folder / "result.json").read_text())
    result["provenance"]["source"] = result["provenance"]["key"] = "0" * 16
    (run_folder / "result.json").write_text(json.dumps(result))


def spoil_half(run_folder: Path) -> None:
    """As a process leaves it that is killed in the middle of a commit: the old run lies in a hidden folder."""
    hidden = run_folder / ".kirisurf-previous-x"
    hidden.mkdir()
    for path in sorted(run_folder.iterdir()):
        if path.is_file():
            path.rename(hidden / path.name)
    staged = run_folder / ".kirisurf-partial-y"
    staged.mkdir()
    (staged / "deployed.obj").write_text("half")


def spoil_interrupted(run_folder: Path) -> None:
    result = json.loads((run_folder / "result.json").read_text())
    result["exit_code"], result["status"] = 130, "INTERRUPTED"
    (run_folder / "result.json").write_text(json.dumps(result))


@pytest.mark.parametrize(
    ("spoil", "is_made"),
    [
        (spoil_record, True),
        (spoil_file, True),
        (spoil_missing, True),
        (spoil_key, True),
        (spoil_interrupted, True),
        (spoil_half, False),
        (shutil.rmtree, True),
    ],
)
def test_what_is_not_whole_is_made_again(home: Path, spoil: object, is_made: bool) -> None:
    shutil.copytree(home / "out", home / "before")
    spoil(home / "out" / "runs" / "hypar--cells-2x2")
    (home / "out" / ".kirisurf-summary.tmp").write_text("left by a killed process")
    (home / "out" / "outcomes" / ".kirisurf-x.tmp").write_text("left by a killed process")
    made = Made()
    run(read(home), home / "out", made)
    assert ("hypar--cells-2x2" in made.names) is is_made and "hypar--cells-1x1" not in made.names
    assert changed(home / "before", home / "out") == []


def test_a_run_with_pictures_is_kept_where_none_are_asked_for(home: Path) -> None:
    spec = read(home)
    result = home / "out" / "runs" / "hypar--cells-2x2" / "result.json"
    record = json.loads(result.read_text())
    fit = next(item.spec for item in spec.items if item.name == "hypar--cells-2x2")
    assert record["provenance"]["key"] == key(fit, inputs(fit), False)
    record["provenance"]["key"] = key(fit, inputs(fit), True)
    result.write_text(json.dumps(record))
    made = Made()
    run(spec, home / "out", made)
    assert "hypar--cells-2x2" not in made.names
    made = Made()
    run(spec, home / "out", made, Asking(pictures=True))
    assert "hypar--cells-2x2" not in made.names and "hypar--cells-1x1" in made.names


def test_another_option_makes_its_items_again(home: Path) -> None:
    made = Made()
    run(read(home, TEXT.replace("[matrix]", "[options]\nprefer = 'open'\n[matrix]")), home / "out", made)
    assert len(made.names) == 4


def test_another_content_of_a_file_is_another_input(tmp_path: Path) -> None:
    text = "targets = ['./a.stl']\n[options]\ncells = '1x1'"
    import kirisurf
    from kirisurf.formats import write_obj
    from kirisurf.loops import Loops

    def write(height: float) -> None:
        surface = kirisurf.load("hypar", resolution=8)
        scaled = surface.vertices * (1.0, 1.0, height)
        write_obj(tmp_path / "a.obj", scaled, Loops.from_lists(surface.faces.tolist()))

    text = text.replace("a.stl", "a.obj")
    for height, n in ((1.0, 1), (1.0, 0), (0.5, 1), (0.5, 0)):
        write(height)
        made = Made()
        run(read(tmp_path, text), tmp_path / "out", made)
        assert len(made.names) == n


def test_an_interrupted_batch_goes_on_where_it_was(finished: Path, tmp_path: Path) -> None:
    home = tmp_path
    with pytest.raises(KeyboardInterrupt):
        run(read(home), home / "out", Made(stop_after=1))
    summary = json.loads((home / "out" / "summary.json").read_text())
    assert summary["counts"] == {"done": 1, "not run": 3, "total": 4, "unexpected": 3}
    made = Made()
    run(read(home), home / "out", made)
    assert len(made.names) == 3
    assert changed(finished / "out", home / "out") == []


def test_a_full_disk_ends_the_batch_and_loses_nothing(tmp_path: Path) -> None:
    def engine(orders: Sequence[Order]) -> Iterator[tuple[int, Answer]]:
        yield 0, Answer(*make(orders[0]))
        yield 1, Answer(7, f"x: expected to write this file, got: {errno.errorcode[errno.ENOSPC]}")
        raise AssertionError("expected nothing more to be asked")

    with pytest.raises(OutputError, match="ENOSPC"):
        run(read(tmp_path), tmp_path / "out", engine)
    assert (tmp_path / "out" / "runs" / "hypar--cells-1x1" / "result.json").exists()
    made = Made()
    run(read(tmp_path), tmp_path / "out", made)
    assert "hypar--cells-1x1" not in made.names and len(made.names) == 3


def test_two_batches_in_one_folder_are_one_too_many(tmp_path: Path) -> None:
    spec = read(tmp_path)
    with (
        BatchFolder(tmp_path / "out", batch_text(spec)),
        pytest.raises(OutputError, match="one that another batch is writing to"),
        BatchFolder(tmp_path / "out", "other"),
    ):
        raise AssertionError("unreachable")
    assert (tmp_path / "out" / "batch.toml").read_text() == batch_text(spec)


def test_a_folder_of_something_else_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "thesis.tex").write_text("x")
    with pytest.raises(ParameterError, match=r"got other files \(thesis.tex\)"), BatchFolder(tmp_path / "out", ""):
        raise AssertionError("unreachable")
    assert [each.name for each in (tmp_path / "out").iterdir()] == ["thesis.tex"]
    with pytest.raises(OutputError, match="got a file"), BatchFolder(tmp_path / "out" / "thesis.tex", ""):
        raise AssertionError("unreachable")


def test_an_unchanged_rerun_is_the_same_and_a_planted_one_is_caught(home: Path) -> None:
    out = home / "out"
    spec = read(home)
    outcomes = [_outcome(out, item.name) for item in spec.items]
    (home / "base.toml").write_text(baseline_text(dicts(outcomes)))
    for baseline in (home / "base.toml", out, out / "summary.json"):
        found = comparison(spec, outcomes, read_baseline(baseline), "b")
        assert found["counts"] == {"worse": 0, "missing": 0, "new": 0, "better": 0, "same": 4}
    spoiled = [
        Outcome(**{**vars(each), "measures": {**each.measures, "distance_rms": 1.1 * each.measures["distance_rms"]}})
        if each.measures
        else each
        for each in outcomes
    ]
    found = comparison(spec, spoiled, read_baseline(home / "base.toml"), "b")
    assert found["counts"]["worse"] == 2
    assert [change["measure"] for each in found["items"] for change in each["changes"]] == ["distance_rms"] * 2


def test_a_baseline_written_anew_keeps_the_lines_that_did_not_change(home: Path) -> None:
    outcomes = [_outcome(home / "out", item.name) for item in read(home).items]
    (home / "base.toml").write_text(baseline_text(dicts(outcomes)))
    before = read_baseline(home / "base.toml")
    noisy = [
        Outcome(**{**vars(each), "measures": {n: v and v * (1 + 1e-7) for n, v in each.measures.items()}})
        for each in outcomes
    ]
    assert baseline_text(dicts(noisy), before) == baseline_text(dicts(outcomes))
    assert len(baseline_text(dicts(outcomes)).splitlines()) < 120


@pytest.mark.parametrize(
    ("name", "text", "error"),
    [
        ("b.toml", "x = [", ParameterError),
        ("b.toml", "x = 1", ParameterError),
        ("b.toml", "items = 3", ParameterError),
        ("b.json", "{}", ParameterError),
        ("b.json", "[", ParameterError),
        ("none.toml", None, UnreadableError),
    ],
)
def test_what_is_no_baseline_is_refused(tmp_path: Path, name: str, text: str | None, error: type) -> None:
    if text is not None:
        (tmp_path / name).write_text(text)
    with pytest.raises(error):
        read_baseline(tmp_path / name)


def dicts(outcomes: list[Outcome]) -> list[dict]:
    return [each.as_dict() for each in outcomes]


def _outcome(out: Path, name: str) -> Outcome:
    values = json.loads((out / "outcomes" / f"{name}.json").read_text())
    tuples = {key: tuple(values[key]) for key in ("expect", "warnings", "failures", "said")}
    return Outcome(**{**values, **tuples})
