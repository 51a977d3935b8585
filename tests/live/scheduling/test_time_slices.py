"""Work in slices: it is done while the loop waits for it, and at no other time."""

import threading
from time import sleep

from thetascope.diagnosis.yield_points import once, pause
from thetascope.live.scheduling.time_slices import Slices


def finished(slices: Slices, seconds: float) -> int:
    """Slices until the job is done."""
    count = 0
    while slices.busy and count < 10_000:
        slices.go_on(seconds)
        count += 1
    return count


def test_a_job_is_done_piece_by_piece():
    """A job with a hundred pauses: at slices of no length each goes from one pause to the next, and its value arrives."""
    slices, steps, answers = Slices(), [], []

    def job() -> int:
        for k in range(100):
            pause()
            steps.append(k)
        return 7

    slices.begin(job, lambda *answer: answers.append(answer))
    assert slices.busy and steps == []
    slices.go_on(0.0)
    slices.go_on(0.0)
    assert steps == [0]
    assert finished(slices, 0.0) == 99 and answers == [(7, None)] and steps == list(range(100))
    slices.begin(job, lambda *answer: answers.append(answer))
    assert finished(slices, 60.0) == 1 and len(answers) == 2


def test_nothing_goes_on_between_slices():
    """While the loop does something else the job stands still."""
    slices, steps = Slices(), []

    def job() -> None:
        for k in range(1000):
            pause()
            steps.append(k)

    slices.begin(job, lambda *_: None)
    slices.go_on(0.0)
    slices.go_on(0.0)
    before = len(steps)
    sleep(0.05)
    assert len(steps) == before == 1
    finished(slices, 1.0)


def test_a_failing_job_gives_its_error():
    """What a job raises is handed over, and the next one is done."""
    slices, answers = Slices(), []
    slices.begin(lambda: 1 / 0, lambda *answer: answers.append(answer))
    finished(slices, 1.0)
    slices.begin(lambda: "well", lambda *answer: answers.append(answer))
    finished(slices, 1.0)
    assert isinstance(answers[0][1], ZeroDivisionError) and answers[1] == ("well", None)


def test_a_property_found_once_locks_nobody_out():
    """While one object's property waits in a slice another object's is found."""

    class Thing:
        def __init__(self, waits: bool) -> None:
            self.waits, self.count = waits, 0

        @once
        def value(self) -> int:
            self.count += 1
            if self.waits:
                pause()
            return 3

    slices, slow, quick = Slices(), Thing(True), Thing(False)
    slices.begin(lambda: slow.value, lambda *_: None)
    slices.go_on(0.0)
    assert slices.busy
    thread = threading.Thread(target=lambda: quick.value, daemon=True)
    thread.start()
    thread.join(5)
    assert not thread.is_alive() and quick.value == 3 and quick.count == 1
    finished(slices, 1.0)
    assert slow.value == 3 and slow.count == 1
