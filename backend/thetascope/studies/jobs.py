"""The studies of the service: begun, followed, cancelled, removed, and resumed when the service starts again."""

import hashlib
import json
import logging
import time
from dataclasses import dataclass, field, replace
from threading import Event, Lock, Thread

import polars as pl

from thetascope.access.principal import Principal
from thetascope.messages import Message
from thetascope.runs.specs.problem_documents import problem
from thetascope.runs.specs.refusals import Busy, InvalidSpec, NotOwner, OverLimit, Refusal, Unknown, invalid
from thetascope.runs.workers.limits import Ended, Limits
from thetascope.runs.workers.pool import Workers
from thetascope.settings import Settings
from thetascope.studies.conduct import Progress, conduct
from thetascope.studies.engines import DaskEngine, Engine
from thetascope.studies.kept import Kept
from thetascope.studies.places import Files, files_at
from thetascope.studies.service_engine import ServiceEngine
from thetascope_schemas.service.run import Problem
from thetascope_schemas.service.study.answers import StudyStatus
from thetascope_schemas.service.study.study import Study

ACTIVE = 4
"""Studies of one client that are computed at the same time."""
_FACTS = "facts.json"
_TABLES = 4
"""Tables that are kept in memory."""
log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Facts:
    """What is known of a study besides its spec. `owner`: who may cancel and remove it; "": nobody but the machine."""

    owner: str
    created: float
    status: StudyStatus
    problem: Problem | None = None

    def document(self) -> bytes:
        """Return them as a file with a checksum: a flipped bit gives the study to nobody."""
        reason = self.problem.model_dump(mode="json") if self.problem else None
        data = {"owner": self.owner, "created": self.created, "status": self.status, "problem": reason}
        return json.dumps(data | {"checksum": _checksum(data)}).encode()

    @classmethod
    def of(cls, document: bytes) -> "Facts":
        """Return those of a file; of a damaged one none, so that the study is shown as cancelled."""
        try:
            data = json.loads(document)
            checksum = data.pop("checksum")
            if checksum != _checksum(data):
                raise ValueError(checksum)
            reason = None if data["problem"] is None else Problem.model_validate(data["problem"])
            return cls(str(data["owner"]), float(data["created"]), data["status"], reason)
        except (ValueError, KeyError, TypeError, AttributeError):
            log.error("The facts of a study are damaged")
            return cls("", 0.0, "cancelled")


def _checksum(data: dict[str, object]) -> str:
    return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()[:16]


@dataclass
class _Job:
    """A study that is being computed. `ends`: asked to end; `keeps`: to be gone on with at the next start."""

    facts: Facts
    ends: Event = field(default_factory=Event)
    keeps: bool = False
    done: int = 0
    thread: Thread | None = None


@dataclass(frozen=True)
class State:
    """A study as it is now."""

    id: str
    study: Study
    facts: Facts
    done: int
    table: pl.DataFrame


