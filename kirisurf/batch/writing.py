"""A batch as TOML text: every item with all its options, so that the file repeats the batch."""

from __future__ import annotations

from typing import Any

from kirisurf.batch.reading import BatchSpec


def batch_text(spec: BatchSpec) -> str:
    """Return the resolved batch as TOML text, which :func:`kirisurf.batch.reading.read_batch` reads back."""
    import tomli_w

    items: list[dict[str, Any]] = []
    for item in spec.items:
        options = {"target": item.target, **item.varied} if item.spec is None else item.spec.as_dict()
        items.append({"name": item.name, "expect": list(item.expect), **options})
    values: dict[str, Any] = {"title": spec.title}
    values["limits"] = {"seconds": spec.limits.seconds, "memory_mb": spec.limits.memory_mb}
    if spec.tolerances:
        values["tolerances"] = dict(spec.tolerances)
    return tomli_w.dumps({**values, "items": items})
