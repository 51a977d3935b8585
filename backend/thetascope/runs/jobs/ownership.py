"""Who owns a run, and what owners may do.

Equal runs are one run, so it may have several owners: all who asked for it. Each has a share. Cancelling or removing a
run gives up one share; the run ends, or goes, with the last one. So nobody takes from others what they asked for, also
not by asking for the same first. The machine's owner may do everything with every run. Runs without an owner were
made on the machine, by the command line or by an earlier version, and belong to the machine's owner.
"""

from functools import partial

from thetascope.access.principal import MACHINE, Principal
from thetascope.messages import Message
from thetascope.runs.jobs.recent_runs import Memory
from thetascope.runs.jobs.store_writer import Writer
from thetascope.runs.specs.refusals import NotOwner
from thetascope.store import Record, RunStore

Owners = frozenset[str]


class OwnedRuns:
    """The owners of runs that have ended: in memory, and in the store."""

    def __init__(self, store: RunStore, writer: Writer, memory: Memory) -> None:
        self._store, self._writer, self._memory = store, writer, memory

    def of(self, id: str) -> Owners:
        """Return the owners of a run, in the store those after all writes that were requested."""
        entry = self._memory.get(id)
        if entry is not None and entry.snapshot.owners is not None:
            return entry.snapshot.owners
        return self._writer.now(lambda: self._store.owners(id))

    def add(self, id: str, owners: Owners, by: Principal | None) -> None:
        """Store that somebody has asked for a run that exists."""
        new = with_share(owners, by, exists=True)
        if new != owners and not self._store.read_only:
            self._memory.change(id, owners=new)
            self._writer.later(lambda: self._store.own(id, new))

    def give_up(self, id: str, given_up: Owners, left: Owners) -> None:
        """Store that owners have given up their shares of a run, and others are left."""
        self._memory.change(id, owners=left)
        for owner in given_up:
            self._writer.later(partial(self._store.disown, id, owner))

    def put(self, record: Record, owners: Owners) -> None:
        """Store a run with its owners. For the writer's thread."""
        self._store.put(record)
        if owners:
            self._store.own(record.id, owners)


def with_share(owners: Owners, by: Principal | None, exists: bool) -> Owners:
    """Return the owners of a run after somebody asked for it; `exists`: it was there before. None: nobody asks."""
    if by is None:
        return owners
    return owners | {by.owner} | ({MACHINE} if exists and not owners else set())


def share_of(owners: Owners, by: Principal) -> str:
    """Return the share of a client. Raises NotOwner if it has none."""
    for owner in (by.owner, by.also):
        if owner and owner in owners:
            return owner
    raise NotOwner(Message("run.not-owner"))


def others(owners: Owners, by: Principal) -> Owners:
    """Return the owners that remain when a client gives up its share; none when it may do everything.

    Raises NotOwner if it has no share.
    """
    return frozenset() if by.is_machine else owners - {share_of(owners, by)}


def owns_alone(owners: Owners, by: Principal | None) -> bool:
    """Return whether a client may change a run without asking others."""
    return by is None or by.is_machine or owners == {by.owner}
