"""Computations in slices: they advance while `run_for` runs, and at no other time."""

from collections.abc import Generator
from time import sleep
from typing import Any

import pytest

from thetascope.diagnosis.yield_points import run_to_end
from thetascope.live.scheduling.time_slices import TimeSlices


def slices_until_done(slices: TimeSlices, seconds: float) -> int:
    """Return the number of slices until the computation is done."""
    count = 0
    while slices.busy and count < 10_000:
        slices.run_for(seconds)
        count += 1
    return count


def counting(steps: list[int], count: int) -> Generator[None, None, int]:
    """Append 0, 1, … with a pause before each, and return 7."""
    for k in range(count):
        yield
        steps.append(k)
    return 7


def test_a_job_is_done_piece_by_piece():
    """A job with a hundred pauses: slices of no length go from one pause to the next each, and its value arrives."""
    slices, steps, answers = TimeSlices(), [], []
    slices.begin(counting(steps, 100), lambda *answer: answers.append(answer))
    assert slices.busy and steps == []
    slices.run_for(0.0)
    slices.run_for(0.0)
    assert steps == [0]
    assert slices_until_done(slices, 0.0) == 99 and answers == [(7, None)] and steps == list(range(100))
    slices.begin(counting(steps, 100), lambda *answer: answers.append(answer))
    assert slices_until_done(slices, 60.0) == 1 and len(answers) == 2


def test_nothing_runs_between_slices():
    """Between two slices no step is done."""
    slices, steps = TimeSlices(), []
    slices.begin(counting(steps, 1000), lambda *_: None)
    slices.run_for(0.0)
    slices.run_for(0.0)
    sleep(0.05)
    assert steps == [0]
    assert slices_until_done(slices, 1.0) == 1 and len(steps) == 1000


def failing() -> Generator[None, None, Any]:
    """Fail after a pause."""
    yield
    raise ZeroDivisionError


def test_a_failing_job_gives_its_error():
    """An error is handed to the callback, and the next job is done."""
    slices, answers = TimeSlices(), []
    slices.begin(failing(), lambda *answer: answers.append(answer))
    slices_until_done(slices, 1.0)
    slices.begin(counting([], 3), lambda *answer: answers.append(answer))
    slices_until_done(slices, 1.0)
    assert isinstance(answers[0][1], ZeroDivisionError) and answers[1] == (7, None)


def test_a_job_may_begin_the_next_one_from_its_callback():
    """The callback of a job begins another, which is then done too."""
    slices, steps, answers = TimeSlices(), [], []
    slices.begin(counting([], 2), lambda *_: slices.begin(counting(steps, 2), lambda *answer: answers.append(answer)))
    slices.run_for(1.0)
    assert slices.busy and steps == []
    slices.run_for(1.0)
    assert answers == [(7, None)] and steps == [0, 1] and not slices.busy


def test_a_whole_computation_can_be_ended_between_steps():
    """`run_to_end` returns the value, and asks between steps whether to go on."""
    steps = []
    assert run_to_end(counting(steps, 5)) == 7 and steps == [0, 1, 2, 3, 4]

    def stop_after_two() -> None:
        if len(steps) == 7:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_to_end(counting(steps, 5), stop_after_two)
    assert len(steps) == 7
