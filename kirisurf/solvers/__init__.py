"""Solvers: each takes a Problem and a start and returns an Outcome."""
