"""Traces for OpenTelemetry: a request, the job that it posted, and its blocks share one.

Nothing is imported unless the standard environment names where spans are sent:
``OTEL_EXPORTER_OTLP_ENDPOINT``, or ``OTEL_EXPORTER_OTLP_TRACES_ENDPOINT``. As in the log, a span
holds the template of a route, never a path, a query string or a key.
"""

from __future__ import annotations

import importlib.util
import os
from collections.abc import Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from vibrafeed.app.spans import Traces

ENDPOINTS = ("OTEL_EXPORTER_OTLP_ENDPOINT", "OTEL_EXPORTER_OTLP_TRACES_ENDPOINT")


def configured(environment: Mapping[str, str] = os.environ) -> Traces | None:
    """Return a recorder of spans; None if tracing is not configured or its library not installed.

    `environment` holds the environment variables by name: those of `ENDPOINTS` configure tracing,
    and `OTEL_SERVICE_NAME` is the name that spans are sent under.
    """
    if not _is_wanted(environment) or not _is_installed():
        return None
    from vibrafeed.app.spans import sent_as  # OpenTelemetry, which few have

    return sent_as(environment.get("OTEL_SERVICE_NAME", "vibrafeed"))


def fault(environment: Mapping[str, str] = os.environ) -> str | None:
    """Return the reason why configured traces cannot be sent.

    None if they can, or none are wanted.
    """
    if _is_wanted(environment) and not _is_installed():
        return "traces are configured, but the extra `traces` is not installed"
    return None


def _is_wanted(environment: Mapping[str, str]) -> bool:
    return any(environment.get(name) for name in ENDPOINTS)


def _is_installed() -> bool:
    try:
        return importlib.util.find_spec("opentelemetry.exporter.otlp.proto.http") is not None
    except ModuleNotFoundError:  # one of the packages above it
        return False
