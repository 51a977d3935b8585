"""Columns become quantities of a plant: units, names, times; every guess has its reason and can be changed."""

import numpy as np
import pytest

from tests.records.tank import Q, T, Y, inspected, plant, rows, text
from thetascope import library
from thetascope.engine.errors import SpecError
from thetascope.records.columns.mapping import Mapping, mapping_of, quantities_of
from thetascope.records.columns.names import split_unit
from thetascope.records.columns.times import unit_of_time
from thetascope.records.columns.units import choices, conversion, scale_of
from thetascope.records.document import mapping_document
from thetascope.records.table import number_column
from thetascope.records.text.csv_table import table_of_text
from thetascope_schemas.experiment.measurement import ColumnMapping

CONVERSIONS = [
    ("m", "cm", 100, 0),
    ("in", "cm", 2.54, 0),
    ("°F", "°C", 5 / 9, -160 / 9),
    ("K", "°C", 1, -273.15),
    ("C", "K", 1, 273.15),
    ("摄氏度", "°C", 1, 0),
    ("degC", "°F", 1.8, 32),
    ("bar", "Pa", 1e5, 0),
    ("psi", "kPa", 6.894757293168361, 0),
    ("mmHg", "Pa", 133.322387415, 0),
    ("L/min", "cm³/s", 1000 / 60, 0),
    ("m3/h", "L/s", 1000 / 3600, 0),
    ("gpm", "L/min", 3.785411784, 0),
    ("升/分", "cm^3/s", 1000 / 60, 0),
    ("rpm", "rad/s", 2 * np.pi / 60, 0),
    ("U/min", "rad/s", 2 * np.pi / 60, 0),
    ("%", "", 0.01, 0),
    ("", "%", 100, 0),
    ("mA", "A", 1e-3, 0),
    ("Nm", "N m", 1, 0),
    ("1/h", "1/s", 1 / 3600, 0),
    ("km/h", "m/s", 1 / 3.6, 0),
    ("N m s/rad", "N*m*s", 1, 0),
    ("W/(m^2 K)", "W/m2/K", 1, 0),
    ("cm³/(V s)", "cm3/V/s", 1, 0),
    ("g/L", "kg/m³", 1, 0),
    ("µs", "s", 1e-6, 0),
]


@pytest.mark.parametrize(("source", "target", "factor", "offset"), CONVERSIONS)
def test_units_are_converted(source, target, factor, offset):
    """Factors and offsets are those of the definitions of the units; the way back is the inverse."""
    pair = conversion(source, target)
    assert pair == (pytest.approx(factor, rel=1e-12), pytest.approx(offset, rel=1e-12))
    back = conversion(target, source)
    assert (
        back is not None
        and back[0] * pair[0] == pytest.approx(1)
        and back[0] * pair[1] + back[1] == pytest.approx(0, abs=1e-9)
    )


@pytest.mark.parametrize(
    ("source", "target"),
    [
        ("V", "A"),
        ("cm", "cm²"),
        ("°C", "bar"),
        ("", "V"),
        ("foo", "m"),
        ("10**10**10", "m"),
        ("m^999", "m"),
        ("(" * 30, "m"),
    ],
)
def test_other_dimensions_are_not_converted(source, target):
    """Nor are texts that are no units; nothing is evaluated."""
    assert conversion(source, target) is None


def test_every_unit_of_the_library_is_known_and_can_be_chosen():
    """Plants of the library use units that can be converted, with themselves first among the choices."""
    for model in library.plants().values():
        for quantity in quantities_of(model):
            assert scale_of(quantity.unit, temperature=True) is not None, quantity.unit
            assert choices(quantity.unit)[0] == quantity.unit


