"""The gallery as a batch against its baseline: what the project ships is not worse than it was."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

import kirisurf.cli as cli
from docs.gallery.outlines import OUTLINES
from docs.gallery.surfaces import SURFACES
from kirisurf.batch.baseline import read_baseline
from kirisurf.batch.reading import read_batch
from kirisurf.spec import FitSpec
from kirisurf.targets import resolved

FOLDER = Path(__file__).resolve().parents[2] / "docs" / "gallery"
BATCH, BASELINE = FOLDER / "batch.toml", FOLDER / "baseline.toml"


def test_the_batch_is_the_gallery() -> None:
    items = {item.name: item.spec for item in read_batch(BATCH).items}
    examples = {each.name: each for each in SURFACES + OUTLINES}
    assert list(items) == list(examples)
    for name, example in examples.items():
        sized = bool({"cells", "tiles"} & set(example.options))
        assert items[name] == resolved(FitSpec(target=name, **example.options), sized=sized)
    assert sorted(read_baseline(BASELINE)) == sorted(items)


@pytest.mark.slow
def test_nothing_in_the_gallery_is_worse_than_its_baseline(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code = cli.main(["batch", str(BATCH), "-o", str(tmp_path / "out"), "--baseline", str(BASELINE)])
    said = capsys.readouterr().err
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["comparison"]["counts"]["worse"] == 0, said
    assert summary["comparison"]["counts"]["missing"] == summary["comparison"]["counts"]["new"] == 0, said
    assert code == 0, said
    assert all(item["certified"] for item in summary["items"])

    # the same with the solver made worse in one item: it ends before it is there
    shutil.copy(BATCH, tmp_path / "worse.toml")
    text = BATCH.read_text().replace('name = "sphere"', 'name = "sphere"\nmax_steps = 3')
    (tmp_path / "worse.toml").write_text(text)
    words = ["batch", str(tmp_path / "worse.toml"), "-o", str(tmp_path / "out"), "--baseline", str(BASELINE)]
    assert cli.main(words) == 8
    assert "worse: sphere\n    certified before, not certified now (exit code 0 -> 6)" in capsys.readouterr().err
