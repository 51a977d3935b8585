"""The services used by the routers, one set per application."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, Request

from thetascope.classroom.faults.computing import Computing
from thetascope.classroom.lti.tool import Tool
from thetascope.classroom.rooms import Rooms
from thetascope.live.scheduling.hub import Hub
from thetascope.runs.jobs.manager import RunManager
from thetascope.runs.lessons.my_lessons import MyLessons
from thetascope.runs.notebook.notebook import Notebook
from thetascope.runs.plants.my_plants import MyPlants
from thetascope.runs.records.record_files import RecordFiles
from thetascope.runs.workers.limits import Limits
from thetascope.runs.workers.pool import Workers
from thetascope.runs.workers.process import preload
from thetascope.settings import Settings
from thetascope.store import Database, LessonStore, NotebookStore, PlantStore, RecordStore, RunStore
from thetascope.studies.jobs import StudyJobs
from thetascope_schemas.experiment.experiment import ResolvedExperiment

PRELOADED = ("sympy", "thetascope.live.session.session", "thetascope.assembly.analyses.record_diagnosis")
"""Modules that workers have imported when they start."""


@dataclass(frozen=True)
class Services:
    """The settings, workers, runs, their notebook, sessions, records, plants, lessons, rooms, studies, database."""

    settings: Settings
    workers: Workers
    runs: RunManager
    live: Hub
    database: Database
    records: RecordFiles
    my_plants: MyPlants
    my_lessons: MyLessons
    notebook: Notebook
    rooms: Rooms
    studies: StudyJobs
    lti: Tool | None = None

    @classmethod
    def start(
        cls,
        settings: Settings,
        database: Database | None = None,
        run_ended: Callable[[str, float], None] = lambda outcome, seconds: None,
    ) -> "Services":
        """Open the store, if it is not given, start the manager, and resume runs; `run_ended`: see RunManager.

        Raises StoreError, SettingsError.
        """
        database = database or Database.for_service(settings.store, bool(settings.read_only))
        preload(PRELOADED)
        limits = Limits(settings.job_seconds, settings.job_cpu, settings.job_memory)
        workers = Workers(settings.workers, limits, settings.queue)
        records = RecordFiles(RecordStore(database), settings.record_limit)
        store = RunStore(database, settings.store_limit)
        runs = RunManager(settings, store, workers, run_ended, records.of_experiment)
        notebook = Notebook(NotebookStore(database), store, runs)
        notebook.begin()
        runs.resume()
        plants = MyPlants(PlantStore(database), settings.plant_limit)
        lessons = MyLessons(LessonStore(database), settings.plant_limit)
        rooms = Rooms(Computing(workers))
        lti = Tool(settings, rooms) if settings.lti else None
        live = Hub(settings, workers)
        studies = StudyJobs(settings, workers)
        studies.resume()
        return cls(settings, workers, runs, live, database, records, plants, lessons, notebook, rooms, studies, lti)

    def with_record(self, spec: ResolvedExperiment) -> ResolvedExperiment:
        """Return an experiment with the file of its record, if it has one. Raises Unknown for no such record."""
        return spec if spec.truth.record is None else spec.with_readings(self.records.of_experiment(spec))

    def end_computations(self) -> None:
        """End the active runs, all other computations and their processes."""
        self.studies.stop()
        self.runs.stop()
        self.workers.close()

    def close(self) -> None:
        """End all sessions and computations, and close the run manager and the store."""
        if self.lti is not None:
            self.lti.stop()
        self.rooms.stop()
        self.live.stop()
        self.end_computations()
        self.studies.close()
        self.runs.close()
        self.database.close()


def of_request(request: Request) -> Services:
    """Return the services of the application that handles this request."""
    return request.app.state.services


Use = Annotated[Services, Depends(of_request)]
