"""Faults: the site of each kind."""

import pytest
from pydantic import TypeAdapter

from thetascope_schemas.experiment.faults import ChannelFault, Fault, MeasurementFault, Site

KINDS = [*ChannelFault.__subclasses__(), *MeasurementFault.__subclasses__()]


@pytest.mark.parametrize("kind", KINDS)
def test_every_fault_has_a_site(kind):
    """The site is the channel or the output that the fault's JSON names, and the JSON does not repeat it."""
    example = kind.model_config["json_schema_extra"]["examples"][0]
    fault = TypeAdapter(Fault).validate_python(example)
    assert type(fault) is kind
    place = "channel" if "channel" in example else "output"
    assert fault.site == (place, example[place])
    assert fault.site.prefix == {"channel": "theta", "output": "y"}[place]
    assert "site" not in fault.model_dump()


def test_sites_of_one_name_differ_by_kind():
    """A channel and an output may share a name; their faults have different sites."""
    assert Site("channel", "y") != Site("output", "y")
