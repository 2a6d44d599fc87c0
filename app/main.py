"""The application: `create_app` builds everything; importing builds nothing."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from fastapi import FastAPI
from fastapi_offline import FastAPIOffline

import core
from app import errors
from app.routes import health, processes, scenes, sweeps, zarr
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
    errors.install(app)
    for router in (health.router, scenes.router, sweeps.router, zarr.router, processes.router):
        app.include_router(router)
    return app
