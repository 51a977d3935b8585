"""The run manager: access to every run, whether active, in memory or in the store."""

import logging
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from threading import Lock

from pydantic import ValidationError

from thetascope.access.principal import LOCAL, Principal
from thetascope.messages import Message
from thetascope.runs.jobs.job import Ended, Finished, Job, Snapshot
from thetascope.runs.jobs.ownership import OwnedRuns, Owners, others, owns_alone, with_share
from thetascope.runs.jobs.recent_runs import Memory
from thetascope.runs.jobs.store_rows import INTERRUPTED, record_of, snapshot_of
from thetascope.runs.jobs.store_writer import Writer
from thetascope.runs.jobs.worker import Execution
from thetascope.runs.results.engine_version import engine_version
from thetascope.runs.specs.problem_documents import refused
from thetascope.runs.specs.refusals import Busy, InvalidSpec, NotOwner, NotReady, OverLimit, Refusal, Unknown
from thetascope.runs.specs.resolve_spec import resolved
from thetascope.runs.workers.pool import Workers
from thetascope.settings import Settings
from thetascope.store import Damaged, Record, RunStore, StoreError
from thetascope_schemas.experiment.experiment import Experiment, ResolvedExperiment

log = logging.getLogger(__name__)

_SOON = 2.0
"""Seconds after which a client with too many runs may try again."""


