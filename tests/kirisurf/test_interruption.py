"""Signals: nothing to keep before the solve, the best point during it, and a way out at any time."""

from __future__ import annotations

import signal

import pytest

from kirisurf.interruption import Interruption

SIGNALS = [signal.SIGINT, signal.SIGTERM]


@pytest.mark.parametrize("number", SIGNALS)
def test_before_the_solve_a_signal_ends_the_command(number: signal.Signals) -> None:
    with pytest.raises(KeyboardInterrupt), Interruption(lambda text: None):
        signal.raise_signal(number)


@pytest.mark.parametrize("number", SIGNALS)
def test_while_solving_the_first_asks_to_stop_and_the_second_ends(number: signal.Signals) -> None:
    told: list[str] = []
    with Interruption(told.append) as stop:
        stop.stage = "solving"
        assert not stop()
        signal.raise_signal(number)
        assert stop() and "best point" in told[0]
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(number)


def test_while_saving_the_first_is_answered_only() -> None:
    told: list[str] = []
    with Interruption(told.append) as stop:
        stop.stage = "saving"
        signal.raise_signal(signal.SIGINT)
        assert told == [], "nothing is written inside the handler: it may interrupt another message"
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
    assert "saving" in told[0]


def test_handlers_come_back_and_ignored_signals_stay_ignored() -> None:
    before = signal.getsignal(signal.SIGINT)
    old = signal.signal(signal.SIGTERM, signal.SIG_IGN)
    try:
        with Interruption(lambda text: None):
            assert signal.getsignal(signal.SIGINT) is not before
            signal.raise_signal(signal.SIGTERM)
        assert signal.getsignal(signal.SIGINT) is before
    finally:
        signal.signal(signal.SIGTERM, old)
