"""Read plants that the command line names: for itself, and beside an experiment; never for a request."""

from dataclasses import replace
from pathlib import Path, PurePosixPath

from thetascope import library
from thetascope.messages import Message
from thetascope.runs.specs.refusals import validated
from thetascope.runs.specs.spec_files import Document, DocumentError, read
from thetascope_schemas.experiment.experiment import names_a_file
from thetascope_schemas.experiment.plant import Plant


def plant_named(target: str, limit: int) -> Plant:
    """Return a plant of the library by its id, or of a file of at most `limit` bytes. Raises DocumentError, Unknown."""
    path = Path(target)
    if not path.suffix and not path.exists():
        return library.plant(target)
    return validated(Plant, read(path, limit).data)


def read_experiment(path: Path, limit: int) -> Document:
    """Return an experiment file with its plant in full. Files have at most `limit` bytes. Raises DocumentError."""
    document = read(path, limit)
    data = document.data
    if not isinstance(data, dict) or not isinstance(data.get("plant"), str) or not names_a_file(data["plant"]):
        return document
    try:
        plant = read(_beside(path, data["plant"]), limit)
    except DocumentError as error:
        if error.place is not None:
            raise  # the plant's file can be read, but not as data
        raise DocumentError(error.problem, document.place("plant"), str(path), error.remedy) from None
    return replace(document, data=data | {"plant": plant.data}, parts={"plant": plant})


def _beside(experiment: Path, name: str) -> Path:
    """Return the path of a file in the folder of an experiment, or below it."""
    folder = experiment.parent.resolve()
    relative = PurePosixPath(name.replace("\\", "/"))
    found = (folder / relative).resolve()
    if relative.is_absolute() or ":" in name or not found.is_relative_to(folder):
        raise DocumentError(Message("document.plant-outside", name=name[:200], folder=str(experiment.parent)))
    return experiment.parent / relative
