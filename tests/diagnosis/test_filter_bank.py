"""The detector's filter, its backward pass and its hypotheses, each against separate runs of the filter."""

import numpy as np
import pytest

from tests.diagnosis.watching import watching
from thetascope.diagnosis.isolation.decision_state import Event
from thetascope.diagnosis.residuals.filter_bank import HypothesisCourses

SETTLED = 150  # decisions
PLANTS = ["zhao-2012", "dc-motor", "quadruple-tank", "dts200"]


class Rows:
    """Rows of a plant after the filter has settled, and the filter along them under one hypothesis."""

    def __init__(self, name: str, decisions: int = 120):
        made = watching(name).made
        self.filter, self.stride, self.bank, self.backward_pass = (
            made.filter,
            made.stride,
            made.bank,
            made.backward_pass,
        )
        table, t = watching(name).rows()
        rows, self.p, self.m = decisions * self.stride, self.filter.p, self.filter.m
        before, here = slice(0, SETTLED * self.stride), slice(SETTLED * self.stride, SETTLED * self.stride + rows)
        settled = self.filter.run(self.filter.start(), np.zeros(self.p), table[before], t[before]).states[-1]
        self.begin = self.filter.without_sensitivity(settled)
        self.table, self.t, self.d = table[here], t[here], np.arange(rows) / self.stride

    def run(
        self,
        onset: int,
        events: list[Event] | None = None,
        course: Event | None = None,
        known: np.ndarray | None = None,
    ):
        """Return J, s, the energy by output and the last state from ``onset`` on; Ω is for the events, or one course
        per channel."""
        given = (
            np.zeros((len(self.d), self.p)) if known is None else np.broadcast_to(known, (len(self.d), self.p)).copy()
        )
        profile = np.repeat(((course or Event(0, onset)).course(self.d))[:, None], self.p, axis=1)
        for e in events or []:
            given[:, e.channel] += e.size * e.course(self.d)
            profile[:, e.channel] = e.course(self.d)
        seen = self.filter.run(self.begin, given, self.table, self.t, profile)
        late = self.d >= onset
        omega, nu = seen.omega[late].reshape(-1, self.p), seen.nu[late]
        return omega.T @ omega, omega.T @ nu.ravel(), (nu**2).sum(axis=0), seen


@pytest.fixture(scope="module", params=PLANTS)
def rows(request) -> Rows:
    return Rows(request.param)


def close(a: np.ndarray, b: np.ndarray, rel: float = 1e-9) -> None:
    np.testing.assert_allclose(a, b, rtol=rel, atol=rel * np.abs(b).max())


def test_omega_is_the_derivative_of_the_innovations(rows):
    """Ω of each channel equals difference quotients of ν in θ₀ to a hundredth (gains are not differentiated)."""
    plain = rows.run(0)[3]
    for j, channel in enumerate(rows.filter.context.model["channels"]):
        h = 1e-4 * (channel.get("typical") or 1.0)
        moved = rows.filter.run(rows.begin, np.eye(rows.p)[j] * h, rows.table, rows.t).nu
        omega = plain.omega[:, :, j]
        assert np.abs((plain.nu - moved) / h - omega).max() < 0.01 * np.abs(omega).max()


def test_backward_information_equals_that_of_filters_from_each_onset(rows):
    """J and s of steps and ramps from four onsets, in one backward pass and by separate runs of the filter."""
    trusted_outputs, known = np.ones(rows.m), np.zeros((len(rows.d), rows.p))
    handed = rows.backward_pass.backward_inputs(
        rows.begin, rows.filter.held(known, rows.table), rows.t, trusted_outputs
    )
    ahead = rows.backward_pass.future_information(handed, trusted_outputs, rows.stride)
    tau = 17.0
    bent = rows.backward_pass.exponential_rises(handed, trusted_outputs, rows.stride, tau)
    for onset in (0, 1, 40, 110):
        J, s, *_ = rows.run(onset, course=Event(0, onset))
        close(ahead.ww[onset], J)
        close(ahead.w[onset], s)
        J, s, *_ = rows.run(onset, course=Event(0, onset, np.inf))
        close(ahead.rr[onset], np.diag(J))
        close(ahead.r[onset], s)
        J, s, *_ = rows.run(onset, course=Event(0, onset, tau, exponential=True))
        close(bent[0][onset], np.diag(J))
        close(bent[1][onset], s)


