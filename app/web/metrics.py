"""Figures of the service for Prometheus; each app counts in a registry of its own."""

from __future__ import annotations

import asyncio
import shutil
import sqlite3
import time
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress

from prometheus_client import (
    CollectorRegistry,
    Counter,
    Gauge,
    Histogram,
    Info,
    ProcessCollector,
)
from prometheus_client.exposition import generate_latest
from prometheus_client.metrics_core import GaugeMetricFamily, Metric
from prometheus_client.registry import Collector

from vibrafeed import core
from vibrafeed.app.jobs.admission import Admission
from vibrafeed.app.jobs.ledger import Work
from vibrafeed.app.settings import Settings

# Upper ends of the classes of histograms [s]: of requests and blocks, and of whole items of work.
SECONDS = (0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0)
WORK_SECONDS = (0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1e3, 3e3, 1e4, 3e4, 1e5)
# Clients may send any word as a method; each label value costs memory for ever.
METHODS = frozenset({"GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS"})
LOOP_INTERVAL = 0.25  # s between looks at the delay of the event loop


class Metrics:
    """Counts of requests, and gauges that other parts add.

    Attributes
    ----------
    registry : CollectorRegistry
        Where every figure of this app stands; other parts may register their own.
    """

    def __init__(self) -> None:
        """Register the counters of requests, work and the process."""
        self.registry = CollectorRegistry()
        ProcessCollector(registry=self.registry)
        self._requests = Counter(
            "vibrafeed_requests",
            "Requests that were answered.",
            ("method", "route", "status"),
            registry=self.registry,
        )
        self._seconds = Histogram(
            "vibrafeed_request_seconds",
            "Time from a request to the end of its reply.",
            ("method", "route"),
            buckets=SECONDS,
            registry=self.registry,
        )
        self._refusals = Counter(
            "vibrafeed_refusals",
            "Requests that were answered by a problem document.",
            ("cause",),
            registry=self.registry,
        )
        self._loop_delay = Histogram(
            "vibrafeed_loop_delay_seconds",
            "Delay of the event loop, which answers all clients.",
            buckets=SECONDS,
            registry=self.registry,
        )
        self._blocks = Histogram(
            "vibrafeed_block_seconds",
            "Time that a worker took for a block of a job.",
            ("process",),
            buckets=SECONDS,
            registry=self.registry,
        )
        self._work = Histogram(
            "vibrafeed_work_seconds",
            "Time from the taking up of a job's work to its end here: done, failed, given up, "
            "interrupted.",
            ("process", "outcome"),
            buckets=WORK_SECONDS,
            registry=self.registry,
        )
        Info("vibrafeed", "The version.", registry=self.registry).info(
            {"version": core.__version__}
        )
        self.under_way = Gauge(
            "vibrafeed_requests_under_way",
            "Requests that are not answered yet.",
            registry=self.registry,
        )

    def gauges(
        self, name: str, description: str, label: str, values: Callable[[], Mapping[str, float]]
    ) -> None:
        """Add a gauge for each value of a label; `values` is called when the metrics are read."""
        self.registry.register(_Gauges(name, description, label, values))

    def gauge(self, name: str, description: str, value: Callable[[], float]) -> None:
        """Add a gauge; `value` is called when the metrics are read."""
        self.registry.register(_Gauges(name, description, "", lambda: {"": value()}))

    async def watch_loop(self) -> None:
        """Measure the delay of the event loop until cancelled."""
        while True:
            due = time.perf_counter() + LOOP_INTERVAL
            await asyncio.sleep(LOOP_INTERVAL)
            self._loop_delay.observe(max(0.0, time.perf_counter() - due))

    def began(self, item: Work) -> Mapping[str, str]:
        """Do nothing: the ledger counts the items that are begun."""
        return {}

    def computed(self, item: Work, seconds: float) -> None:
        """Count a finished block of an item; `seconds` is its computing time [s]."""
        self._blocks.labels(item.process).observe(seconds)

    def ended(self, item: Work, outcome: str, seconds: float) -> None:
        """Count an ended item of work by its outcome; `seconds` is how long it was under way."""
        self._work.labels(item.process, outcome).observe(seconds)

    def count(self, method: str, route: str, status: int, seconds: float, cause: str) -> None:
        """Count one request; `route` is a template such as ``/sweeps/{key}``, never a real path.

        `status` is the HTTP status, `seconds` the time until the end of the reply [s], `cause` the
        type of problem that it was answered by, empty for none.
        """
        if cause:
            self._refusals.labels(cause).inc()
        method = method if method in METHODS else "other"
        self._requests.labels(method, route, str(status)).inc()
        self._seconds.labels(method, route).observe(seconds)

    def text(self) -> bytes:
        """Return all metrics in the text format of Prometheus."""
        return generate_latest(self.registry)


def watch_jobs(
    metrics: Metrics, admission: Admission, workers: Callable[[], int], settings: Settings
) -> None:
    """Add the metrics of jobs, workers and disk to those that the service reports.

    Parameters
    ----------
    metrics : Metrics
        Where they are added.
    admission : Admission
        Knows jobs, queue and used bytes.
    workers : callable
        Returns the number of workers.
    settings : Settings
        The service's: quota and data directory.
    """
    ledger = admission.ledger

    def work() -> dict[str, float]:
        """Return the number of items of work that wait and run."""
        queue = ledger.queue()
        return {"waiting": queue.waiting, "running": queue.running}

    metrics.gauges("vibrafeed_jobs", "Jobs by their state.", "state", ledger.counts)
    metrics.gauges(
        "vibrafeed_work", "Distinct studies that wait or are being computed.", "state", work
    )
    for name, description, value in (
        ("oldest_waiting_seconds", "Age of the study that has waited longest for its turn.",
         lambda: ledger.queue().oldest),
        ("ledger_fault", "1 if the ledger cannot be read.", lambda: ledger.fault() is not None),
        ("workers", "Processes that compute for this server, or threads of its cluster.", workers),
        ("disk_used_bytes", "Bytes of studies and results, counted at most once a minute.",
         admission.used_bytes),
        ("disk_quota_bytes", "Maximum bytes of studies and results.",
         lambda: settings.disk_quota_bytes),
        ("disk_free_bytes", "Free bytes on the disk of the data directory.",
         lambda: shutil.disk_usage(settings.data_directory).free),
    ):  # fmt: skip
        metrics.gauge(f"vibrafeed_{name}", description, value)


class _Gauges(Collector):
    """A gauge whose values for all labels are known together; without any if they are lost."""

    def __init__(
        self, name: str, description: str, label: str, values: Callable[[], Mapping[str, float]]
    ):
        """Define a gauge with a label, or none; `values` computes all its values."""
        self._name_and_text, self._values = (name, description), values
        self._labels = [label] if label else []

    def collect(self) -> Iterable[Metric]:
        """Return the metric with its current values, one for each value of its label.

        The Prometheus client calls it when metrics are asked for.
        """
        family = GaugeMetricFamily(*self._name_and_text, labels=self._labels)
        with suppress(OSError, sqlite3.Error):  # of a ledger or directory that is away
            for label_value, value in self._values().items():
                family.add_metric([label_value] if self._labels else [], value)
        return [family]
