import threading
from functools import partial

import pytest

from kirisurf.solvers.team import Team, n_cores


@pytest.mark.parametrize("size", [1, 2, 5])
@pytest.mark.parametrize("n", [0, 1, 2, 50])
def test_every_task_is_done_once(size, n):
    done = []
    with Team(size) as team:
        team.run([partial(done.append, i) for i in range(n)])
        assert sorted(done) == list(range(n))


def test_two_work_at_the_same_time():
    meeting = threading.Barrier(2, timeout=120)
    with Team(2) as team:
        team.run([meeting.wait, meeting.wait])


@pytest.mark.parametrize("size", [1, 2])
@pytest.mark.parametrize("position", [0, 5, 9])
def test_an_exception_comes_out_and_the_team_goes_on(size, position):
    def fail():
        raise ValueError("this one")

    with Team(size) as team:
        with pytest.raises(ValueError, match="this one"):
            team.run([fail if i == position else (lambda: None) for i in range(10)])
        done = []
        team.run([partial(done.append, i) for i in range(3)])
        assert sorted(done) == [0, 1, 2]


def test_there_is_a_core():
    assert n_cores() >= 1
