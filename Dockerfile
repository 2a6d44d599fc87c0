# syntax=docker/dockerfile:1
# Both stages have the same base, by the digest of its index for all processors. A later one:
# docker buildx imagetools inspect python:3.11-slim-bookworm
FROM python:3.11-slim-bookworm@sha256:a36c24f9cbdf4fd0f52d67f0823eeac19c2028c637cecc392d97f980d4fec56b AS build
RUN apt-get update \
    && apt-get install -y --no-install-recommends "binutils=2.40-*" "tini=0.19.0-*" \
    && rm -rf /var/lib/apt/lists/*
WORKDIR /build
COPY requirements-image.txt ./
# Without the tests of packages, and symbols that nobody reads: 640 MB instead of 900.
RUN python -m venv --without-pip /opt/vibrafeed \
    && python -m pip --python /opt/vibrafeed/bin/python install --no-cache-dir --only-binary :all: \
        --require-hashes --requirement requirements-image.txt \
    && find /opt/vibrafeed -depth -type d \( -name tests -o -name test \) -exec rm -rf {} + \
    && find /opt/vibrafeed -name '*.so' -not -path '*.libs/*' -exec strip --strip-unneeded {} +
COPY pyproject.toml README.md LICENSE ./
COPY app app
COPY core core
COPY vibrafeed vibrafeed
COPY configs configs
RUN python -m pip --python /opt/vibrafeed/bin/python install --no-cache-dir \
    --no-deps --no-build-isolation --no-index .

FROM python:3.11-slim-bookworm@sha256:a36c24f9cbdf4fd0f52d67f0823eeac19c2028c637cecc392d97f980d4fec56b
WORKDIR /srv/vibrafeed
RUN useradd --no-log-init --uid 10001 --home-dir /srv/vibrafeed vibrafeed \
    && install -d -o vibrafeed /var/lib/vibrafeed /var/cache/vibrafeed
COPY --from=build /usr/bin/tini /usr/bin/tini
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
# Of the shell: a Python each time would take a hundred times the processor time.
HEALTHCHECK --interval=30s --timeout=5s --start-period=60s \
    CMD ["bash", "-c", "exec 3<>/dev/tcp/127.0.0.1/8000 && printf 'GET /healthz HTTP/1.1\\r\\nHost: localhost\\r\\nConnection: close\\r\\n\\r\\n' >&3 && read -r _ status _ <&3 && [ \"$status\" = 200 ]"]
ENTRYPOINT ["tini", "--"]
# One process: it owns the NetCDF writer. It listens to other machines, so it starts only where there
# are keys: `vibrafeed key add` on its volume; see docs/operations.md.
CMD ["vibrafeed", "serve", "--host", "0.0.0.0", "--port", "8000"]
