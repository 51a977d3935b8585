"""The healthy stretch of a record: as given, or the longest beginning that shows no fault by itself."""

from dataclasses import dataclass

import numpy as np

from thetascope.diagnosis.records import noise_fit
from thetascope.diagnosis.records.model import RecordModel
from thetascope.diagnosis.records.noise_fit import NoiseFit, Start
from thetascope.engine.filtering.bundles import Rows
from thetascope.engine.filtering.record_filter import part_of

FEWEST = 50  # rows
_FIRST = 100  # rows of the first stretch that is tried,
_SHARE = 0.05  # or this share of the record,
_LAST = 300  # but no more rows than this
_GROWTH = 1.3
_MOST = 4000  # rows: a longer stretch tells little more about the noise
_LARGE = 32.0  # statistic of the bank
_FAR = 6.0  # standard deviations of an innovation


@dataclass(frozen=True)
class BankMaximum:
    """The largest statistic of the onset bank along rows, and its row."""

    statistic: float
    row: int


def bank_maximum(model: RecordModel, data: Rows, fitted: NoiseFit) -> BankMaximum:
    """Return the largest statistic of the onset bank along filtered rows."""
    filter_, path = model.filter, fitted.result.path
    if filter_.d == 0:
        return BankMaximum(0.0, 0)
    alarms = filter_.scan(
        data,
        fitted.noise,
        path,
        filter_.new_bank(1, fitted.coloured),
        0,
        float(np.median(data.width)),
        np.ones(2 * filter_.d),
        np.nan_to_num(path.nu)[None],
    )
    g = alarms.largest[:, 0]
    return BankMaximum(float(g.max()), int(g.argmax()))


def found_stretch(model: RecordModel, data: Rows, start: Start, resolution: np.ndarray) -> int:
    """Return the number of rows of the longest beginning that shows no fault by its own noise.

    It grows by three tenths while neither the onset bank nor a single innovation stands out. Where the first rows
    already show a fault, they are returned: the check of the fit then says so.
    """
    total = len(data.t)
    rows = best = min(total, max(_FIRST, min(int(_SHARE * total), _LAST)))
    fitted = None
    while True:
        part = part_of(data, 0, rows)
        fitted = noise_fit.fit(model.filter, part, start, model.scales, model.measured, resolution, before=fitted)
        far = np.nanmax(np.abs(fitted.result.path.nu), initial=0.0)
        if far > _FAR or bank_maximum(model, part, fitted).statistic > _LARGE:
            return best
        best = rows
        if rows >= min(total, _MOST):
            return rows
        rows = min(total, _MOST, int(rows * _GROWTH) + 1)
