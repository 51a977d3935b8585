"""/api/plants and /api/experiments: the library, and checking a plant."""

from fastapi import APIRouter, Request
from starlette.responses import Response

from thetascope import library
from thetascope.api.http.answers import json_response
from thetascope.api.http.computed import computed
from thetascope.api.http.language import Language, Prose
from thetascope.api.http.problems import documented
from thetascope.api.http.read_body import body_schema, chosen_plant, parsed_as, read_bytes
from thetascope.api.http.services import Use
from thetascope.runs.specs.resolve_spec import library_experiment, plant_of
from thetascope.runs.specs.sent_texts import plant_of_text
from thetascope_schemas.experiment.experiment import Experiment
from thetascope_schemas.experiment.plant import Plant
from thetascope_schemas.service.answers import ExperimentList, PlantCheck, PlantList
from thetascope_schemas.texts.local_text import ALL, in_language

router = APIRouter()

_TEXT = {"requestBody": {"required": True, "content": {"application/yaml": {"schema": {"type": "string"}}}}}


def plant_line(plant: Plant, language: str) -> dict[str, object]:
    """Return an entry of the list of plants, its prose in a language."""
    return {
        "id": plant.id,
        "title": in_language(plant.title, language),
        "description": in_language(plant.description, language),
        "source": in_language(plant.source, language),
        "time": plant.time.kind,
        "states": len(plant.states),
        "outputs": len(plant.outputs),
        "channels": [channel.name for channel in plant.channels],
        "href": f"/api/plants/{plant.id}",
    }


def experiment_line(experiment: Experiment, language: str) -> dict[str, object]:
    """Return an entry of the list of experiments, its prose in a language."""
    return {
        "id": experiment.id,
        "title": in_language(experiment.title, language),
        "description": in_language(experiment.description, language),
        "source": in_language(experiment.source, language),
        "plant": experiment.plant_id,
        "horizon": experiment.horizon,
        "step": experiment.step,
        "observers": [observer.label for observer in experiment.observers],
        "href": f"/api/experiments/{experiment.id}",
    }


@router.get("/plants", response_model=PlantList, tags=["plants"])
def list_plants(language: Language) -> Response:
    """Return the plants of the library."""
    return json_response({"plants": [plant_line(plant, language) for plant in library.plants().values()]})


@router.get("/plants/{id}", response_model=Plant, responses=documented(404, 422), tags=["plants"])
async def get_plant(request: Request, id: str, services: Use, language: Prose) -> Response:
    """Return a plant in full, of the library or a saved one: copy it, change it, and POST it to /api/plants/check.

    Its prose is in one language; `?lang=*` gives it in all languages, as maps.
    """
    plant = plant_of(await chosen_plant(request, services, id))
    return Response(plant.model_dump_json(context={"language": language}), media_type="application/json")


@router.post(
    "/plants/check",
    response_model=PlantCheck,
    openapi_extra=body_schema("Plant"),
    responses=documented(413, 415, 422),
    tags=["plants"],
)
async def check_plant(request: Request, services: Use, language: Language) -> Response:
    """Check a plant: return its equations and the matrices Φ and Ψ, or the error and its place."""

    from thetascope.assembly import check_plant  # imports SymPy, so it is not imported at the start of the service

    plant = await parsed_as(request, services, Plant)
    return json_response(await computed(request, services, check_plant, plant, language))


@router.post(
    "/plants/read",
    response_model=Plant,
    openapi_extra=_TEXT,
    responses=documented(413, 422),
    tags=["plants"],
)
async def read_plant(request: Request, services: Use) -> Response:
    """Return a plant that is written as YAML or JSON in full, as other requests take it in JSON."""
    text = await read_bytes(request, services.settings.max_body)
    plant = await computed(request, services, plant_of_text, text)
    return Response(plant.model_dump_json(context={"language": ALL}), media_type="application/json")


@router.get("/experiments", response_model=ExperimentList, tags=["experiments"])
def list_experiments(language: Language) -> Response:
    """Return the experiments of the library."""
    return json_response({"experiments": [experiment_line(item, language) for item in library.experiments().values()]})


@router.get("/experiments/{id}", response_model=Experiment, responses=documented(404), tags=["experiments"])
def get_experiment(id: str, language: Prose) -> Response:
    """Return an experiment of the library in full: change it and POST it to /api/runs.

    Its prose is in one language; `?lang=*` gives it in all languages, as maps.
    """
    return Response(
        library_experiment(id).model_dump_json(context={"language": language}), media_type="application/json"
    )
