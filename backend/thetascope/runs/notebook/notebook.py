"""The notebook: all runs in a list, named and tagged by their owners, removed and brought back."""

import logging
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace

from thetascope.access.principal import Principal
from thetascope.messages import Message
from thetascope.runs.jobs.job import Snapshot
from thetascope.runs.jobs.manager import RunManager
from thetascope.runs.jobs.ownership import share_of
from thetascope.runs.jobs.store_rows import snapshot_of
from thetascope.runs.notebook.own_changes import with_own_changes
from thetascope.runs.results.run_facts import facts_of_run
from thetascope.runs.specs.refusals import Unknown
from thetascope.store import Damaged, Line, NotebookStore, RunFacts, RunQuery, RunStore, StoreError
from thetascope.store.notebook.listing import Counts
from thetascope_schemas.experiment.experiment import Experiment

log = logging.getLogger(__name__)

KEPT = 600.0
"""Seconds for which a run that was removed can be brought back."""


class Notebook:
    """Lists of runs, as each client sees them. Names and tags are its own; a pin belongs to the run."""

    def __init__(self, store: NotebookStore, stored_runs: RunStore, runs: RunManager) -> None:
        self._store, self._stored_runs, self._runs = store, stored_runs, runs
        self._completed: set[str] = set()

    def begin(self) -> None:
        """Restore damaged owners of runs, and erase the runs that were removed before this start."""
        if not self._store.read_only:
            self._store.mend()
            self._store.erase(time.time())

    def page(self, by: Principal, query: RunQuery) -> tuple[list[Line], Counts]:
        """Return a page of the stored runs, also of those that have just ended, and how many there are."""
        self._runs.written_in_order(lambda: None)
        self._complete()
        try:
            lines, counts = self._store.page(by.owner, query)
        except StoreError as error:
            log.error("%s", error)
            records = self._stored_runs.page(query.limit, query.offset)
            return [Line(record, None) for record in records], Counts(len(records))
        lines = [line if line.facts or line.record.damaged else self._with_facts(line) for line in lines]
        return with_own_changes(lines, self._spec), counts

    def line(self, id: str, by: Principal) -> Line:
        """Return a run of the list. Raises Unknown."""
        self._runs.written_in_order(lambda: None)
        line = self._store.line(by.owner, id)
        if line is None:
            self._runs.get(id)  # raises Unknown with similar ids
            raise Unknown(Message("run.unknown", id=id[:64]))
        return line if line.facts or line.record.damaged else self._with_facts(line)

    def edit(self, id: str, by: Principal, name: str | None, tags: tuple[str, ...] | None, pinned: bool | None) -> Line:
        """Name, tag or pin a run; None leaves it as it is. Raises Unknown, NotOwner, or NotReady for an active run."""
        self.line(id, by)
        if not by.is_machine:
            share_of(self._runs.owners(id), by)
        if pinned is not None:
            self._runs.pin(id, pinned, by)
        if name is not None or tags is not None:
            self._runs.written_in_order(lambda: self._store.note(id, by.owner, name, tags))
        return self.line(id, by)

    def comparison_notes(self, ids: Sequence[str], by: Principal) -> tuple[str, Message | None]:
        """Return what a client notes about the comparison of runs; "" and the problem if that is damaged."""
        try:
            return self._store.comparison_notes(ids, by.owner), None
        except Damaged as error:
            log.error("%s", error)
            return "", error.problem

    def keep_comparison_notes(self, ids: Sequence[str], by: Principal, text: str) -> None:
        """Keep a client's notes about the comparison of runs, which are in its list. Raises Unknown."""
        for id in ids:
            self.line(id, by)
        self._runs.written_in_order(lambda: self._store.note_comparison(ids, by.owner, text))

    def remove(self, id: str, by: Principal) -> bool:
        """Remove a run, or the client's share of it; return whether it is gone. Both can be undone for some time.

        Raises Unknown, or NotOwner.
        """
        gone = self._runs.remove(id, by)
        if not gone:
            self._runs.written_in_order(lambda: self._store.give_up(id, by.owner, time.time()))
        self._store.erase(time.time() - KEPT)
        return gone

    def restore(self, id: str, by: Principal) -> Line:
        """Bring back a run that the client has removed. Raises Unknown if it is erased, or NotOwner."""
        owners = self._stored_runs.owners(id)
        if not by.is_machine and self._store.given_up(id, by.owner):
            self._runs.share(id, by)
            self._runs.written_in_order(lambda: self._store.give_up(id, by.owner, None))
        elif by.is_machine or (owners and share_of(owners, by)):
            self._runs.written_in_order(lambda: self._store.restore(id))
        return self.line(id, by)

    def is_mine(self, line: Line, by: Principal) -> bool:
        """Return whether a client may name, tag and remove a run."""
        return by.is_machine or any(by.acts_for(owner) for owner in line.owners)

    def saved_from_live(self, id: str) -> None:
        """Record that a run is a live session that was saved."""
        with suppress(StoreError):  # it is saved in any case
            self._runs.written_in_order(lambda: self._store.set_kind(id, "session"))

    def _complete(self) -> None:
        """Write the facts of runs that an earlier version stored; once, as a damaged id takes no facts."""
        if self._store.read_only:
            return
        try:
            while missing := [id for id in self._store.without_facts() if id not in self._completed]:
                self._completed.update(missing)
                self._store.put_facts({id: self._facts(id) or RunFacts("") for id in missing})
        except StoreError as error:
            log.error("%s", error)

    def _with_facts(self, line: Line) -> Line:
        return replace(line, facts=self._facts(line.record.id))

    def _facts(self, id: str) -> RunFacts | None:
        """Return the facts of a stored run, without a curve; None if it cannot be read."""
        snapshot = self._snapshot(id)
        return None if snapshot is None else facts_of_run(snapshot.spec, snapshot.summary)

    def _spec(self, id: str) -> Experiment | None:
        snapshot = self._snapshot(id)
        return None if snapshot is None else snapshot.spec

    def _snapshot(self, id: str) -> Snapshot | None:
        """Return a stored run; None if it cannot be read."""
        try:
            record = self._stored_runs.get(id)
            return None if record is None else snapshot_of(record)
        except (Damaged, ValueError) as error:
            log.error("%s", error)
            return None
