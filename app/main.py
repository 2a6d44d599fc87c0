"""The application: `create_app` builds everything; importing builds nothing."""

from __future__ import annotations

import threading
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from fastapi import FastAPI
from fastapi_offline import FastAPIOffline

import core
from app import errors, guard
from app.metrics import Metrics
from app.observe import Observe
from app.routes import health, metrics, processes, scenes, sweeps, zarr
from app.settings import Settings
from app.store import SweepStore
from app.zarr_views import ZarrViews


def create_app(settings: Settings) -> FastAPI:
    """Return the service with these settings."""
    store = SweepStore(settings.data_directory)

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        yield
        store.close()

    app = FastAPIOffline(
        docs_url="/docs",
        redoc_url=None,
        title="vibrafeed",
        version=core.__version__,
        description="Parameter sweeps and motion in time of parts on vibratory feeder tracks.",
        lifespan=lifespan,
    )
    app.state.settings = settings
    app.state.store = store
    app.state.views = ZarrViews(store, settings.zarr_cache_bytes)
    app.state.metrics = Metrics()  # other parts add gauges
    app.state.readiness = []  # of (name, check): see `app.routes.health.readyz`
    app.state.stopping = threading.Event()  # set by a signal: open streams end
    errors.install(app)
    for part in (health, metrics, scenes, sweeps, zarr, processes):
        app.include_router(part.router)
    guard.install(app, settings)
    app.add_middleware(Observe, metrics=app.state.metrics)
    app.add_middleware(guard.SafeHeaders)
    return app
