"""GET /api/runs: the list of runs; PATCH and restore of one: name, tags, pin, undoing its removal."""

from typing import Annotated, Any

from fastapi import APIRouter, Query, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response

from thetascope import library
from thetascope.access.principal import Principal, principal_of
from thetascope.api.http.answers import in_turn, json_response, listed, run_links
from thetascope.api.http.language import Language
from thetascope.api.http.problems import documented
from thetascope.api.http.read_body import body_schema, parsed_as
from thetascope.api.http.services import Services, Use
from thetascope.api.operation.request_log import audit
from thetascope.messages import Message
from thetascope.runs.jobs.job import Snapshot
from thetascope.runs.notebook.search_text import parse_search
from thetascope.runs.results.run_facts import facts_of_run
from thetascope.store import Line, RunFacts, RunQuery
from thetascope.store.notebook.listing import Counts, Group, Order
from thetascope.store.notebook_store import tags_of
from thetascope_schemas.service.notebook.lines import RunKind, RunLine, RunList, RunNotes
from thetascope_schemas.texts.local_text import in_language

router = APIRouter(prefix="/runs", tags=["runs"])


@router.get("", response_model=RunList, responses=documented(422))
async def list_runs(
    request: Request,
    services: Use,
    language: Language,
    limit: Annotated[int, Query(ge=1, le=1000)] = 100,
    offset: Annotated[int, Query(ge=0, le=10**15)] = 0,
    q: Annotated[str, Query(max_length=400, description="Words and conditions: `lab 2`, `lambda > 2`.")] = "",
    kind: Annotated[RunKind | None, Query(description="Only runs of this kind.")] = None,
    experiment: Annotated[str | None, Query(max_length=64, description="Only runs of this experiment.")] = None,
    tag: Annotated[str | None, Query(max_length=40, description="Only runs with this tag.")] = None,
    since: Annotated[float | None, Query(description="Only runs from this time on, in s since 1970.")] = None,
    pinned: Annotated[bool, Query(description="Only pinned runs.")] = False,
    sort: Annotated[Order, Query(description="What the runs are sorted by.")] = "created",
    descending: Annotated[bool | None, Query(description="Default: the newest first, all else ascending.")] = None,
    group: Annotated[Group, Query(description="Runs of a group follow each other, the newest group first.")] = "none",
) -> Response:
    """Return the active runs, then a page of the stored ones, by default the newest first."""
    by = principal_of(request.scope)
    words, conditions = parse_search(q)
    down = descending if descending is not None else sort == "created"
    query = RunQuery(
        words, conditions, kind, experiment, tag, since, pinned, sort, down, group, limit=limit, offset=offset
    )
    unfiltered = not (q or kind or experiment or tag or since or pinned or offset)
    return await in_turn(request, lambda: _listed(services, query, by, language, unfiltered))


def _listed(services: Services, query: RunQuery, by: Principal, language: str, with_active: bool) -> Response:
    """Return the answer of a list of runs."""
    active = services.runs.active() if with_active else []
    lines, counts = services.notebook.page(by, query)
    under_way = {run.id for run in active}
    entries = [_active(run, by, language) for run in active]
    entries += [run_line(services, line, by, language) for line in lines if line.record.id not in under_way]
    return json_response(
        {
            "runs": entries,
            "groups": _groups(counts, query.group, language),
            "tags": [{"tag": tag, "n": n} for tag, n in sorted(counts.tags.items())],
            "counts": {
                "all": counts.all,
                "pinned": counts.pinned,
                "kinds": counts.kinds,
                "found": sum(counts.found.values()),
            },
            "store": services.runs.usage(),
        }
    )


@router.patch(
    "/{id}",
    response_model=RunLine,
    openapi_extra=body_schema("RunNotes"),
    responses=documented(403, 404, 409, 413, 415, 422),
)
async def edit_run(request: Request, id: str, services: Use, language: Language) -> Response:
    """Name, tag or pin a run. Only its owners may; name and tags are seen by the client that gives them."""
    by = principal_of(request.scope)
    notes = await parsed_as(request, services, RunNotes)
    tags = None if notes.tags is None else tuple(dict.fromkeys(notes.tags))
    line = await run_in_threadpool(services.notebook.edit, id, by, notes.name, tags, notes.pinned)
    audit(request, "run.edited", run=id)
    return json_response(run_line(services, line, by, language))


@router.post("/{id}/restore", response_model=RunLine, responses=documented(403, 404))
def restore_run(request: Request, id: str, services: Use, language: Language) -> Response:
    """Bring back a run that this client has removed, within ten minutes and before the service starts again."""
    by = principal_of(request.scope)
    line = services.notebook.restore(id, by)
    audit(request, "run.restored", run=id)
    return json_response(run_line(services, line, by, language))


def run_line(services: Services, line: Line, by: Principal, language: str) -> dict[str, Any]:
    """Return the entry of a stored run in a list."""
    own = {"name": line.name, "tags": line.tags, "mine": services.notebook.is_mine(line, by)}
    if line.note_damaged:
        own["warning"] = Message("run.note-damaged").text(language)
    return listed(line.record, language) | own | _of_facts(line.facts, language)


def _active(run: Snapshot, by: Principal, language: str) -> dict[str, Any]:
    mine = by.is_machine or any(by.acts_for(owner) for owner in run.owners or ())
    own = {"progress": run.progress, "name": "", "tags": (), "mine": mine, "links": run_links(run.id)}
    return listed(run, language) | own | _of_facts(facts_of_run(run.spec), language)


def _of_facts(facts: RunFacts | None, language: str) -> dict[str, Any]:
    """Return the part of an entry that the facts of the run give."""
    facts = facts or RunFacts("")
    shown = {name: facts.shown.get(name) for name in ("observer", "state", "plant", "record", "curve")}
    changes = [change | {"label": labelled(change["label"], language)} for change in facts.changes]
    return shown | {
        "kind": facts.kind,
        "experiment": facts.experiment or None,
        "changes": changes if facts.experiment or facts.compared else None,
        "rmse": facts.rmse,
        "delay": facts.delay,
        "false_alarms": facts.false_alarms,
    }


def labelled(label: dict[str, Any], language: str) -> dict[str, Any]:
    """Return a stored message with its sentence in a language."""
    return label | {"text": Message.from_data(label).text(language)}


def _groups(counts: Counts, group: str, language: str) -> list[dict[str, Any]]:
    """Return the groups of the runs that were found, with their titles."""
    known = library.experiments() if group != "tags" else {}
    groups = []
    for key, n in counts.found.items():
        if group == "tags":
            title = ", ".join(tags_of(key))
        else:
            title = in_language(known[key].title, language) if key in known else ""
        groups.append({"key": key, "title": title, "n": n})
    return groups
