"""Metrics in the format of Prometheus: requests as they are answered, everything else as it is when it is read."""

from collections.abc import Iterable

from prometheus_client import CONTENT_TYPE_LATEST, CollectorRegistry, Histogram, generate_latest
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric
from prometheus_client.gc_collector import GCCollector
from prometheus_client.platform_collector import PlatformCollector
from prometheus_client.process_collector import ProcessCollector

from thetascope.api.http.services import Services

CONTENT_TYPE = CONTENT_TYPE_LATEST
_REQUEST = (0.002, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 10.0, 60.0)
_RUN = (0.01, 0.05, 0.1, 0.5, 1.0, 5.0, 20.0, 60.0, 300.0, 600.0)
_METHODS = {"GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS"}


class Metrics:
    """The metrics of one application."""

    def __init__(self) -> None:
        self._registry = CollectorRegistry()
        self._requests = Histogram(
            "thetascope_request_seconds",
            "Time from a request to the end of its answer",
            ("route", "method", "status"),
            registry=self._registry,
            buckets=_REQUEST,
        )
        self._runs = Histogram(
            "thetascope_run_seconds",
            "Time from the request of a run to its end",
            ("outcome",),
            registry=self._registry,
            buckets=_RUN,
        )
        for collector in (ProcessCollector, PlatformCollector, GCCollector):
            collector(registry=self._registry)

    def answered(self, route: str, method: str, status: int, seconds: float) -> None:
        """Count an answered request; `route` is its address template, never the address itself."""
        method = method if method in _METHODS else "other"
        self._requests.labels(route, method, str(status)).observe(seconds)

    def run_ended(self, outcome: str, seconds: float) -> None:
        """Count a run that has ended: done, failed, cancelled or refused."""
        self._runs.labels(outcome).observe(seconds)

    def watch(self, services: Services) -> None:
        """Read gauges from these services whenever the metrics are read."""
        self._registry.register(_Gauges(services))

    def text(self) -> bytes:
        """Return all metrics in the text format."""
        return generate_latest(self._registry)


class _Gauges:
    """Reads the state of the services."""

    def __init__(self, services: Services) -> None:
        self._services = services

    def describe(self) -> Iterable[Metric]:
        """Return nothing: the collector is not read when it is registered."""
        return ()

    def collect(self) -> Iterable[Metric]:
        """Return the present values."""
        services = self._services
        work = GaugeMetricFamily("thetascope_computations", "Computations in worker processes", labels=["state"])
        for state, number in services.workers.usage().items():
            work.add_metric([state], number)
        yield work
        ended = CounterMetricFamily("thetascope_computations_ended", "Computations that ended", labels=["outcome"])
        for outcome, number in services.workers.outcomes().items():
            ended.add_metric([outcome], number)
        yield ended
        usage = services.runs.usage()
        yield GaugeMetricFamily("thetascope_runs_active", "Runs that wait or are computed", value=usage["active"])
        yield GaugeMetricFamily("thetascope_runs_stored", "Runs in the store", value=usage["runs"])
        yield GaugeMetricFamily("thetascope_store_bytes", "Results in the store, in bytes", value=usage["bytes"])
        yield GaugeMetricFamily("thetascope_store_limit_bytes", "Space for results in the store", value=usage["limit"])
        yield CounterMetricFamily(
            "thetascope_store_failures", "Runs that could not be stored", value=services.runs.not_stored
        )
        live = services.live.usage()
        yield GaugeMetricFamily("thetascope_sessions", "Open live sessions", value=live["sessions"])
        yield GaugeMetricFamily("thetascope_viewers", "Connected viewers of live sessions", value=live["viewers"])
        yield CounterMetricFamily("thetascope_frames", "Frames of live sessions", value=live["frames"])
        yield CounterMetricFamily(
            "thetascope_frames_late", "Frames more than one frame time late", value=live["frames_late"]
        )
