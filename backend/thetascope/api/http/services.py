"""The services used by the routers, one set per application."""

from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, Request

from thetascope.live.scheduling.hub import Hub
from thetascope.runs.jobs.manager import RunManager
from thetascope.settings import Settings
from thetascope.store import Database, RunStore


@dataclass(frozen=True)
class Services:
    """The settings, the run manager, the live sessions and the store's database of one application."""

    settings: Settings
    runs: RunManager
    live: Hub
    database: Database

    @classmethod
    def start(cls, settings: Settings) -> "Services":
        """Open the store and start the manager. Raises StoreError."""
        database = Database(settings.database)
        runs = RunManager(settings, RunStore(database, settings.store_limit))
        return cls(settings, runs, Hub(settings), database)

    def close(self) -> None:
        """Cancel the active runs, and close the run manager and the store."""
        self.runs.close()
        self.database.close()


def of_request(request: Request) -> Services:
    """Return the services of the application that handles this request."""
    return request.app.state.services


Use = Annotated[Services, Depends(of_request)]
