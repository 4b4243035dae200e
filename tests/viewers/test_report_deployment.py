"""The section on the way between flat and deployed: there where the run has one, and true to its record."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import kirisurf
from kirisurf.deploying import deploy_with_collisions, save_deployment
from kirisurf.deployment_folder import deployment_folder
from kirisurf.reporting import report, run_parts
from kirisurf.runs import Run
from tests.viewers.report_page import Page
from viewers.report_page import formatted, pointed

HEADING = "<h2>Deployment</h2>"


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    design = kirisurf.fit("circle", cells=(2, 2), contracted="rectangle:1")
    return design.save(tmp_path_factory.mktemp("report") / "disc", pictures=False)


def test_a_run_has_the_section_once_it_is_deployed(run: Run, tmp_path: Path) -> None:
    before = report(run, tmp_path / "before.html", pictures=False).read_text(encoding="utf-8")
    assert HEADING not in before and "deployment" not in json.loads(report(run, tmp_path / "a.json").read_text())
    with deployment_folder(run) as folder:
        save_deployment(deploy_with_collisions(run, steps=4, torsion=(0.0, 1e-3)), folder, animation=False)
    text = report(run, tmp_path / "after.html", pictures=False).read_text(encoding="utf-8")
    numbers = json.loads(report(run, tmp_path / "b.json").read_text(encoding="utf-8"))
    assert HEADING in text and text.count("data:image/png") == before.count("data:image/png") + 1
    record = json.loads((run.folder / "deployment" / "deployment.json").read_text(encoding="utf-8"))
    assert numbers["deployment"]["paths"] == record["paths"] and "files" not in numbers["deployment"]
    assert all(path["sentence"] in text for path in record["paths"])
    shown = [each for each in Page(text).shown if each.pointer.startswith("/deployment/")]
    assert len(shown) >= 6
    # what a residual says, and no more
    assert max(path["largest_residual"] for path in record["paths"]) < 1e-6 and "every state is in equilibrium" in text
    for each in shown:
        found = pointed(numbers, each.pointer)
        assert found == float(each.value) and each.text == formatted(found, each.form)


def record_of(run: Run) -> Path:
    """The record of the run's deployment, which is made where there is none."""
    file = run.folder / "deployment" / "deployment.json"
    if not file.exists():
        with deployment_folder(run) as folder:
            save_deployment(deploy_with_collisions(run, steps=2, torsion=(0.0,)), folder, animation=False)
    return file


def test_the_deployment_of_other_states_is_not_shown(run: Run, tmp_path: Path) -> None:
    file = record_of(run)
    record = file.read_text(encoding="utf-8")
    assert run_parts(run).deployment is not None
    try:
        file.write_text(json.dumps({**json.loads(record), "key": {}}), encoding="utf-8")
        assert run_parts(run).deployment is None
        assert HEADING not in report(run, tmp_path / "page.html", pictures=False).read_text(encoding="utf-8")
    finally:
        file.write_text(record, encoding="utf-8")


def test_states_out_of_equilibrium_are_not_called_balanced(run: Run, tmp_path: Path) -> None:
    file = record_of(run)
    text = file.read_text(encoding="utf-8")
    record = json.loads(text)
    record["paths"][-1]["largest_residual"] = 1e-3
    try:
        file.write_text(json.dumps(record), encoding="utf-8")
        page = report(run, tmp_path / "page.html", pictures=False).read_text(encoding="utf-8")
        assert "every state is in equilibrium" not in page and "not in equilibrium" in page
    finally:
        file.write_text(text, encoding="utf-8")