@pytest.mark.parametrize(
    ("head", "name", "unit"),
    [
        ("Level 1 (cm)", "Level 1", "cm"),
        ("y [m]", "y", "m"),
        ("Temp °C", "Temp", "°C"),
        ("Temp C", "Temp C", ""),
        ("Druck, bar", "Druck", "bar"),
        ("t / s", "t", "s"),
        ("h in cm", "h", "cm"),
        ("level_cm", "level", "cm"),
        ("y_speed", "y_speed", ""),
        ("Flow A", "Flow A", ""),
        ("Level (tank 1)", "Level (tank 1)", ""),
        ("液位（cm）", "液位", "cm"),
        ("Time (UTC)", "Time", "UTC"),
        ("q [cm^3/(s)]", "q", "cm^3/(s)"),
        ("(cm)", "(cm)", ""),
        ("", "", ""),
    ],
)
def test_a_unit_is_separated_from_a_name(head, name, unit):
    """Brackets, commas, slashes, endings; a word that could be a name is left in it."""
    assert split_unit(head) == (name, unit)


def mapped(plant_id: str, head: str) -> Mapping:
    """Return the mapping of a table whose columns all move."""
    lines = [",".join(f"{k + 0.1 * i * np.sin(k + i):.4f}" for i in range(len(head.split(",")))) for k in range(30)]
    return mapping_of(table_of_text("\n".join([head, *lines])), quantities_of(library.plant(plant_id)), ColumnMapping())


@pytest.mark.parametrize(
    ("plant_id", "head", "columns"),
    [
        ("dts200", "t,Q1,Q2,y1,y2,y3", "Q1 Q2 y1 y2 y3"),
        ("dts200", "time,u.Q1,u.Q2,y.y1,y.y2,y.y3,x.x1,theta.leak1", "u.Q1 u.Q2 y.y1 y.y2 y.y3"),
        ("dts200", "TIME,q1,q2,Y1,Y2,Y3", "q1 q2 Y1 Y2 Y3"),
        ("dts200", "t,pump 2,pump 1,level 3,level 2,level 1", "pump 1|pump 2|level 1|level 2|level 3"),
        (
            "dts200",
            "时间,2号泵流量,1号泵流量,3号罐液位,1号罐液位,2号罐液位",
            "1号泵流量|2号泵流量|1号罐液位|2号罐液位|3号罐液位",
        ),
        (
            "dts200",
            "t,F1 (L/min),F2 (L/min),L1 (cm),L2 (cm),L3 (cm),SP1 (cm)",
            "F1 (L/min)|F2 (L/min)|L1 (cm)|L2 (cm)|L3 (cm)",
        ),
        ("dts200", "t,SP1,Q1,Q2,level 1,level 2,level 3,level 1 setpoint", "Q1|Q2|level 1|level 2|level 3"),
        ("friction-motor", "t,torque,y_speed,y_acceleration", "torque y_speed y_acceleration"),
        ("friction-motor", "t,M (N m),n (rad/s),a (rad/s^2)", "M (N m)|n (rad/s)|a (rad/s^2)"),
        ("friction-motor", "t,Torque,Speed,Acceleration", "Torque Speed Acceleration"),
    ],
)
def test_columns_find_their_quantities(plant_id, head, columns):
    """By name in any case, with prefixes, by words of the description, by unit and number; never by a set point."""
    found = mapped(plant_id, head)
    assert [t.column for t in found.taken if t.quantity.role != "signal"] == columns.split(
        "|" if "|" in columns else " "
    )
    assert all(t.certain for t in found.taken if t.quantity.role != "signal")


def test_a_column_of_another_kind_is_not_taken_for_a_missing_input():
    """A temperature is no flow, though it is the only column left."""
    found = inspected(text([[t, y, 20 + t / 7] for t, _, y in rows()], "t,y,temperature"))
    assert [t.column for t in found.mapping.taken] == [None, "y"]
    assert next(f.kind for f in found.findings) == "no-input"


def test_a_guess_by_the_last_column_or_by_order_is_marked():
    """It gives its reason and has to be looked at."""
    only = inspected(text([[t, q, y] for t, q, y in rows()], "t,q,Stand"))
    assert [(t.column, t.certain, t.reason.code) for t in only.mapping.taken] == [
        ("q", True, "record.reason.same-name"),
        ("Stand", False, "record.reason.only-one"),
    ]
    order = inspected(text(rows(), "t,Zulauf,Stand"))
    assert {t.reason.code for t in order.mapping.taken} == {"record.reason.order"}


