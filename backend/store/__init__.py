"""The store: specs, summaries and results of runs, in one SQLite file."""

from backend.store.database import Database, StoreError
from backend.store.runs import Record, RunStore

__all__ = ["Database", "Record", "RunStore", "StoreError"]
