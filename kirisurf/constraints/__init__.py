"""Constraint blocks: each module is one kind of row, with residual and exact derivatives."""
