"""The application: `create_app` builds everything; importing builds nothing."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
import threading
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from anyio import CapacityLimiter
from anyio.to_thread import current_default_thread_limiter
from fastapi import FastAPI
from fastapi_offline import FastAPIOffline

from vibrafeed import core
from vibrafeed.app import traces
from vibrafeed.app.jobs import work
from vibrafeed.app.jobs.admission import Admission
from vibrafeed.app.jobs.cluster import Cluster
from vibrafeed.app.jobs.fair_queue import FairQueue
from vibrafeed.app.jobs.keys import Keys
from vibrafeed.app.jobs.ledger import Ledger
from vibrafeed.app.jobs.process_pool import ProcessPool
from vibrafeed.app.jobs.runner import Runner
from vibrafeed.app.jobs.store import Store
from vibrafeed.app.jobs.writer import Writer
from vibrafeed.app.settings import Settings
from vibrafeed.app.web import calculations, guard, openapi, problems
from vibrafeed.app.web.metrics import Metrics, watch_jobs
from vibrafeed.app.web.observe import Observe
from vibrafeed.app.web.routes import (
    convert,
    figures,
    friction,
    health,
    jobs,
    page,
    processes,
    results,
    scenes,
    sweeps,
    zarr,
)
from vibrafeed.app.web.shares import CORES
from vibrafeed.app.web.warmth import Warmth
from vibrafeed.app.web.zarr_views import ZarrViews

logger = logging.getLogger("vibrafeed")

# Threads that routes run in. More would not compute more, and each that computes makes the event
# loop wait its turn for the interpreter; some are waiting for the disk or the ledger.
THREADS = 2 + (os.cpu_count() or 1)
TIDY = 3600.0  # s between looks for what nobody has used for long


def create_app(settings: Settings) -> FastAPI:
    """Return the web application with the given settings: routes, middleware, jobs and metrics.

    Nothing runs yet: workers and background tasks start when a server starts the application, and
    stop when it shuts down. Its parts hang on `app.state`, where routes find them.
    """
    store = Store(settings.data_directory)
    ledger = Ledger(settings.ledger)
    keys = Keys(ledger.database)
    process_pool = ProcessPool(settings.workers, (calculations.__name__, work.__name__))
    workers = Cluster(settings.scheduler) if settings.scheduler else process_pool
    runner = Runner(ledger, store, workers, settings)
    admission = Admission(ledger, store, settings, runner.wake, runner.waiting_reason)
    writer = Writer(store, admission.make_room, settings, process_pool)
    warmth = Warmth()

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        """Start jobs and background tasks of the service, and stop them in order at its shutdown.

        FastAPI enters it before the first request and leaves it after the last; `app` is the
        application.
        """
        current_default_thread_limiter().total_tokens = THREADS
        app.state.large_slices = CapacityLimiter(os.cpu_count() or 1)
        if (traces_fault := traces.fault()) is not None:
            logger.warning(traces_fault)
        process_pool.open()
        await runner.start()
        stopping = asyncio.Event()
        tidying = asyncio.create_task(_tidy(admission, stopping))
        background = [asyncio.create_task(app.state.metrics.watch_loop())]
        if settings.warm_at_start:
            background.append(asyncio.create_task(warmth.compile()))
            background.append(asyncio.create_task(process_pool.start()))
        yield
        await runner.stop()  # first of all: others may go on with the work
        for task in background:
            task.cancel()
        stopping.set()
        await tidying
        await asyncio.to_thread(process_pool.close)
        ledger.close()
        if spans is not None:
            await asyncio.to_thread(spans.close)

    app = FastAPIOffline(
        docs_url=None,  # `page` has its own, without a script within it
        redoc_url=None,
        title="vibrafeed",
        version=core.__version__,
        description="Compute how parts move on vibratory feeder tracks: parameter sweeps of "
        "closed-form equations, and simulated motion in time.",
        lifespan=lifespan,
        generate_unique_id_function=openapi.operation_id,
    )
    app.state.settings = settings
    app.state.store = store
    app.state.writer = writer
    app.state.admission = admission
    app.state.keys = keys
    app.state.large_shares = FairQueue(max(2, CORES))
    app.state.lists = FairQueue(CORES + 1, max_of_owner=1)
    app.state.process_pool = process_pool
    app.state.one_document = CapacityLimiter(1)
    app.state.views = ZarrViews(store)
    app.state.warmth = warmth
    app.state.metrics = Metrics()  # other parts add gauges
    # Of (name, check): see `vibrafeed.app.web.routes.health.readyz`.
    app.state.readiness = [("jobs", runner.fault), ("ledger", ledger.fault)]
    app.state.stopping = threading.Event()  # set by a signal: open streams end
    watch_jobs(app.state.metrics, admission, workers.alive, settings)
    runner.observers.append(app.state.metrics)
    spans = traces.configured()
    if spans is not None:
        runner.observers.append(spans)
        admission.posted = spans.posted
    problems.install(app)
    studies = (scenes, figures, friction, convert, sweeps)
    for part in (health, *studies, zarr, processes, jobs, results):
        app.include_router(part.router)
    page.install(app)
    openapi.install(app, keys)
    guard.install(app, settings, keys, app.state.stopping)
    app.add_middleware(Observe, metrics=app.state.metrics, traces=spans)
    return app


async def _tidy(admission: Admission, stopping: asyncio.Event) -> None:
    """Tidy the data directory at intervals until the service stops.

    `admission` removes what is old; `stopping` is the event that ends the loop. Errors go to the
    log, and the loop continues.
    """
    while not stopping.is_set():
        try:
            await asyncio.to_thread(admission.tidy)
        except Exception:
            logger.exception("tidying failed")
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(TIDY):
                await stopping.wait()
