"""The page in Debian's Firefox: from the empty page to a drawn map and a file."""

from __future__ import annotations

import asyncio
import csv

from bidi import firefox
from tools import tool
from waiting import PATIENCE

LINK = (
    "#question=speed&kind=simulate&scene=rectangle-on-plane&output=conveying_velocity"
    "&x=amplitude:0.0001:0.0007&y=beta:5:60&p.frequency=50&p.friction=0.4"
)
SHOWN = """document.getElementById("progress")?.textContent === 'Shown.'"""
MIDDLE = """(() => {
  const box = document.querySelector("#picture .map").getBoundingClientRect();
  return `${box.x + box.width / 2} ${box.y + box.height / 2}`;
})()"""
PAINTED = """(() => {
  const { width, height } = document.querySelector("#picture canvas");
  const { size } = document.querySelector("#picture .map").dataset;
  const { data } = document.querySelector("#picture canvas").getContext("2d")
    .getImageData(0, 0, width, height);
  return `${size}, ${new Set(new Uint32Array(data.buffer)).size > 8}`;
})()"""
SAVE = """(() => {
  document.getElementById("take-away").click();
  const items = [...document.querySelectorAll("#away-menu button")];
  items.find((one) => one.textContent === "Table (CSV)").click();
})()"""


async def carried_out(program, address, folder):
    async with firefox(program, folder) as tab:
        await tab.go(f"{address}/{LINK}")
        await tab.until(SHOWN)
        painted = await tab.evaluate(PAINTED)
        await tab.click(*map(float, (await tab.evaluate(MIDDLE)).split()))
        await tab.until("""document.querySelector("#detail .panels polyline")""")
        said = await tab.evaluate("""document.querySelector("#answer .answer").textContent""")
        await tab.evaluate(SAVE)
        await tab.until("""document.getElementById("away").textContent.includes("is saved")""")
        text = ""
        async with asyncio.timeout(PATIENCE):
            while not text:
                text = "".join(path.read_text() for path in (folder / "saved").glob("*.csv"))
                await asyncio.sleep(0.05)
        return painted, said, text, tab


def test_from_the_empty_page_to_a_file(address, tmp_path):
    program = tool("firefox-esr", "firefox")
    painted, said, text, tab = asyncio.run(carried_out(program, address, tmp_path))
    values, colours = painted.split(", ")
    across, up = map(int, values.split(" x "))
    assert across == up
    assert 30 < up <= 100  # as fine as this machine draws it in time, and finer than at first
    assert colours == "true"
    assert "mm/s" in said
    rows = list(csv.DictReader(text.splitlines()))
    assert len(rows) == across * up
    assert {"amplitude [m]", "beta [degree]", "conveying_velocity [m s-1]"} <= set(rows[0])
    assert tab.told == []
    assert all(one.startswith((address, "data:", "blob:")) for one in tab.asked), tab.asked
