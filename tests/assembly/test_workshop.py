"""Facts about a plant for the workshop: experiment, preview, faults that can be told apart, observers that suit it."""

import math

import numpy as np
import pytest

from tests.runs.plants.test_text_check import TEXT
from thetascope import library
from thetascope.assembly.workshop.fault_patterns import fault_patterns
from thetascope.assembly.workshop.preview import ENOUGH, preview, separation
from thetascope.assembly.workshop.ranking import ranked_observers
from thetascope.assembly.workshop.trial_experiment import nice, trial_experiment
from thetascope.runs.plants.plant_text import plant_data, yaml_text
from thetascope.runs.plants.text_check import check_text
from thetascope.runs.plants.text_edit import edited
from thetascope.runs.specs.refusals import validated
from thetascope.runs.specs.spec_files import parse
from thetascope_schemas.experiment.plant import Plant

LAG = """id: lag
states: [{name: x, initial: 1}]
inputs: [{name: u, default: 1}]
outputs: [{name: y, expression: x}]
parameters: [{name: T, value: 5}]
dynamics: {x: (u - x)/T}
channels:
  - {name: bias, kind: sensor, enters: {y: 1}, typical: 0.01}
  - {name: loss, kind: actuator, enters: {x: -u/T}, typical: 0.1}
"""


def plant(text: str) -> Plant:
    return validated(Plant, parse(text).data)


@pytest.mark.parametrize("id", sorted(library.plants()))
def test_every_library_plant_has_an_experiment_that_shows_it(id):
    """It lasts several time constants in at most 40 000 steps, and all outputs have noise and finite values."""
    spec = trial_experiment(library.plant(id))
    assert 100 <= round(spec.horizon / spec.step) <= 40_000
    assert all(spec.noise[name].std > 0 for name in spec.plant.names("outputs"))
    shown = preview(spec)
    assert len(shown.t) > 100 and all(len(values) == len(shown.t) for values in shown.outputs.values())
    assert len(shown.seconds) == min(12, len(spec.plant.channels))


def test_the_time_scale_is_that_of_the_plant():
    """A lag of 5 s is shown for about twelve time constants, one of 5 ms a thousand times shorter."""
    slow, fast = (trial_experiment(plant(LAG.replace("value: 5", f"value: {T}"))).horizon for T in (5, 0.005))
    assert 30 <= slow <= 120 and slow == pytest.approx(1000 * fast)


def test_a_preview_is_the_response_of_the_plant():
    """The output of a lag after a step of its fault is the exponential, in the units of the plant."""
    spec = trial_experiment(plant(LAG), {"inputs": {"u": {"kind": "constant", "value": 1}}})
    shown = preview(spec)
    t = np.array(shown.t)
    expected = np.where(t > shown.onset, 1 - 0.1 * (1 - np.exp(-(t - shown.onset) / 5)), 1)
    assert np.allclose(shown.faulty["loss"]["y"], expected, atol=1e-6)
    assert np.allclose(np.array(shown.faulty["bias"]["y"]) - shown.outputs["y"], 0.01 * (t >= shown.onset))


def test_the_time_until_a_bias_is_found_is_that_of_the_sum():
    """A constant change of d standard deviations is found after the sample at which n·d² reaches 36."""
    for d in (0.5, 1.3, 7.0):
        n = math.ceil(ENOUGH / d**2)
        table = separation([np.full((2000, 1), d)], np.arange(2000.0))
        assert table == [[n - 1]]


def test_faults_with_proportional_effects_are_never_told_apart():
    """What one fault does, the other explains with another size; orthogonal effects are told apart as from none."""
    wave = np.sin(np.arange(500.0))[:, None]
    table = separation([wave, 3 * wave], np.arange(500.0))
    assert table[0][1] is None and table[1][0] is None and table[0][0] is not None
    one, other = np.hstack([wave, 0 * wave]), np.hstack([0 * wave, wave])
    table = separation([one, other], np.arange(500.0))
    assert table[0][1] == table[0][0] and table[1][0] == table[1][1]


def test_observers_are_ranked_by_their_error_and_the_rest_have_reasons():
    """The best estimates the faults of the two tanks; observers that do not suit the plant are last, and say why."""
    two = plant(TEXT)
    ranked = ranked_observers(two, trial_experiment(two, None, faults=True))
    possible = [one for one in ranked if one.possible]
    assert possible[0].error < 0.5 and ranked[: len(possible)] == possible
    assert all(one.why.text("zh") and one.why.text("en") for one in ranked)
    assert len(ranked) - len(possible) >= 4


@pytest.mark.parametrize("id", ["dc-motor", "level-loop", "shen-hu-2015"])
def test_every_suggested_fault_makes_a_valid_plant(id):
    """Each pattern of each equation can be added to the text of the plant, and to that of its copy as JSON."""
    text = yaml_text(plant_data(library.plant(id), "en"))
    chosen = library.plant(id)
    for name in (*chosen.names("states"), *chosen.names("outputs")):
        patterns = fault_patterns(chosen, name)
        assert {"bias", "gain"} <= {pattern.pattern for pattern in patterns}
        for pattern in patterns[:4]:
            items = {"states": pattern.states, "parameters": pattern.parameters, "channels": [pattern.channel]}
            answer = check_text(edited(text, {}, items, pattern.equations).text, "en")
            assert answer.errors == (), (name, pattern.pattern, answer.errors[0].problem)


def test_a_lost_flow_is_conserved_between_tanks():
    """The share of the flow between two tanks that is lost in one stays in the other; a leak leaves the first alone."""
    loss = next(p for p in fault_patterns(plant(TEXT), "h2") if (p.pattern, p.term) == ("loss", "q12"))
    assert loss.channel["enters"] == {"h2": "-q12/A"} and loss.conserved == {"h1": "q12/A"}
    leak = next(p for p in fault_patterns(plant(TEXT), "h1") if p.pattern == "leak")
    assert leak.channel["enters"] == {"h1": "-sqrt(2*g*max(h1, 0))*(1/A)"} and leak.conserved == {}


def test_values_are_rounded_to_what_people_write():
    """1, 2 or 5 times a power of ten, the nearest one."""
    assert [nice(value) for value in (0.00013, 3.4, 70, 96)] == [0.0001, 5, 50, 100]
    assert nice(0) == nice(math.inf) == 1
