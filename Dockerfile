# syntax=docker/dockerfile:1
FROM python:3.11-slim-bookworm AS build
# Add `tables` for results as Parquet: --build-arg EXTRAS=plot,serve,cluster,postgres,traces,tables
ARG EXTRAS=plot,serve,cluster,postgres,traces
WORKDIR /build
COPY pyproject.toml constraints.txt README.md LICENSE ./
COPY app app
COPY core core
COPY vibrafeed vibrafeed
COPY configs configs
RUN python -m venv /opt/vibrafeed \
    && /opt/vibrafeed/bin/python -m pip install --no-cache-dir --constraint constraints.txt ".[${EXTRAS}]"

FROM python:3.11-slim-bookworm
WORKDIR /srv/vibrafeed
RUN useradd --system --uid 10001 --home-dir /srv/vibrafeed vibrafeed \
    && install -d -o vibrafeed /var/lib/vibrafeed /var/cache/vibrafeed
COPY --from=build /opt/vibrafeed /opt/vibrafeed
COPY configs configs
ENV PATH=/opt/vibrafeed/bin:$PATH \
    PYTHONUNBUFFERED=1 \
    NUMBA_CACHE_DIR=/var/cache/vibrafeed \
    VIBRAFEED_DATA_DIRECTORY=/var/lib/vibrafeed
USER 10001
# Nobody waits for the compiler. It compiles for the processor that builds, or for the one that is
# named, as in --build-arg NUMBA_CPU_NAME=x86-64-v3 (run with the same name); elsewhere the service
# compiles when it starts, beside its work.
ARG NUMBA_CPU_NAME
RUN python -m vibrafeed.core.warm
VOLUME /var/lib/vibrafeed
EXPOSE 8000
HEALTHCHECK --interval=30s --timeout=5s --start-period=10s \
    CMD ["python", "-c", "import urllib.request as r; r.urlopen('http://127.0.0.1:8000/healthz', timeout=3)"]
# One process: it owns the NetCDF writer. It listens to other machines, so it starts only where there
# are keys: `vibrafeed key add` on its volume, or VIBRAFEED_API_KEY_HASHES; see docs/operations.md.
CMD ["vibrafeed", "serve", "--host", "0.0.0.0", "--port", "8000"]
