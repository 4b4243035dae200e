"""A small fit as an engine would report it, and an engine that answers from this process."""

from __future__ import annotations

import threading
from multiprocessing import Event, Pipe

import pytest

from kirisurf.spec import FitSpec
from viewers.workbench import events
from viewers.workbench.results import Results
from viewers.workbench.state import State
from viewers.workbench.worker import Worker


class Desk:
    """A worker without a process: requests in, the list of its reports out."""

    def __init__(self) -> None:
        self._ours, theirs = Pipe()
        self.stop = Event()
        self._worker = Worker(theirs, self.stop)
        self._number = 0

    def ask(self, request: object) -> list[events.Event]:
        """Answer a request while another thread reads, since a pipe holds little."""
        heard: list[events.Event] = []
        done = threading.Event()

        def listen() -> None:
            while not done.is_set() or self._ours.poll():
                if self._ours.poll(0.01):
                    heard.append(self._ours.recv())

        thread = threading.Thread(target=listen)
        thread.start()
        try:
            self._worker.answer(request)
        finally:
            done.set()
            thread.join()
        return heard

    def fit(self, spec: FitSpec, **how: object) -> tuple[Results, list[events.Event]]:
        self._number += 1
        heard = self.ask(events.Job(self._number, spec, **how))
        results = Results().begun(self._number)
        for event in heard:
            results = results.received(event)
        return results, heard


@pytest.fixture
def desk() -> Desk:
    return Desk()


@pytest.fixture(scope="session")
def spec() -> FitSpec:
    return FitSpec(target="hypar", cells=(3, 3))


@pytest.fixture(scope="session")
def fitted(spec: FitSpec) -> Results:
    """Everything known of one small fit."""
    return Desk().fit(spec)[0]


@pytest.fixture
def state(spec: FitSpec) -> State:
    return State(spec)
