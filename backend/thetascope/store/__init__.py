"""Store specs, summaries and results of runs in an SQLite file or a PostgreSQL database."""

from thetascope.store.backup import backup, opened, restore
from thetascope.store.database import Database
from thetascope.store.errors import Damaged, StoreError
from thetascope.store.notebook.facts import RunFacts
from thetascope.store.notebook.listing import RunQuery
from thetascope.store.notebook_store import Line, NotebookStore
from thetascope.store.record_store import RecordStore, Share, record_id
from thetascope.store.run_store import Record, RunStore
from thetascope.store.text_store import LessonStore, PlantStore, TextStore, TextVersion
from thetascope.store.verification import Verification, verify

__all__ = [
    "Damaged",
    "Database",
    "LessonStore",
    "Line",
    "NotebookStore",
    "PlantStore",
    "Record",
    "RecordStore",
    "RunFacts",
    "RunQuery",
    "RunStore",
    "Share",
    "StoreError",
    "TextStore",
    "TextVersion",
    "Verification",
    "backup",
    "opened",
    "record_id",
    "restore",
    "verify",
]
