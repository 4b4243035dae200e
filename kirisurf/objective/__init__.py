"""Objective terms: least-squares rows with weights, in the same form as constraint blocks."""
