"""Store specs, summaries and results of runs in one SQLite file."""

from thetascope.store.database import Database, StoreError
from thetascope.store.run_store import Record, RunStore

__all__ = ["Database", "Record", "RunStore", "StoreError"]
