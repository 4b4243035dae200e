"""How far a fit is, as a share and in words."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from kirisurf.status import Status
from viewers.words import number, row_in_words
from viewers.workbench.events import Certified
from viewers.workbench.pipeline import Stage
from viewers.workbench.results import Results


def solved_share(steps: Sequence[Mapping[str, float]], tolerance: float) -> float:
    """Return the digits won of those between the largest residual seen and the tolerance, from 0 to 1.

    Examples
    --------
    >>> solved_share([{"length": 1.0}, {"length": 1e-3}], 1e-9)
    0.3333333333333333
    """
    worst = [max((v for v in step.values() if math.isfinite(v)), default=0.0) for step in steps]
    if not worst or max(worst) <= tolerance:
        return float(bool(worst))
    last = max(worst[-1], tolerance)
    return math.log(max(worst) / last) / math.log(max(worst) / tolerance)


def progress_words(results: Results, is_stale: bool) -> tuple[str, bool]:
    """Return the status line, and whether it tells of a problem."""
    if results.running is Stage.FIT and results.steps:
        worst = max(results.steps[-1].residuals.values(), default=0.0)
        return f"Solving: step {len(results.steps)}, largest residual {worst:.0e}", False
    if results.running is not None and results.doing:
        return f"{results.doing[:1].upper()}{results.doing[1:]} ...", False
    if results.running is not None:
        return "Starting ...", False
    if is_stale and results.fitted is not None and results.moving is None:
        # newer than what was written or failed for the options before
        return "The options have changed since this fit: press Fit.", False
    if results.problem:
        return results.problem, True
    if results.said:
        return results.said[:1].upper() + results.said[1:], False
    if results.moving is not None:
        return "The pattern is laid on the target: press Fit.", False
    if results.fitted is None:
        return "Nothing fitted yet: press Fit.", False
    fails = results.certified is not None and not results.certified.passed
    return _finished(results), fails or results.fitted.status is not Status.CONVERGED


def _failing(certified: Certified) -> str:
    """Name the rows of the certificate that fail, in words."""
    titles = [row_in_words(each.partition(":")[0], None, None).title for each in certified.failures]
    shown = ", ".join(f"\u201c{title}\u201d" for title in dict.fromkeys(titles))
    return f"not certified (fails: {shown})" if shown else "not certified"


def _finished(results: Results) -> str:
    fitted = results.fitted
    if fitted is None:
        return ""
    if fitted.status is not Status.CONVERGED:
        return fitted.status.value + (" Resume goes on from there." if results.can_resume else "")
    verdict = ""
    if results.certified is not None:
        verdict = "certified, " if results.certified.passed else f"{_failing(results.certified)}, "
    distance = fitted.numbers.get("distance_rms")
    near = "" if distance is None else f", {number(100 * distance)} % of an edge from the target (rms)"
    seconds = fitted.seconds.get("all")
    took = "" if seconds is None else f" in {seconds:.2f} s"
    count = len(fitted.sheet.tiles)
    words = f"{verdict}{count} tiles, {len(fitted.history)} steps{took}{near}"
    return words[:1].upper() + words[1:]
