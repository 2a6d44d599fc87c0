"""Figures of the service, for Prometheus."""

from __future__ import annotations

from fastapi import APIRouter, Request
from fastapi.responses import PlainTextResponse, Response
from prometheus_client.exposition import CONTENT_TYPE_LATEST

router = APIRouter(tags=["service"])


@router.get("/metrics", summary="Figures for Prometheus", response_class=PlainTextResponse)
def metrics(request: Request) -> Response:
    """Return counts of requests, their times, what is under way, memory and processor time."""
    return Response(request.app.state.metrics.text(), media_type=CONTENT_TYPE_LATEST)
