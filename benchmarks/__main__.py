"""Measure the engine and the service, or the named benchmarks: ``python -m benchmarks [NAME …] [--markdown]``."""

import argparse
import importlib

ENGINE = ("kernels", "others", "compilation", "service")  # the benchmarks that run by default
NAMES = (*ENGINE, "live", "processes", "memory", "page", "guarded", "classroom", "studies")


def main() -> None:
    """Run the benchmarks that the command line names, and print their figures."""
    arguments = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    arguments.add_argument(
        "names", nargs="*", metavar="NAME", help=f"of {', '.join(NAMES)}; the first four if none is given"
    )
    arguments.add_argument("--markdown", action="store_true", help="print the table of docs/performance.md")
    given = arguments.parse_args()
    unknown = [n for n in given.names if n not in NAMES]
    if unknown:
        arguments.error(f"no benchmark is called {', '.join(unknown)}: choose from {', '.join(NAMES)}")
    if given.markdown:
        print("| Benchmark | Median | Range | Target |\n|---|---|---|---|", flush=True)
    for name in given.names or ENGINE:
        for figure in importlib.import_module(f"benchmarks.{name}").figures():
            print(figure.markdown() if given.markdown else figure.text(), flush=True)


if __name__ == "__main__":
    main()
