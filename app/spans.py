"""Spans of requests, of the work that they posted, and of its blocks, sent by OpenTelemetry."""

from __future__ import annotations

import threading
import time
from collections import OrderedDict
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING

from opentelemetry.exporter.otlp.proto.http.trace_exporter import OTLPSpanExporter
from opentelemetry.sdk.resources import Resource
from opentelemetry.sdk.trace import TracerProvider
from opentelemetry.sdk.trace.export import BatchSpanProcessor
from opentelemetry.trace import (
    NonRecordingSpan,
    Span,
    SpanContext,
    SpanKind,
    format_trace_id,
    get_current_span,
    set_span_in_context,
)
from opentelemetry.trace.propagation.tracecontext import TraceContextTextMapPropagator

from vibrafeed import core
from vibrafeed.app import logs

if TYPE_CHECKING:
    from vibrafeed.app.jobs.ledger import Work

MAX_POSTED = 10_000  # studies whose request is remembered until they are taken up
FLUSH = 1.0  # s that the last spans may take to leave


def sent_as(service: str) -> Traces:
    """Return a recorder of spans that sends them by OpenTelemetry under a service name.

    The environment says to which address (`OTEL_EXPORTER_OTLP_ENDPOINT`).
    """
    provider = TracerProvider(
        resource=Resource.create({"service.name": service}), shutdown_on_exit=False
    )
    provider.add_span_processor(BatchSpanProcessor(OTLPSpanExporter()))
    return Traces(provider)


class Traces:
    """Makes spans of requests, of the work that they posted, and of its blocks.

    Parameters
    ----------
    provider : TracerProvider
        Where they go.
    """

    def __init__(self, provider: TracerProvider):
        """Make spans with a provider of OpenTelemetry."""
        self._provider = provider
        self._tracer = provider.get_tracer("vibrafeed", core.__version__)
        self._posted: OrderedDict[str, SpanContext] = OrderedDict()  # by study: who asked for it
        self._working: dict[str, Span] = {}  # by claim

    @contextmanager
    def request(self, headers: Mapping[str, str]) -> Iterator[Span]:
        """Begin the span of a request and yield it; the span ends with the block.

        `headers` are those of the request: its `traceparent` names the trace that the span joins.
        The trace's identifier is added to the log lines of the request.
        """
        context = TraceContextTextMapPropagator().extract(headers)
        # What fails is in the log; its text may hold what is no span's business.
        with self._tracer.start_as_current_span(
            "request", context, SpanKind.SERVER, record_exception=False
        ) as span:
            logs.bind(trace_id=format_trace_id(span.get_span_context().trace_id))
            yield span

    @staticmethod
    def answered(span: Span, method: str, route: str, status: int) -> None:
        """Record method, route and status on the span of a request, once its reply is known.

        `route` is the template of the path, as in `/jobs/{number}`; `status` is the HTTP status
        code.
        """
        span.update_name(f"{method} {route}")
        span.set_attributes(
            {"http.request.method": method, "http.route": route,
             "http.response.status_code": status}
        )  # fmt: skip

    def posted(self, key: str) -> None:
        """Remember the current request as the one that posted a study: their spans share a trace.

        `key` is the identifier of the study. The earliest post counts, and the latest 10,000
        studies are remembered.
        """
        self._posted.setdefault(key, get_current_span().get_span_context())
        while len(self._posted) > MAX_POSTED:
            self._posted.popitem(last=False)

    def began(self, item: Work) -> dict[str, str]:
        """Begin the span of an item of work, in the trace of the request that posted its study.

        The item is a study being computed, whose claim (`item.owner`) the span is kept under until
        `ended`. Return the trace's identifier as a field for the item's log lines.
        """
        post = self._posted.pop(item.key, None)  # None: at another server, or before a restart
        context = None if post is None else set_span_in_context(NonRecordingSpan(post))
        attributes: dict[str, str | int] = {
            "vibrafeed.study": item.key,
            "vibrafeed.blocks": item.blocks,
        }
        span = self._tracer.start_span(f"work {item.process}", context, attributes=attributes)
        self._working[item.owner] = span
        return {"trace_id": format_trace_id(span.get_span_context().trace_id)}

    def computed(self, item: Work, seconds: float) -> None:
        """Add a span, ending now, for a block of an item that took some time [s]."""
        if item.owner not in self._working:
            return
        context, now = set_span_in_context(self._working[item.owner]), time.time_ns()
        self._tracer.start_span("block", context, start_time=now - int(seconds * 1e9)).end(now)

    def ended(self, item: Work, outcome: str, seconds: float) -> None:
        """End the span of an item of work and record its outcome, such as `done` or `failed`.

        `seconds` is how long the item was under way; the span has its own times and does not use
        it.
        """
        span = self._working.pop(item.owner, None)
        if span is not None:
            span.set_attribute("vibrafeed.outcome", outcome)
            span.end()

    def close(self) -> None:
        """Send the remaining spans, waiting a moment at most for the receiver."""
        closing = threading.Thread(target=self._provider.shutdown, daemon=True)
        closing.start()
        closing.join(FLUSH)