class StudyJobs:
    """The studies in a folder, or in a place that fsspec knows: one folder each, named by its id.

    Methods may be called from any thread.
    """

    def __init__(self, settings: Settings, workers: Workers) -> None:
        self._settings, self._workers = settings, workers
        self._root = settings.studies or str(settings.data / "studies")
        self._jobs: dict[str, _Job] = {}
        self._tables: dict[str, tuple[frozenset[str], pl.DataFrame]] = {}
        self._lock = Lock()

    # ---- begin and end -----------------------------------------------------------------------------------------------

    def begin(self, study: Study, by: Principal) -> str:
        """Begin a complete study, or go on with it; return its id.

        Raises OverLimit, InvalidSpec for more runs than the service allows, and Refusal if nothing can be written.
        """
        if study.runs > self._settings.study_runs:
            limit = self._settings.study_runs
            raise invalid("vary", study.runs, Message("study.over-limit", runs=study.runs, limit=limit))
        if self._settings.read_only:
            raise Refusal(Message("study.read-only"))
        id = study.study_hash()
        with self._lock:
            known = self._jobs.get(id)
            if known is not None:
                return id
            mine = sum(job.facts.owner == by.owner for job in self._jobs.values())
            if mine >= ACTIVE:
                raise OverLimit(Message("study.active", n=mine), 5.0)
            files = self._files(id)
            before = Facts.of(files.read(_FACTS)) if _FACTS in files.names("") else None
            owner = before.owner if before is not None and before.owner else by.owner
            facts = Facts(owner, before.created if before and before.created else time.time(), "running")
            job = self._jobs[id] = _Job(facts)
        try:
            kept = Kept(study, f"{self._root}/{id}")
            job.done = kept.runs_done
            files.write(_FACTS, facts.document())
        except BaseException:
            with self._lock:
                del self._jobs[id]
            raise
        self._start(id, kept, job, by.client)
        return id

    def resume(self) -> None:
        """Go on with the studies that were being computed when the service ended."""
        if self._settings.read_only:
            return
        for id in self._ids():
            files = self._files(id)
            try:
                facts = Facts.of(files.read(_FACTS))
                if facts.status != "running":
                    continue
                kept = Kept.at(f"{self._root}/{id}")
            except (OSError, Refusal, ValueError) as error:
                log.error("Study %s cannot be resumed: %s", id, error)
                continue
            job = self._jobs[id] = _Job(facts, done=kept.runs_done)
            self._start(id, kept, job, facts.owner)

    def _start(self, id: str, kept: Kept, job: _Job, client: str) -> None:
        job.thread = Thread(target=self._conduct, args=(id, kept, job, client), name="study", daemon=True)
        job.thread.start()

    def _engine(self, client: str) -> Engine:
        settings = self._settings
        if settings.scheduler:
            return DaskEngine(settings.scheduler)
        limits = Limits(settings.max_seconds, settings.max_seconds, settings.job_memory)
        return ServiceEngine(self._workers, settings.workers, client, limits)

    def _conduct(self, id: str, kept: Kept, job: _Job, client: str) -> None:
        """Compute a study, in a thread of its own, and write how it ended."""
        engine: Engine | None = None
        status: StudyStatus = "done"
        reason: Problem | None = None

        def progress(now: Progress) -> None:
            job.done = now.done

        try:
            engine = self._engine(client)
            conduct(kept, engine, progress, job.ends.is_set)
            status = "done" if kept.runs_done == kept.study.runs else "cancelled"
        except (Ended, Busy):
            status = "cancelled"
        except (Refusal, InvalidSpec) as error:
            status, reason = "failed", _problem(error)
        except Exception:
            log.exception("Study %s failed", id)
            status, reason = "failed", problem(500, Message("run.internal-error"))
        finally:
            if engine is not None:
                engine.close()
            if not (job.keeps and status == "cancelled"):
                self._write_end(id, job, status, reason)
            with self._lock:
                self._jobs.pop(id, None)

    def _write_end(self, id: str, job: _Job, status: StudyStatus, reason: Problem | None) -> None:
        job.facts = replace(job.facts, status=status, problem=reason)
        files = self._files(id)
        try:
            if _FACTS in files.names(""):  # it was not removed
                files.write(_FACTS, job.facts.document())
        except OSError as error:
            log.error("The end of study %s cannot be written: %s", id, error)

    def cancel(self, id: str, by: Principal) -> None:
        """End the computation of a study; what was computed is kept. Raises Unknown, NotOwner."""
        job = self._jobs.get(id)
        self._check_owner(self._facts(id), by)
        if job is not None:
            job.ends.set()
            self._wait(job)

    def remove(self, id: str, by: Principal) -> None:
        """Cancel a study, and remove its runs. Raises Unknown, NotOwner."""
        self.cancel(id, by)
        files = self._files(id)
        files.remove(_FACTS)  # first: without it there is no study
        for folder in ("blocks", ""):
            for name in files.names(folder):
                files.remove(f"{folder}/{name}".lstrip("/"))
        self._tables.pop(id, None)

    def stop(self) -> None:
        """End all computations; the next start of the service goes on with them."""
        for job in list(self._jobs.values()):
            job.keeps = True
            job.ends.set()

    def close(self) -> None:
        """Wait for the threads of studies, after the workers have ended."""
        for job in list(self._jobs.values()):
            self._wait(job)

    @staticmethod
    def _wait(job: _Job) -> None:
        if job.thread is not None:
            job.thread.join(10.0)

    # ---- look --------------------------------------------------------------------------------------------------------

    def state(self, id: str) -> State:
        """Return a study with all rows that are kept. Raises Unknown."""
        facts = self._facts(id)
        job = self._jobs.get(id)
        kept = Kept.at(f"{self._root}/{id}")
        return State(id, kept.study, facts, job.done if job else kept.runs_done, self._table(id, kept))

    def all(self, by: Principal) -> list[State]:
        """Return the studies of a client, the newest first, without their rows."""
        found = []
        for id in self._ids():
            try:
                facts = self._facts(id)
                if not by.acts_for(facts.owner):
                    continue
                kept = Kept.at(f"{self._root}/{id}")
            except (OSError, Refusal, ValueError) as error:
                log.error("Study %s cannot be read: %s", id, error)
                continue
            job = self._jobs.get(id)
            found.append(State(id, kept.study, facts, job.done if job else kept.runs_done, pl.DataFrame()))
        return sorted(found, key=lambda one: -one.facts.created)

    def _table(self, id: str, kept: Kept) -> pl.DataFrame:
        """Return the rows of a study; those that were read before are not read again."""
        names, table = self._tables.get(id, (frozenset[str](), pl.DataFrame()))
        table = kept.table(names, table)
        with self._lock:
            self._tables.pop(id, None)
            self._tables[id] = kept.names, table
            while len(self._tables) > _TABLES:
                del self._tables[next(iter(self._tables))]
        return table

    def _facts(self, id: str) -> Facts:
        job = self._jobs.get(id)
        if job is not None:
            return job.facts
        files = self._files(id)
        if _FACTS not in files.names(""):
            raise Unknown(Message("study.unknown", id=id))
        return Facts.of(files.read(_FACTS))

    def _check_owner(self, facts: Facts, by: Principal) -> None:
        if not (by.is_machine or facts.owner and by.acts_for(facts.owner)):
            raise NotOwner(Message("study.not-owner"))

    def _files(self, id: str) -> Files:
        if len(id) != 32 or not set(id) <= set("0123456789abcdef"):
            raise Unknown(Message("study.unknown", id=id[:80]))
        return files_at(f"{self._root}/{id}")

    def _ids(self) -> list[str]:
        return [name for name in files_at(self._root).folders() if len(name) == 32]


def _problem(error: Refusal | InvalidSpec) -> Problem:
    if isinstance(error, Refusal):
        return problem(422, error.problem, error.remedy)
    return problem(422, Message("study.all-refused", reason=error.text()))
