"""The equations of a plant as LLVM functions that the loops of this folder call at one point.

``rates(t, x, u, theta, par, f, A, B)`` writes ẋ (or the next state in discrete time), ∂f/∂x (n × n) and ∂f/∂d (n × d);
``readings(t, x, u, theta, par, h, C, D)`` writes y and the same derivatives (m × n, m × d). The directions d are faults
or parameters by name: a parameter that is fitted responds as a fault does.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from thetascope.engine.compiler.autodiff import derivatives
from thetascope.engine.compiler.codegen import Layout, Module
from thetascope.engine.compiler.graph import Graph, topological
from thetascope.engine.compiler.ir_builder import Writer
from thetascope.engine.compiler.system import Program
from thetascope.engine.loops.declaration import External

_ARGUMENTS = ("x", "u", "theta", "par")


@dataclass(frozen=True)
class PlantFunctions:
    """The functions of one plant, for derivatives with respect to states and `directions`.

    Attributes:
        plant: the program.
        directions: names of faults (``theta.*``) or parameters.
        inputs: inputs and known signals in the plant's order, without faults.
        faults: ``theta.*``.
    """

    plant: Program
    directions: tuple[str, ...]

    @property
    def inputs(self) -> tuple[str, ...]:
        """Return the inputs and known signals."""
        return tuple(i for i in self.plant.inputs if not i.startswith("theta."))

    @property
    def faults(self) -> tuple[str, ...]:
        """Return the fault channels."""
        return tuple(i for i in self.plant.inputs if i.startswith("theta."))

    def externals(self) -> dict[str, External]:
        """Return the functions as the loops call them."""
        return {name: External(name, numbers=1, pointers=7) for name in ("rates", "readings")}

    def text(self) -> list[str]:
        """Return the IR lines of both functions, and of the tables and solvers that they use."""
        module = Module(self.plant, Layout())
        lines = self._function(module, "rates", self.plant.update)
        lines += self._function(module, "readings", list(self.plant.outputs.values()))
        solvers = [line for written in module.solvers.values() for line in written]
        return [*module.tables.values(), *solvers, *lines]

    def _function(self, module: Module, name: str, roots: Sequence[int]) -> list[str]:
        """Return the lines of one function."""
        plant = self.plant
        graph = Graph(plant.graph.nodes)
        variables = (*plant.states, *self.directions)
        slopes = derivatives(graph, roots, variables)
        zero = graph.const(0.0)
        wanted = [*roots, *(slope.get(v, zero) for v in variables for slope in slopes)]
        w = Writer(1, module.tables)
        leaves = {"t": "%t"}
        used = {graph.nodes[i][1] for i in topological(graph, wanted) if graph.nodes[i][0] == "var"}
        groups = (plant.states, self.inputs, self.faults, plant.parameters)
        for base, names in zip(_ARGUMENTS, groups, strict=True):
            leaves |= {v: w.load_shared(f"%{base}", i) for i, v in enumerate(names) if v in used}
        values = module.nodes(w, leaves, {}, {}, topological(graph, wanted), wanted, graph)
        count, n, d = len(roots), len(plant.states), len(self.directions)
        for i, value in enumerate(values[:count]):
            w.store(value, "%value", i)
        for c in range(n + d):
            base, column, width = ("%A", c, n) if c < n else ("%B", c - n, d)
            for i in range(count):
                w.store(values[count * (1 + c) + i], base, i * width + column)
        args = ", ".join(f"ptr noalias %{a}" for a in (*_ARGUMENTS, "value", "A", "B"))
        return [f"define internal void @{name}(double %t, {args}) #2 {{", "entry:", *w.lines, "  ret void", "}"]
