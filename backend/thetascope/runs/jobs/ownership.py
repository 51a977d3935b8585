"""Who owns a run, and what owners may do.

Equal runs are one run, so it may have several owners: all who asked for it. Each has a share. Cancelling or removing a
run gives up one share; the run ends, or goes, with the last one. So nobody takes from others what they asked for, also
not by asking for the same first. The machine's owner may do everything with every run. Runs without an owner were
made on the machine, by the command line or by an earlier version, and belong to the machine's owner.
"""

from thetascope.access.principal import MACHINE, Principal
from thetascope.messages import Message
from thetascope.runs.specs.refusals import NotOwner

Owners = frozenset[str]


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
