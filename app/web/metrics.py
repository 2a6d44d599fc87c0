"""Figures of the service for Prometheus; each app counts in a registry of its own."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from prometheus_client import CollectorRegistry, Counter, Gauge, Histogram, ProcessCollector
from prometheus_client.exposition import generate_latest
from prometheus_client.metrics_core import GaugeMetricFamily, Metric
from prometheus_client.registry import Collector

SECONDS = (0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0)
# Clients may send any word as a method; each label value costs memory for ever.
METHODS = frozenset({"GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS"})


class Metrics:
    """Counts of requests, and gauges that other parts add.

    Attributes
    ----------
    registry : CollectorRegistry
        Where every figure of this app stands; other parts may register their own.
    """

    def __init__(self) -> None:
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
        self.under_way = Gauge(
            "vibrafeed_requests_under_way",
            "Requests that are not answered yet.",
            registry=self.registry,
        )

    def gauges(
        self, name: str, description: str, label: str, values: Callable[[], Mapping[str, float]]
    ) -> None:
        """Add a gauge with a label, whose values are asked for when the figures are read."""
        self.registry.register(_Gauges(name, description, label, values))

    def count(self, method: str, route: str, status: int, seconds: float) -> None:
        """Count one request; `route` is a template such as ``/sweeps/{key}``, never a path."""
        method = method if method in METHODS else "other"
        self._requests.labels(method, route, str(status)).inc()
        self._seconds.labels(method, route).observe(seconds)

    def text(self) -> bytes:
        """Return every figure in the text format of Prometheus."""
        return generate_latest(self.registry)


class _Gauges(Collector):
    """A gauge whose values for all labels are known together."""

    def __init__(
        self, name: str, description: str, label: str, values: Callable[[], Mapping[str, float]]
    ):
        self._words, self._values = (name, description), values
        self._label = label

    def describe(self) -> Iterable[Metric]:
        return [GaugeMetricFamily(*self._words, labels=[self._label])]

    def collect(self) -> Iterable[Metric]:
        family = GaugeMetricFamily(*self._words, labels=[self._label])
        for word, value in self._values().items():
            family.add_metric([word], value)
        return [family]
