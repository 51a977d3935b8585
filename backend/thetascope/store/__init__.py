"""Store specs, summaries and results of runs in an SQLite file or a PostgreSQL database."""

from thetascope.store.backup import backup, opened, restore
from thetascope.store.database import Database
from thetascope.store.errors import Damaged, StoreError
from thetascope.store.run_store import Record, RunStore
from thetascope.store.verification import Verification, verify

__all__ = [
    "Damaged",
    "Database",
    "Record",
    "RunStore",
    "StoreError",
    "Verification",
    "backup",
    "opened",
    "restore",
    "verify",
]
