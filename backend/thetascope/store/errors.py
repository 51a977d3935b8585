"""Errors of the store, with their remedies."""

from thetascope.messages.explained import Explained


class StoreError(Explained, RuntimeError):
    """The store cannot be used."""


class Damaged(StoreError):
    """A stored run or result that does not have its checksum; nothing of it is returned."""
