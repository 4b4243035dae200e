"""A small reader of the keyword format, written from its description and not from the writer."""

from __future__ import annotations

import numpy as np


def blocks(text: str) -> list[tuple[str, dict[str, str], list[list[str]]]]:
    """Keyword, its options, and its lines, each split at commas; comments left out."""
    found: list[tuple[str, dict[str, str], list[list[str]]]] = []
    for line in text.splitlines():
        if line.startswith("**") or not line.strip():
            continue
        fields = [field.strip() for field in line.rstrip().rstrip(",").split(",")]
        if line.startswith("*"):
            options = dict((*option.split("=", 1), "")[:2] for option in fields[1:])
            found.append((fields[0][1:].upper(), options, []))
        else:
            found[-1][2].append(fields)
    return found


def sets(text: str, keyword: str) -> dict[str, np.ndarray]:
    """Numbers, from 0 on, of the named sets."""
    return {
        options[keyword]: np.array([int(x) - 1 for row in rows for x in row])
        for name, options, rows in blocks(text)
        if name == keyword
    }


def mesh(text: str) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (n, 3) and elements (m, 6), from 0 on."""
    nodes = next(rows for name, _, rows in blocks(text) if name == "NODE")
    elements = next(rows for name, _, rows in blocks(text) if name == "ELEMENT")
    assert [int(row[0]) for row in nodes] == list(range(1, len(nodes) + 1))
    return np.array([row[1:] for row in nodes], float), np.array([row[1:] for row in elements], int) - 1


def drives(text: str) -> list[dict[tuple[int, int], float]]:
    """For every step, {(node from 0 on, direction): displacement}."""
    found: list[dict[tuple[int, int], float]] = []
    for name, _, rows in blocks(text):
        if name == "STEP":
            found.append({})
        elif name == "BOUNDARY":
            found[-1].update({(int(node) - 1, int(axis) - 1): float(value) for node, axis, _, value in rows})
    return found
