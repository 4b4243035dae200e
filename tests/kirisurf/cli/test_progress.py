"""Progress: few plain lines with the first and last step among them, and a bar that only moves forward to full."""

from __future__ import annotations

import io

import pytest

from kirisurf.cli.progress import Bar, Lines, step_text
from kirisurf.states import Step


def step(residual: float, seconds: float = 0.0) -> Step:
    return Step({"length": residual, "angle": residual / 10}, 1.0, 1.0, 0.1, seconds)


def test_lines_come_at_most_once_a_second_and_the_last_step_is_never_lost() -> None:
    lines: list[str] = []
    now = iter(x / 10 for x in range(1000))
    with Lines(lines.append, lambda: next(now)) as progress:
        progress.stage("solving")
        for k in range(40):
            progress.step(step(10.0**-k))
        progress.stage("measuring")
    assert lines[0] == "solving ..." and lines[-1] == "measuring ..."
    assert lines[1].startswith("step   1:") and lines[-2].startswith("step  40:")
    assert len(lines) < 12


def test_a_step_shows_every_block() -> None:
    assert step_text(7, step(1e-3, 2.0)) == "step   7: length 1.0e-03  angle 1.0e-04  (2.0 s)"


def test_the_bar_is_full_at_the_tolerance(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stderr", io.StringIO())
    with Bar(1e-10) as bar:
        shares = []
        bar.stage("solving")
        for residual in (1e-2, 1e-4, 1e-6, 1e-10, 1e-12):
            bar.step(step(residual))
            shares.append(bar._shown.tasks[0].completed)
    assert shares == pytest.approx([0.0, 0.25, 0.5, 1.0, 1.0])
