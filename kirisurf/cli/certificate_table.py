"""The certificate as a plain table for people."""

from __future__ import annotations

from collections.abc import Mapping

_AT_LEAST = ("opening_min", "min_edge", "coverage", "coverage_strict")
_OPTIONAL = ("loop", "boundary", "contracted_boundary")


def certificate_table(rows: Mapping[str, float | int | None], limits: Mapping[str, float | int]) -> str:
    """Return one line per row: name, value, limit, verdict.

    Examples
    --------
    >>> print(certificate_table({"length": 2e-13, "loop": None, "coverage": 0.9}, {"length": 1e-9, "coverage": 0.95}))
    row                      value       limit
    length                 2.0e-13    <= 1e-09  ok
    loop                         -              does not apply
    coverage                   0.9     >= 0.95  FAILS
    """
    lines = [f"{'row':<20}{'value':>10}{'limit':>12}"]
    for name, value in rows.items():
        limit = limits.get(name)
        shown = "-" if value is None else f"{value:.1e}" if 0 < abs(value) < 1e-3 else f"{value:.4g}"
        bound = "" if limit is None else f"{_sign(name)} {limit:g}"
        lines.append(f"{name:<20}{shown:>10}{bound:>12}  {_verdict(name, value, limit)}".rstrip())
    return "\n".join(lines)


def _sign(name: str) -> str:
    return ">" if name == "opening_min" else ">=" if name in _AT_LEAST else "<="


def _verdict(name: str, value: float | int | None, limit: float | int | None) -> str:
    if value is None:
        return "does not apply" if name in _OPTIONAL else "not checked"
    if limit is None:
        return ""
    holds = value > limit if name == "opening_min" else value >= limit if name in _AT_LEAST else value <= limit
    return "ok" if holds else "FAILS"