def test_a_ramp_continues_after_its_end(rows):
    """The part after the end of a ramp, from V and the course there, equals the filter along all of it."""
    begin, end = 20, 60
    handed = rows.backward_pass.backward_inputs(
        rows.begin, rows.filter.held(np.zeros((len(rows.d), rows.p)), rows.table), rows.t, np.ones(rows.m)
    )
    ahead = rows.backward_pass.future_information(handed, np.ones(rows.m), rows.stride)
    seen = rows.run(begin, course=Event(0, begin, float(end - begin)))[3]
    V = rows.filter.sensitivity(seen.states[end * rows.stride - 1])
    D, s = ahead.after(np.array([end]), V[None], np.ones((1, rows.p)))
    late = rows.d >= end
    omega, nu = seen.omega[late].reshape(-1, rows.p), seen.nu[late].ravel()
    close(D[0], (omega**2).sum(axis=0))
    close(s[0], omega.T @ nu)


def test_hypotheses_equal_runs_of_the_filter(rows):
    """Nine hypotheses of all shapes in SIMD lanes have the sums and states of separate runs."""
    typical = [0.05 * (c.get("typical") or 1.0) for c in rows.filter.context.model["channels"]]
    shapes = [{}, {"rise_time": np.inf}, {"rise_time": 25.0}, {"rise_time": 9.0, "exponential": True}]
    events = [
        Event(k % rows.p, 10.0 + 7 * k, size=typical[k % rows.p] / (20 if k % 4 == 1 else 1), **shapes[k % 4])
        for k in range(9)
    ]
    numbers = np.empty((9, rows.p, 7))
    for k, e in enumerate(events):
        numbers[k] = [e.onset, *Event(0, 0).course_parameters, 0.0]
        numbers[k, e.channel] = [e.onset, *e.course_parameters, e.size]
    numbers[:, :, 5] = np.exp(-numbers[:, :, 5] / rows.stride)
    onset = np.array([e.onset for e in events])
    courses = HypothesisCourses(numbers, np.full(rows.p, -np.inf), np.full(rows.p, np.inf), onset, onset + 4)
    inputs = rows.bank.row_inputs(np.zeros((len(rows.d), rows.p)), rows.table, rows.d)
    found = rows.bank.run(
        np.repeat(rows.begin[None], 9, axis=0), inputs, rows.t, courses, np.ones(rows.m), np.array([len(rows.d)])
    )
    for k, e in enumerate(events):
        J, s, q, seen = rows.run(int(e.onset), [e])
        close(found.J[k, -1], J)
        close(found.s[k, -1], s)
        close(found.q[k, -1], q)
        close(found.states[k, -1], seen.states[-1])
        early = (rows.d >= e.onset) & (rows.d < e.onset + 4)
        close(found.early[k, -1], (seen.omega[early] ** 2).sum(axis=(0, 1)))


def test_the_innovations_of_a_healthy_plant_are_white_and_of_variance_one():
    """Mean, variance and correlation of ν on Zhao's plant without faults are those of white noise."""
    seen = watching("zhao-2012")
    table, t = seen.rows(3, faults=False)
    nu = seen.made.filter.run(seen.made.filter.start(), np.zeros(seen.made.filter.p), table, t).nu[1000:, 0]
    spread = 4 / np.sqrt(len(nu))
    assert abs(nu.mean()) < spread and abs(nu.var() - 1) < 2 * spread
    assert all(abs(np.corrcoef(nu[:-k], nu[k:])[0, 1]) < spread for k in (1, 2, 10))