class RunManager:
    """Starts runs and returns their status and results.

    A spec that was run before is answered from memory or from the store; one that is running now joins that run. Any
    other is prepared and run in a worker process, and its result is written to the store in the background. A result
    that is lost in a crash is recomputed from its spec.

    `ended` is called for each run that was computed, with its outcome (done, failed, cancelled, refused, interrupted)
    and the seconds since its request. `record_of` returns the file of an experiment's record.
    """

    def __init__(
        self,
        settings: Settings,
        store: RunStore,
        workers: Workers,
        ended: Callable[[str, float], None] = lambda outcome, seconds: None,
        record_of: Callable[[ResolvedExperiment], object] = lambda spec: None,
    ) -> None:
        self._record_of = record_of
        self._ended = ended
        self._room = settings.queue + settings.workers
        self._store = store
        self._memory = Memory(settings.memory)
        self._jobs: dict[str, Job] = {}
        self._lock = Lock()
        self._writer = Writer()
        self._owned = OwnedRuns(store, self._writer, self._memory)
        self._not_stored: dict[str, Message] = {}  # id → why it is in memory only
        self._execution = Execution(settings, workers, self._end)

    def resume(self) -> None:
        """Compute the runs that an earlier service accepted and did not finish.

        A run that was cut off twice without a proper end of the service may be the reason of it: it fails.
        """
        for record in [] if self._store.read_only else self._store.unfinished():
            marked = replace(record, error=INTERRUPTED.model_dump(mode="json"))
            self._store.put(marked)  # stays until the run, or the service, ends properly
            if record.error is not None or not self._resumes(record):
                self._store.put(replace(marked, status="failed"))

    def _resumes(self, record: Record) -> bool:
        try:
            return self.submit(snapshot_of(record).spec, announced=True).id == record.id
        except (ValidationError, InvalidSpec, Refusal) as error:
            log.warning("Run %s is not resumed: %s", record.id, error)
            return False

    def submit(
        self,
        spec: Experiment,
        by: Principal | None = None,
        most: int | None = None,
        client: str = "",
        announced: bool = False,
    ) -> Snapshot | Job:
        """Return the run of a spec: a snapshot if it has a result, else the job that computes it.

        Args:
            spec: the experiment.
            by: who asks for it, and then owns it, too; None: nobody, it is computed again for its owners.
            most: the number of runs of the client that may wait or run.
            client: whose turn it takes if nobody asks for it.
            announced: no request waits for it, and the store has it.

        Raises:
            InvalidSpec: names that do not fit the plant, or more steps or numbers than the limits allow.
            Unknown: its record is not stored.
            Busy: the queue is full.
            OverLimit: the client has as many runs that wait or run as it may.
        """
        complete = resolved(spec)
        id = complete.spec_hash()
        known, client = self._readable(id), by.client if by else client
        if known is None and not self._store.read_only:
            self._store.erase_removed(id)
        owners = self._store.owners(id) if known is None else self.owners(id)
        if known is not None and self._has_result(known):
            self._owned.add(id, owners, by)
            return self._with_posted_spec(known, spec, owns_alone(owners, by))
        if complete.truth.record is not None:
            complete = complete.with_readings(self._record_of(complete))
        kept = {} if known is None else {"created": known.created, "pinned": known.pinned}
        if known is not None and not owns_alone(owners, by):
            spec = known.spec
        owners = with_share(owners, by, exists=known is not None)
        with self._lock:
            job = self._jobs.get(id)
            if job is not None:
                job.holders += 1
                job.owners |= owners
                return job
            if most is not None and sum(job.client == client for job in self._jobs.values()) >= most:
                raise OverLimit(Message("client.runs", n=most), _SOON)
            if len(self._jobs) >= self._room:
                raise Busy(Message("run.queue-full", n=len(self._jobs)))
            job = self._jobs[id] = Job(
                id, spec, client=client, owners=owners, holders=not announced, announced=announced, **kept
            )
        try:
            self._execution.start(job, complete)
        except Busy:
            with self._lock:
                del self._jobs[id]
            raise
        return job

    def leave(self, job: Job) -> None:
        """Let a request wait no longer for a job. It is cancelled if nobody else waits, and nobody knows its id."""
        with self._lock:
            job.holders -= 1
            unwanted = job.holders <= 0 and not job.announced
        if unwanted:
            self._cancel(job)

    def get(self, id: str) -> Snapshot:
        """Return the present state of the run. Raises :class:`Unknown`."""
        job = self._jobs.get(id)
        snapshot = self._known(id) if job is None else job.snapshot()
        if snapshot is None:
            near = self._store.ids(id[:6]) if len(id) >= 4 else []
            remedy = Message("suggest.near", names=near) if near else None
            raise Unknown(Message("run.unknown", id=id[:64]), remedy)
        reason = self._not_stored.get(id)
        return snapshot if reason is None else replace(snapshot, not_stored=reason)

    def job(self, id: str) -> Job | None:
        """Return the run's job while it is active."""
        return self._jobs.get(id)

    def active(self) -> list[Snapshot]:
        """Return the runs that wait or are computed, the newest first."""
        return sorted((job.snapshot() for job in list(self._jobs.values())), key=lambda run: -run.created)

    def share(self, id: str, by: Principal) -> None:
        """Make a client an owner of a stored run again."""
        self._owned.add(id, self.owners(id), by)

    def written_in_order(self, write: Callable[[], object]) -> None:
        """Write to the store after all that was queued before."""
        self._writer.now(write)

    def finished(self, id: str, client: Callable[[], str] = lambda: "") -> Finished | Job:
        """Return the run with its result, or the job that computes it (again, if the store has dropped it).

        `client` returns who waits, or refuses by an exception; it is called only if the run is computed again.

        Raises :class:`Unknown`, or :class:`NotReady` for a run that failed or was cancelled.
        """
        snapshot = self.get(id)
        if snapshot.status in ("failed", "cancelled"):
            raise NotReady(snapshot.why_ended())
        job = self._jobs.get(id)
        if job is not None:
            return job
        entry = self._memory.get(id)
        if isinstance(entry, Finished):
            return entry
        result = self._store.get_result(id, engine_version())
        if result is not None:
            entry = Finished(snapshot, result)
            self._memory.put(entry)
            return entry
        again = self.submit(snapshot.spec, client=client())
        return again if isinstance(again, Job) else self.finished(again.id)

    def announce(self, job: Job) -> None:
        """Store the spec of a run that was accepted and whose result the client will fetch later."""
        with self._lock:
            if (
                self._jobs.get(job.id) is job and not job.announced and not job.ending
            ):  # otherwise "running" would be written last
                job.announced = True
                record = record_of(job.snapshot())
                self._writer.later(lambda: self._owned.put(record, job.owners))

    def cancel(self, id: str, by: Principal = LOCAL) -> Snapshot:
        """Request an active run to stop, if nobody else owns it; a run that has ended stays unchanged.

        Raises :class:`Unknown`, or :class:`NotOwner`.
        """
        job = self._jobs.get(id)
        if job is not None:
            with self._lock:
                left = others(job.owners, by)
                given_up = job.owners - left
                job.owners = left or job.owners
            if left:
                self._owned.give_up(id, given_up, left)
            else:
                self._cancel(job)
        snapshot = self.get(id)
        if job is None and snapshot.active and self._store.read_only:
            raise NotOwner(Message("run.elsewhere", id=id))
        return snapshot

    def remove(self, id: str, by: Principal = LOCAL) -> bool:
        """Remove a run that has ended, if nobody else owns it; return whether it is gone. It can be brought back.

        Raises :class:`Unknown`, or :class:`NotOwner`.
        """
        with suppress(Damaged):
            self.get(id)
        owners = self.owners(id)
        if left := others(owners, by):
            self._owned.give_up(id, owners - left, left)
            return False
        self._memory.remove(id)
        self._writer.now(lambda: self._store.remove(id))
        return True

    def owners(self, id: str) -> Owners:
        """Return the owners of a run."""
        job = self._jobs.get(id)
        return self._owned.of(id) if job is None else job.owners

    def pin(self, id: str, pinned: bool, by: Principal = LOCAL) -> Snapshot:
        """Keep the run's result when the store needs space, or allow its deletion again.

        Raises :class:`Unknown`, or :class:`NotOwner`: only who owns a run alone may take its pin away.
        """
        snapshot = self.get(id)
        if snapshot.active:
            raise NotReady(Message("run.pin.under-way"))
        if others(self.owners(id), by) and not pinned:
            raise NotOwner(Message("run.pin.shared"))
        self._writer.now(lambda: self._store.pin(id, pinned))
        self._memory.change(id, pinned=pinned)
        return self.get(id)

    def usage(self) -> dict[str, int]:
        """Return the number of active runs, and the store's usage."""
        return {"active": len(self._jobs), **self._store.usage()}

    def queue(self) -> tuple[int, int]:
        """Return the number of active runs, and how many there may be."""
        return len(self._jobs), self._room

    def written(self, snapshot: Snapshot) -> Snapshot:
        """Return a run that has ended; where the store fails, after the attempt to write it.

        Waiting for the disk after every run would make all of them slower.
        """
        if not self._writer.fails:
            return snapshot
        self._writer.now(lambda: None)
        return replace(snapshot, not_stored=self._not_stored.get(snapshot.id))

    @property
    def not_stored(self) -> int:
        """How many runs could not be written to the store since the start."""
        return self._writer.failures

    def stop(self) -> None:
        """End the active runs. The next service computes those whose id a client knows."""
        for job in list(self._jobs.values()):
            job.interrupted = not job.cancelled
            self._cancel(job)

    def close(self) -> None:
        """Write the runs that have ended. The workers are closed before."""
        self._writer.close()

    def _cancel(self, job: Job) -> None:
        job.cancel()
        if job.status == "queued":
            self._end(job, Ended(replace(job.snapshot(), status="cancelled")))

    def _known(self, id: str) -> Snapshot | None:
        """Return the run from memory or from the store."""
        entry = self._memory.get(id)
        if entry is not None:
            return entry.snapshot
        record = self._store.get(id)
        return None if record is None else snapshot_of(record)

    def _readable(self, id: str) -> Snapshot | None:
        """Return the run from memory or from the store; None for one that is damaged, which is replaced."""
        try:
            return self._known(id)
        except Damaged as error:
            log.error("%s", error)
            return None

    def _has_result(self, snapshot: Snapshot) -> bool:
        if snapshot.status != "done":
            return False
        entry = self._memory.get(snapshot.id)
        return entry is not None or self._store.has_result(snapshot.id, engine_version())

    def _with_posted_spec(self, snapshot: Snapshot, spec: Experiment, keep: bool) -> Snapshot:
        """Return the run with the spec as posted; title and figures are not part of the id.

        `keep`: the newer ones win in the store, too.
        """
        if snapshot.spec == spec:
            return snapshot
        snapshot = replace(snapshot, spec=spec)
        if not keep:
            return snapshot
        self._memory.change(snapshot.id, spec=spec)
        record = record_of(snapshot)
        self._writer.later(lambda: self._store.put(record))
        return snapshot

    def _end(self, job: Job, end: Ended | InvalidSpec) -> None:
        """Record a job's outcome, write it, and wake all waiting requests. A second outcome is ignored."""
        if job.interrupted and not isinstance(end, Finished):
            self._leave_unfinished(job)
            return
        with self._lock:
            if self._jobs.get(job.id) is not job or job.ending:
                return
            job.ending = True
            if isinstance(end, InvalidSpec) and job.announced:
                end = Ended(replace(job.snapshot(), status="failed", problem=refused(end)))
            if isinstance(end, Ended):
                end = end.with_snapshot(owners=job.owners)
        if isinstance(end, Ended):
            self._keep(end)  # queued before the outcome is visible, so that a later removal or pin is written after it
        with self._lock:
            if isinstance(end, Ended):
                self._memory.put(end.with_snapshot(owners=job.owners))
            del self._jobs[job.id]
        self._ended("refused" if isinstance(end, InvalidSpec) else end.snapshot.status, time.time() - job.created)
        if isinstance(end, Ended) and job.owners != end.snapshot.owners:  # somebody asked for it meanwhile
            self._writer.later(lambda: self._store.own(job.id, job.owners))
        if isinstance(end, InvalidSpec):
            job.done.set_exception(end)
            return
        job.status = end.snapshot.status
        job.done.set_result(end.snapshot)

    def _leave_unfinished(self, job: Job) -> None:
        """Leave a run to the next service; requests that wait for it are refused as busy."""
        with self._lock:
            if self._jobs.get(job.id) is not job or job.ending:
                return
            job.ending = True
            del self._jobs[job.id]
        if job.announced:
            record = record_of(replace(job.snapshot(), status="queued", progress=0.0))
            self._writer.later(lambda: self._owned.put(record, job.owners))
        self._ended("interrupted", time.time() - job.created)
        job.done.set_exception(Busy(Message("work.stopping")))

    def _keep(self, end: Ended) -> None:
        result = end.result if isinstance(end, Finished) else None
        record, version = record_of(end.snapshot, result), engine_version()

        def write() -> None:
            self._not_stored.pop(record.id, None)
            try:
                self._owned.put(record, end.snapshot.owners or frozenset())
                if result is not None:
                    self._store.put_result(record.id, version, result)
            except StoreError as error:
                self._not_stored[record.id] = error.problem
                raise

        self._writer.later(write)
