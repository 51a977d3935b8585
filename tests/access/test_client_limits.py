"""The limits of one client, and the processor time of the last minute."""

import pytest

from thetascope.access.client_limits import ClientLimits, limits_of
from thetascope.access.principal import LOCAL, Principal
from thetascope.runs.workers.last_minute import LastMinute
from thetascope.settings import Settings

GUEST = Principal("browser 1", "browser-1")


def test_one_person_on_the_machine_has_no_limits(tmp_path):
    """Those who need the key have; a value that is set holds for everybody, and 0 removes a limit."""
    assert limits_of(Settings(data=tmp_path), LOCAL) == ClientLimits(None, None, None, None)
    assert None not in vars(limits_of(Settings(data=tmp_path), GUEST)).values()
    some = Settings(data=tmp_path, client_runs=3, client_cpu=0.0)
    assert limits_of(some, LOCAL).runs == limits_of(some, GUEST).runs == 3
    assert limits_of(some, GUEST).cpu is None


def test_processor_time_counts_for_a_minute():
    """A client may compute again as soon as enough of its use is older than that."""
    time = [0.0]
    minute = LastMinute(lambda: time[0])
    for time[0] in (0.0, 0.4, 30.0, 45.0):
        minute.add("a", 2.0)
    minute.add("b", 50.0)
    assert minute.used("a") == 8.0 and minute.used("c") == 0.0
    assert minute.wait("a", 8.1) == 0.0 and minute.wait("c", 1.0) == 0.0
    assert minute.wait("a", 8.0) == minute.wait("a", 5.0) == pytest.approx(15.0)
    assert minute.wait("a", 3.0) == pytest.approx(45.0)
    time[0] = 60.0
    assert minute.used("a") == 4.0 and minute.wait("a", 5.0) == 0.0
    time[0] = 200.0
    assert minute.used("a") == 0.0


def test_clients_that_left_are_forgotten():
    """The memory of many clients is bounded."""
    time = 0.0
    minute = LastMinute(lambda: time)
    for n in range(5000):
        time = n * 0.1
        minute.add(str(n), 1.0)
    assert len(minute._uses) <= 1001
