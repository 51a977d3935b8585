"""The defect of steps that were taken: a cheap estimate of their local error, from the states at both ends alone.

Simpson's rule with the middle of the cubic through both ends (Lobatto IIIA) is of order 4 like the steps themselves;
what separates a step from it is as large as the local error of the step. It takes three evaluations of f per step.
"""

from dataclasses import replace
from functools import lru_cache

from thetascope.engine.compiler.graph import Graph, variables
from thetascope.engine.compiler.system import DISCRETE, Program

PLACES = {"": 0.0, "mid.": 0.5, "end.": 1.0}  # prefix of an input's name → where in the step it is read


@lru_cache(maxsize=64)
def defect_program(program: Program, varying: tuple[str, ...]) -> Program:
    """Return a program whose outputs defect.0, defect.1, … are the defects of the states over one step.

    Its inputs are those of the program, the states at the beginning as ``from.<state>`` and at the end as
    ``to.<state>``, and the width of the step ``h``. Inputs named in ``varying`` are also read in the middle and at the
    end, as ``mid.<input>`` and ``end.<input>``.
    """
    graph = Graph()
    h = graph.var("h")
    begin, end = ([graph.var(f"{side}.{s}") for s in program.states] for side in ("from", "to"))

    def slopes(prefix: str, states: list[int]) -> list[int]:
        places = {n: graph.var(f"{prefix}{n}") for n in varying} if prefix else {}
        time = graph.add(graph.var("t"), graph.mul(graph.const(PLACES[prefix]), h))
        moved = graph.absorb(
            program.graph, program.update, places | dict(zip(program.states, states, strict=True)) | {"t": time}
        )
        return [moved[u] for u in program.update]

    first, last = slopes("", begin), slopes("end.", end)
    middle = [
        graph.add(
            graph.mul(graph.const(0.5), graph.add(a, b)),
            graph.mul(graph.mul(graph.const(0.125), h), graph.sub(f, g)),
        )
        for a, b, f, g in zip(begin, end, first, last, strict=True)
    ]
    inner = slopes("mid.", middle)
    outputs = {}
    for i, (a, b, f, g, m) in enumerate(zip(begin, end, first, last, inner, strict=True)):
        total = graph.add(graph.add(f, g), graph.mul(graph.const(4.0), m))
        rule = graph.mul(graph.mul(h, graph.const(1 / 6)), total)
        outputs[f"defect.{i}"] = graph.sub(graph.sub(b, a), rule)
    known = {*program.parameters, "t"}
    inputs = tuple(sorted(variables(graph, list(outputs.values())) - known))
    return replace(program, time=DISCRETE, states=(), inputs=inputs, graph=graph, update=(), outputs=outputs, after=())
