"""How fast the page is, in a browser: frames of a dragged slider, maps of motion, first picture.

    python -m benchmarks.page [--runs 5]

Server and browser are on this machine; the server has answered the same before, the browser's cache
is empty where a page is loaded. A picture counts when new data of it are drawn.
"""

from __future__ import annotations

import gzip
import statistics
from typing import Any

from benchmarks.browsing import browsed
from benchmarks.options import options
from benchmarks.serving import Served, served

# Notes when a map's colours are drawn, and whether they are others than before.
WITNESS = """
window.drawn = [];
{
  const put = CanvasRenderingContext2D.prototype.putImageData;
  let before = 0;
  CanvasRenderingContext2D.prototype.putImageData = function (image, ...rest) {
    put.call(this, image, ...rest);
    const words = new Int32Array(image.data.buffer);
    let sum = words.length;
    for (let i = 0; i < words.length; i++) sum = (Math.imul(sum, 31) + words[i]) | 0;
    if (sum === before) return;
    before = sum;
    // The frame in which it is seen: two pictures within one are one.
    requestAnimationFrame((at) => {
      const size = document.querySelector("#host .map").dataset.size.split(" x ").map(Number);
      if (window.drawn.at(-1)?.at !== at) window.drawn.push({ at, size });
    });
  };
}
"""
CLOSED = (
    "/#question=all&kind=sweep&scene=rectangle-on-track&output=acceleration_x"
    "&x=amplitude:0.0001:0.001&y=beta:5:60&p.radius=0.3"
)
MOTION = (
    "/#question=speed&kind=simulate&scene=rectangle-on-plane&output=conveying_velocity"
    "&x=amplitude:0.0001:0.001&y=beta:5:60&p.frequency=50&p.friction={friction}"
)
FINISHED = """() =>
  document.getElementById("progress")?.textContent === "Shown." &&
  document.getElementById("picture").getAttribute("aria-busy") === "false"
"""


def finished(page: Any) -> None:
    """Wait until the page reports that its picture is complete."""
    page.wait_for_function(FINISHED)


def dragged(page: Any, address: str, *, steps: int = 150) -> tuple[float, tuple[int, int]]:
    """Return frames per second while a slider is dragged, and the map's size."""
    page.goto("about:blank")
    page.goto(address + CLOSED)
    finished(page)
    page.locator("#expert > summary").click()
    slider = page.get_by_label("Drive azimuth, slider")
    slider.scroll_into_view_if_needed()
    box = slider.bounding_box()
    middle = box["y"] + box["height"] / 2

    def along(share: float) -> float:
        """Return the horizontal position at a share of the slider."""
        return float(box["x"] + (0.05 + 0.9 * share) * box["width"])

    page.mouse.move(along(0), middle)
    page.mouse.down()
    page.mouse.move(along(0.02), middle)
    page.wait_for_function("() => window.drawn.length > 1")
    page.evaluate("window.drawn = []; window.begun = performance.now(); 0")
    # There and back again; each step comes once the browser has taken the one before.
    page.mouse.move(along(1), middle, steps=steps // 2)
    page.mouse.move(along(0), middle, steps=steps // 2)
    seconds = page.evaluate("(performance.now() - window.begun) / 1000")
    drawn = page.evaluate("window.drawn")
    page.mouse.up()
    finished(page)
    return len(drawn) / seconds, tuple(drawn[-1]["size"])


def moved(page: Any, address: str, friction: float) -> tuple[float, tuple[int, int]]:
    """Return the time from a typed friction to the finished motion map, and its size."""
    page.goto("about:blank")
    page.goto(address + MOTION.format(friction=0.3))
    finished(page)
    page.locator("#part > summary").click()
    page.evaluate(
        """() => {
          document.getElementById("value-friction").addEventListener("change", () => {
            window.begun = performance.now();
            window.drawn = [];
            document.getElementById("progress").textContent = "";
          }, { capture: true });
        }"""
    )
    page.locator("#value-friction").fill(str(friction))
    page.keyboard.press("Tab")
    finished(page)
    page.wait_for_function("() => window.drawn.length > 0")
    last = page.evaluate("window.drawn.at(-1)")
    begun = page.evaluate("window.begun")
    return (last["at"] - begun) / 1000, tuple(last["size"])


def loaded(page: Any, address: str) -> tuple[float, float, float]:
    """Return the times to the first and the complete picture of a cold load, and its kB.

    The bytes are those that a proxy sends, which compresses replies.
    """
    session = page.context.new_cdp_session(page)
    session.send("Network.setCacheDisabled", {"cacheDisabled": True})
    session.send("Network.enable")
    replies: list[str] = []
    session.on("Network.loadingFinished", lambda event: replies.append(event["requestId"]))
    page.goto(f"{address}/")
    finished(page)
    first, last = page.evaluate("[window.drawn[0].at, window.drawn.at(-1).at]")
    size = 0
    for reply in replies:
        body = session.send("Network.getResponseBody", {"requestId": reply})
        size += len(gzip.compress(body["body"].encode()))
    session.detach()
    return first / 1000, last / 1000, size / 1000


def opened(context: Any) -> Any:
    """Return a page that records its drawing."""
    page = context.new_page()
    page.add_init_script(WITNESS)
    page.set_default_timeout(60_000)
    return page


def measure(server: Served, context: Any, runs: int) -> None:
    """Print median and extremes of each measurement."""
    page = opened(context)
    loaded(page, server.address)

    def told(title: str, unit: str, values: list[float]) -> None:
        """Print one measurement."""
        print(
            f"{title:<64}{statistics.median(values):>8.3g} {unit}"
            f"   ({min(values):.3g} to {max(values):.3g})"
        )

    frames = [dragged(page, server.address) for _ in range(runs)]
    (nx, ny) = frames[0][1]
    told(
        f"slice of {nx} x {ny} redrawn while a slider is dragged",
        "frames/s",
        [f for f, _ in frames],
    )
    maps = [moved(page, server.address, 0.31 + 0.01 * run) for run in range(runs)]
    (nx, ny) = maps[0][1]
    told(f"map of motion of {nx} x {ny}, from the field to the picture", "s", [s for s, _ in maps])
    page.close()
    loads = []
    for _ in range(runs):
        page = opened(context)
        loads.append(loaded(page, server.address))
        page.close()
    told(
        "first picture of a page that is loaded for the first time",
        "s",
        [one for one, _, _ in loads],
    )
    told("whole picture of it", "s", [one for _, one, _ in loads])
    told("what it loads, as it is sent", "kB", [one for _, _, one in loads])


def main() -> None:
    """Run all measurements of the page and print them."""
    given = options(__doc__, runs=5)
    with served(workers=1) as server, browsed() as context:
        measure(server, context, given.runs)


if __name__ == "__main__":
    main()
