"""A bank of onsets: which step or ramp of which fault, since when, explains the innovations best. Loops over rows.

For every watched onset, U is the response of the filter to a fault of size one from there on, and Ω = HU + J w that of
the innovations (w: 1 for a step, the time since the onset for a ramp; Willsky & Jones, IEEE TAC 21(1), 1976):

    U ← U − KΩ (correction),  U ← FU + G w̄ (prediction),  a = Σ Ων/σ²,  b = Σ Ω²/σ²,  g = a²/b,  θ̂ = a/b.

Without faults g is χ² with one degree of freedom, whatever the trajectory, the loop or the inputs. An onset k₀ of age A
remains watched if k₀ is a multiple of 2^⌊log₂(A/2)⌋: a few dozen onsets for any length of the record.
"""

from math import exp, isnan

import numpy as np

from thetascope.engine.filtering.bundles import Alarms, Bank, Noise, Path, Rows
from thetascope.engine.loops.declaration import Sizes, empty, loops


@loops(omega="2*d")
def respond(size: Sizes, path: Path, bank: Bank, k: int, i: int, s: int, since: float, omega: np.ndarray):
    """Compute Ω/σ of reading i of row k for onset s, and correct U by it."""
    for c in range(size.d):
        omega[c] = path.J[k, i, c]
        omega[size.d + c] = path.J[k, i, c] * since
    for j in range(size.n):
        for c in range(2 * size.d):
            omega[c] += path.H[k, i, j] * bank.U[s, j, c]
    if size.na > size.n:
        for c in range(2 * size.d):
            omega[c] += bank.U[s, size.n + i, c]
    for a in range(size.na):
        for c in range(2 * size.d):
            bank.U[s, a, c] -= path.K[k, i, a] * omega[c]
    for c in range(2 * size.d):
        omega[c] = omega[c] / path.sd[k, i]
        bank.b[s, c] += omega[c] * omega[c]


@loops()
def carry(size: Sizes, noise: Noise, data: Rows, path: Path, bank: Bank, k: int, s: int, tick: float):
    """Carry U of onset s over the interval after row k."""
    V = empty(size.n, 2 * size.d)
    since = (data.t[k] - bank.begun[s] + 0.5 * data.width[k]) / tick
    for i in range(size.n):
        for c in range(size.d):
            V[i, c] = path.G[k, i, c]
            V[i, size.d + c] = path.G[k, i, c] * since
        for j in range(size.n):
            for c in range(2 * size.d):
                V[i, c] += path.F[k, i, j] * bank.U[s, j, c]
    for i in range(size.n):
        for c in range(2 * size.d):
            bank.U[s, i, c] = V[i, c]
    for a in range(size.na - size.n):
        decay = exp(-noise.rate[a] * data.width[k])
        for c in range(2 * size.d):
            bank.U[s, size.n + a, c] = decay * bank.U[s, size.n + a, c]


@loops()
def open_onset(size: Sizes, bank: Bank, replicas: int, slots: int, row: int, t: float):
    """Begin to watch an onset in a free slot."""
    for s in range(slots):
        if bank.onset[s] < 0.0:
            bank.onset[s] = float(row)
            bank.begun[s] = t
            for c in range(2 * size.d):
                bank.b[s, c] = 0.0
                for a in range(size.na):
                    bank.U[s, a, c] = 0.0
                for r in range(replicas):
                    bank.a[s, r, c] = 0.0
            break


@loops()
def watched(onset: int, age: int) -> int:
    """Return 1 if an onset remains watched at an age in rows, else 0."""
    period = 1
    while 4 * period <= age:
        period = 2 * period
    if onset % period == 0:
        return 1
    return 0


@loops(nu="replicas rows m", used="2*d")
def scan(
    size: Sizes,
    rows: int,
    extras: int,
    replicas: int,
    slots: int,
    first: int,
    tick: float,
    noise: Noise,
    data: Rows,
    path: Path,
    nu: np.ndarray,
    used: np.ndarray,
    bank: Bank,
    alarms: Alarms,
):
    """Update the bank along rows, the first of which has the number `first`.

    Args:
        tick: the unit of time in s in which ramps rise by one.
        used: 1 for columns that count, else 0.
    """
    omega = empty(2 * size.d)
    for k in range(rows):
        open_onset(size, bank, replicas, slots, first + k, data.t[k])
        for r in range(replicas):
            alarms.largest[k, r] = 0.0
        alarms.column[k] = -1.0
        for s in range(slots):
            if bank.onset[s] >= 0.0:
                for i in range(size.m):
                    if not isnan(path.sd[k, i]):
                        respond(size, path, bank, k, i, s, (data.t[k] - bank.begun[s]) / tick, omega)
                        for r in range(replicas):
                            for c in range(2 * size.d):
                                bank.a[s, r, c] += omega[c] * nu[r, k, i]
                compare(size, replicas, k, s, used, bank, alarms)
                carry(size, noise, data, path, bank, k, s, tick)
                if watched(int(bank.onset[s]), first + k + 1 - int(bank.onset[s])) == 0:
                    bank.onset[s] = -1.0


@loops(used="2*d")
def compare(size: Sizes, replicas: int, k: int, s: int, used: np.ndarray, bank: Bank, alarms: Alarms):
    """Keep the largest statistic of row k."""
    for r in range(replicas):
        for c in range(2 * size.d):
            if bank.b[s, c] > 1e-12 and used[c] > 0.0:
                g = bank.a[s, r, c] * bank.a[s, r, c] / bank.b[s, c]
                if g > alarms.largest[k, r]:
                    alarms.largest[k, r] = g
                    if r == 0:
                        alarms.onset[k] = bank.onset[s]
                        alarms.column[k] = float(c)
                        alarms.size[k] = bank.a[s, r, c] / bank.b[s, c]


@loops(channel="courses", interval="courses rows", row="courses rows", start="courses na", omega="courses rows m")
def respond_to_courses(
    size: Sizes,
    rows: int,
    extras: int,
    courses: int,
    noise: Noise,
    data: Rows,
    path: Path,
    channel: np.ndarray,
    interval: np.ndarray,
    row: np.ndarray,
    start: np.ndarray,
    omega: np.ndarray,
):
    """Compute the response Ω/σ of the innovations to courses of one direction each, and to changes of the first z."""
    U = empty(size.na)
    V = empty(size.n)
    for x in range(courses):
        c = int(channel[x])
        for a in range(size.na):
            U[a] = start[x, a]
        for k in range(rows):
            for i in range(size.m):
                omega[x, k, i] = 0.0
                if not isnan(path.sd[k, i]):
                    value = path.J[k, i, c] * row[x, k]
                    for j in range(size.n):
                        value += path.H[k, i, j] * U[j]
                    if size.na > size.n:
                        value += U[size.n + i]
                    for a in range(size.na):
                        U[a] -= path.K[k, i, a] * value
                    omega[x, k, i] = value / path.sd[k, i]
            for i in range(size.n):
                V[i] = path.G[k, i, c] * interval[x, k]
                for j in range(size.n):
                    V[i] += path.F[k, i, j] * U[j]
            for i in range(size.n):
                U[i] = V[i]
            for a in range(size.na - size.n):
                U[size.n + a] = exp(-noise.rate[a] * data.width[k]) * U[size.n + a]
