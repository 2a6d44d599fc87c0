"""What a plane of a huge sweep takes over HTTP by Zarr clients: chunks as they are, and wished for.

    python -m benchmarks.chunks

The sweep has 10^12 cells on four axes; the plane has 10^6, over two of them. The same plane as a
binary slice is the limit.
"""

from __future__ import annotations

import time
import urllib.request
from typing import Any

import xarray

from benchmarks.serving import served

OUTPUT = "transport_velocity"
AXES = ("frequency", "amplitude", "alpha", "beta")
PLANES = (("frequency", "beta"), ("alpha", "beta"))
STUDY: dict[str, Any] = {
    "kind": "sweep",
    "scene": "rectangle-on-track",
    "outputs": [OUTPUT],
    "parameters": {
        "frequency": {"start": 20, "stop": 120, "num": 1000},
        "amplitude": {"start": 1e-4, "stop": 1e-3, "num": 1000},
        "alpha": {"start": 0, "stop": 80, "num": 1000},
        "beta": {"start": 0, "stop": 80, "num": 1000},
        "friction": 0.3,
        "radius": 0.8,
        "distance": 2e-4,
    },
}


def main() -> None:
    """Print the table."""
    with served() as server:
        key = server.post("/sweeps", STUDY)["id"]
        sweep = f"{server.address}/sweeps/{key}"
        for plane in PLANES:
            others = [name for name in AXES if name not in plane]
            wishes = ",".join(f"{name}:all" for name in plane)
            for name, path in (
                ("binary slice", None),
                ("chunks as they are", "zarr"),
                (f"chunks={wishes}", f"zarr/chunks={wishes}"),
            ):
                started = time.perf_counter()
                if path is None:
                    first = {name: STUDY["parameters"][name]["start"] for name in others}
                    asked = "&".join(f"{name}={value}" for name, value in first.items())
                    free = ",".join(plane)
                    address = f"{sweep}/slice?output={OUTPUT}&axes={free}&{asked}&format=binary"
                    with urllib.request.urlopen(address, timeout=600) as reply:
                        reply.read()
                else:
                    group = xarray.open_zarr(f"{sweep}/{path}", chunks=None)
                    group[OUTPUT].isel(dict.fromkeys(others, 0)).load()
                took = time.perf_counter() - started
                print(f"{' x '.join(plane):20} {name:36} {took:8.2f} s", flush=True)


if __name__ == "__main__":
    main()
