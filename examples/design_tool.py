"""A small design tool: finds the drive's angles that push a part best along a leaning track.

It uses the service over HTTP only. It lists the scenes, posts a sweep over the drive's angles,
reads a slice of it, asks for the best angles, follows a simulation of the true motion there,
downloads its NetCDF file, and draws all of it. Start `vibrafeed serve`, then

    python examples/design_tool.py --output results/design.png

It needs httpx2, xarray with netCDF4, and matplotlib.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import httpx2
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import xarray
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

# What is given: the drive's vibration, the part's friction, the track's slope and lean. A scene
# that does not know one of them goes without it.
DESIGN = {"frequency": "60 Hz", "friction": 0.4, "gamma": "3 deg", "delta": "15 deg"}
AMPLITUDE = "0.3 mm"
ANGLES = {
    "alpha": {"start": "0 deg", "stop": "15 deg", "num": 61},
    "beta": {"start": "0 deg", "stop": "40 deg", "num": 161},
}


def main() -> None:
    """Ask, compute, draw."""
    wishes = parsed()
    headers = {"Authorization": f"Bearer {wishes.key}"} if wishes.key else {}
    with httpx2.Client(base_url=wishes.address, headers=headers, timeout=120) as service:
        scene = checked_scene(service, wishes.scene)
        output = wishes.outputs[0]
        print(f"{scene['title']}: {output} over alpha and beta")
        design = known(scene["parameters"])
        piece = swept(service, scene["name"], wishes.outputs, design)
        best = optimised(service, scene["name"], output, design)
        print(f"best: {output} = {best[output]:.4g} at {angles_of(best)}")
        wishes.output.parent.mkdir(parents=True, exist_ok=True)
        file = wishes.output.with_suffix(".nc")
        simulated(service, scene, best, wishes.points, file)
    with xarray.open_dataset(file, decode_times=False) as motion:
        draw(piece, best, output, motion, wishes.output)
    print(f"wrote {file} and {wishes.output}")


def parsed() -> argparse.Namespace:
    """Return the arguments."""
    parser = argparse.ArgumentParser(description=__doc__, allow_abbrev=False)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("--address", default="http://127.0.0.1:8000", help="of the service")
    parser.add_argument("--key", help="where the service asks for one")
    parser.add_argument("--scene", default="rectangle-on-track")
    parser.add_argument(
        "--outputs", nargs="+", default=["acceleration_x"], help="the first one is made largest"
    )
    parser.add_argument("--points", type=int, default=76, help="amplitudes of the simulation")
    parser.add_argument("--output", type=Path, default=Path("design.png"), help="the picture")
    return parser.parse_args()


def answer(reply: httpx2.Response) -> Any:
    """Return the JSON of a reply; exit with what the service says is wrong."""
    if reply.is_error:
        document = reply.json()
        wrong = [f"  {e['place']}: {e['message']}. {e['fix']}." for e in document.get("errors", [])]
        raise SystemExit("\n".join([f"{document['title']}. {document['detail']}", *wrong]))
    return reply.json()


def checked_scene(service: httpx2.Client, name: str) -> dict[str, Any]:
    """Return a scene whose motion can be simulated; exit with their names if it is none."""
    names = [scene["name"] for scene in answer(service.get("/scenes")) if scene["methods"]]
    if name not in names:
        raise SystemExit(f"'{name}' is none of the scenes with motion in time: {', '.join(names)}.")
    return answer(service.get(f"/scenes/{name}"))


def known(parameters: list[dict[str, Any]]) -> dict[str, Any]:
    """Return what is given of these parameters."""
    return {p["name"]: DESIGN[p["name"]] for p in parameters if p["name"] in DESIGN}


def swept(
    service: httpx2.Client, scene: str, outputs: list[str], design: dict[str, Any]
) -> dict[str, Any]:
    """Post a sweep over both angles; return the slice of the first output."""
    study = {
        "kind": "sweep",
        "scene": scene,
        "outputs": outputs,
        "parameters": {**design, "amplitude": AMPLITUDE, **ANGLES},
    }
    sweep = answer(service.post("/sweeps", json=study))
    wish = {"output": outputs[0], "axes": "beta,alpha"}
    return answer(service.get(sweep["links"]["slice"], params=wish))


def optimised(
    service: httpx2.Client, scene: str, output: str, design: dict[str, Any]
) -> dict[str, float]:
    """Return the best angles, and the output there; the part keeps floor and wall."""
    study = {
        "scene": scene,
        "criterion": {"kind": "maximise", "output": output},
        "variables": {
            name: {"lower": axis["start"], "upper": axis["stop"]} for name, axis in ANGLES.items()
        },
        "parameters": {**design, "amplitude": AMPLITUDE},
    }
    reply = service.post("/processes/optimise/execution", json=study, headers={"Prefer": "wait=60"})
    found = answer(reply)
    if reply.status_code == 201:
        raise SystemExit("The best angles are not found within a minute.")
    if "dataset" in found:  # it was long enough to become a job
        found = answer(service.get(found["dataset"]["href"], params={"format": "json"}))
    variables = found["variables"]
    best = {name: variables[f"best_{name}"]["data"] for name in ANGLES}
    return {**best, output: variables[output]["data"]}


def simulated(
    service: httpx2.Client, scene: dict[str, Any], best: dict[str, float], points: int, file: Path
) -> None:
    """Simulate the true motion over the drive's amplitude at the best angles; keep the file."""
    wish = {"method": scene["methods"][0]}
    parameters = answer(service.get(f"/scenes/{scene['name']}", params=wish))["parameters"]
    angles = {p["name"]: round(best[p["name"]], 6) for p in parameters if p["name"] in ANGLES}
    amplitudes = {"start": "0.05 mm", "stop": "0.8 mm", "num": points}
    study = {
        "scene": scene["name"],
        "outputs": ["conveying_velocity", "flight_fraction"],
        "parameters": {**known(parameters), **angles, "amplitude": amplitudes},
    }
    execution, wish = "/processes/simulate/execution", {"Prefer": "respond-async"}
    job = answer(service.post(execution, json=study, headers=wish))
    links = {link["rel"]: link["href"] for link in job["links"]}
    with service.stream("GET", links["monitor"], timeout=None) as events:
        for line in events.iter_lines():
            if line.startswith("data: "):
                job = json.loads(line.removeprefix("data: "))
                print(f"simulation {job['status']}, {job['progress']} %: {job['message']}")
    if job["status"] != "successful":
        raise SystemExit(job["message"])
    results = answer(service.get(f"{links['self']}/results"))
    with service.stream("GET", results["dataset"]["href"]) as download, file.open("wb") as out:
        download.raise_for_status()
        for part in download.iter_bytes():
            out.write(part)