def test_the_mapping_of_an_inspection_gives_the_same_recording():
    """It is complete: sent back, or changed in one entry only, it does what it says."""
    found = inspected(text([[t / 60, q * 0.06, y / 100] for t, q, y in rows()], "time [min],F (L/min),Level (m)"))
    document = mapping_document(found)
    again = inspected(
        text([[t / 60, q * 0.06, y / 100] for t, q, y in rows()], "time [min],F (L/min),Level (m)"),
        mapping=document.model_dump(),
    )
    assert mapping_document(again) == document
    assert np.array_equal(again.recording.t, found.recording.t) and np.array_equal(again.recording.y, found.recording.y)


def test_a_mapping_can_be_changed():
    """Columns, units, factors and the time; a quantity can be set to have no column."""
    data = text([[t, q, y, 2 * y] for t, q, y in rows()], "a,b,c,d")
    asked = {
        "time": {"column": "a", "unit": "ms"},
        "quantities": {"q": {"column": "b"}, "y": {"column": "d", "factor": 0.5}},
    }
    found = inspected(data, mapping=asked)
    assert found.recording.t == pytest.approx(T / 1000) and found.recording.y[:, 0] == pytest.approx(Y)
    metres = inspected(data, mapping=asked | {"quantities": {"q": {}, "y": {"column": "c", "unit": "m"}}})
    assert metres.recording.y[:, 0] == pytest.approx(100 * Y) and metres.recording.held.all()
    assert inspected(data, mapping=asked | {"time": {"period": 2.0}}).recording.t == pytest.approx(2 * T)


@pytest.mark.parametrize(
    "mapping",
    [
        {"quantities": {"h": {"column": "q"}}},
        {"quantities": {"q": {"column": "Q"}}},
        {"quantities": {"q": {"column": "q", "unit": "bar"}}},
        {"time": {"column": "T"}},
    ],
)
def test_a_wrong_mapping_is_refused_by_its_field(mapping):
    """The field is that of the request."""
    with pytest.raises(SpecError) as refusal:
        inspected(text(rows()), mapping=mapping)
    assert refusal.value.field.startswith("mapping.")


def test_times_that_are_dates_have_a_beginning():
    """The date of the first row in time, in UTC, however the rows are ordered."""
    data = text([[f"2024-03-01T08:{t // 60:02d}:{t % 60:02d}+02:00", q, y] for t, q, y in rows()])
    found = inspected(data)
    assert found.begin == "2024-03-01T06:00:00.000Z" and np.array_equal(found.recording.u[:, 0], Q)
    assert found.recording.t[-1] - found.recording.t[0] == len(rows()) - 1


@pytest.mark.parametrize(
    ("times", "unit"),
    [
        (0.1 * np.arange(1_000_000), "s"),
        (np.arange(0, 4e9, 1e7), "s"),
        (1.7e9 + np.arange(50), "epoch-s"),
        (1.7e12 + np.arange(50), "epoch-ms"),
        (1.7e15 + np.arange(50), "epoch-us"),
        (45000 + np.arange(500) / 86400, "spreadsheet-days"),
        (45000 + np.arange(500), "s"),
        (np.where(np.arange(50) == 20, -9999, 1.7e12 + np.arange(50)), "epoch-ms"),
    ],
)
def test_numbers_are_dates_only_if_all_of_them_are(times, unit):
    """Seconds from zero on that pass through the numbers of dates stay seconds; a stray time changes nothing."""
    assert unit_of_time(number_column("t", times))[0] == unit


def test_an_index_is_no_time():
    """A column that counts rows beside no other time needs a period."""
    found = inspected(text([[k, q, y] for k, (_, q, y) in enumerate(rows())], "index,q,y"))
    assert found.mapping.time.column is None and found.problem.code == "record.problem.no-time"
    assert plant().names("inputs") == ("q",)