def angles_of(best: dict[str, float]) -> str:
    """Return the best angles for a line of text."""
    return ", ".join(f"{name} = {best[name]:.2f} deg" for name in ANGLES)


def draw(
    piece: dict[str, Any],
    best: dict[str, float],
    output: str,
    motion: xarray.Dataset,
    path: Path,
) -> None:
    """Draw the slice with its optimum, and the true motion beside it."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(12, 5), layout="constrained")
    axes = {axis["name"]: np.array(axis["values"]) for axis in piece["axes"]}
    alpha, beta = axes["alpha"], axes["beta"]
    values = np.array(piece["values"]["data"], dtype=float)
    dims = piece["values"]["dims"]
    regime = np.array(piece["regime"]["data"])
    if dims[0] == "alpha":
        values = values.T
    if piece["regime"]["dims"][0] == "alpha":
        regime = regime.T
    filled = left.contourf(alpha, beta, values, levels=20)
    figure.colorbar(filled, ax=left, label=f"{output} [{piece['unit']}]")
    # Where the part leaves the floor or the wall, the closed forms describe it no longer.
    gone = [flag["value"] for flag in piece["regimes"].values() if not flag["valid"]]
    left.contourf(alpha, beta, np.isin(regime, gone), levels=[0.5, 1.5], colors="black", alpha=0.45)
    left.plot(best["alpha"], best["beta"], "*", color="red", markersize=14)
    left.set_xlabel("alpha [degree]")
    left.set_ylabel("beta [degree]")
    left.set_title(f"Closed form, amplitude {AMPLITUDE}")
    left.legend(
        handles=[
            Line2D([], [], marker="*", color="red", linestyle="", markersize=12, label="best"),
            Patch(facecolor="black", alpha=0.45, label="it leaves floor or wall"),
        ]
    )
    millimetres = motion.amplitude * 1000
    right.plot(millimetres, motion.conveying_velocity * 1000)
    airborne = motion.flight_fraction > 0
    right.fill_between(
        millimetres, 0, 1, where=airborne, transform=right.get_xaxis_transform(),
        color="black", alpha=0.2, label="it hops",
    )  # fmt: skip
    right.set_xlabel("amplitude [mm]")
    right.set_ylabel("conveying velocity [mm/s]")
    right.set_title(f"Motion in time, {angles_of(best)}")
    right.legend()
    figure.savefig(path, dpi=120)


if __name__ == "__main__":
    main()
