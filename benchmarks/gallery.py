"""`python -m benchmarks.gallery` makes docs/gallery.md and its pictures from configs/gallery.

Each picture is made by the two commands that stand beside it on the page.
"""

from __future__ import annotations

import contextlib
import shlex
import shutil
import tempfile
from dataclasses import dataclass
from pathlib import Path

from PIL import Image

from vibrafeed.app.cli import app

ROOT = Path(__file__).parents[1]
STUDIES = ROOT / "configs" / "gallery"
PICTURES = ROOT / "docs" / "gallery"
PAGE = ROOT / "docs" / "gallery.md"
WIDTHS = (1000, 800, 640)  # dots
COLOURS = (256, 128, 64)  # of a PNG: flat colours need few, and the file is a third as large
LARGEST = 150_000  # bytes of a PNG


@dataclass(frozen=True)
class Picture:
    """A picture of the gallery.

    Attributes
    ----------
    file : str
        Its name in docs/gallery.
    asks : str
        The question that it answers.
    studies : tuple of str
        Names of the studies, without folder and suffix.
    options : str
        Options of `vibrafeed plot`.
    judged : str
        What it shows well, and what not.
    """

    file: str
    asks: str
    studies: tuple[str, ...]
    options: str
    judged: str

    def commands(self) -> list[str]:
        """Return the commands that make the picture, run from the repository's root."""
        runs = [f"vibrafeed run configs/gallery/{name}.toml -o {name}.nc" for name in self.studies]
        files = " ".join(f"{name}.nc" for name in self.studies)
        options = f" {self.options}" if self.options else ""
        return [*runs, f"vibrafeed plot {files}{options} -o {self.file}"]


GALLERY = (
    Picture(
        "amplitude.png", "What happens when I turn up the amplitude?", ("amplitude",), "-k line",
        "where the part begins to hop, and where it no longer repeats every period, stands in the "
        "colours behind the curve; the borders are those of the grid.",
    ),
    Picture(
        "drive-levels.png", "How fast, and in which way, over amplitude and angle?", ("drive",),
        "-k levels",
        "speeds are read off the lines while the colours stay those of the regimes, and the "
        "hatched strip warns that a flat drive carries parts backward down the climb; kinks "
        "of the lines in the corner of doubled periods are true, yet look like noise, and "
        "only every second line has room for its number.",
    ),
    Picture(
        "drive-map.png", "Where does it stick, slide and hop?", ("drive",), "-k map",
        "regimes are separated at a glance and in grey print, by their names; how fast the "
        "part is cannot be seen, and the steps of the borders are those of the grid.",
    ),
    Picture(
        "drive-contour.png", "Where is the fastest drive?", ("drive",), "-k contour",
        "the fastest drive is found at once, at 0.7 mm and 23 degrees; regimes are hatches "
        "here and fight with the lines, for which the lines over pale areas are the better "
        "picture.",
    ),
    Picture(
        "friction.png", "Which angle suits which friction?", ("frictions",),
        "-k line -a beta,friction",
        "one look says that slippery parts want a steep drive, 58 degrees against 38; the "
        "family is easy to follow up to five curves, and beyond 60 degrees, where they run "
        "into each other, not at all.",
    ),
    Picture(
        "oil.png", "What does oil change?", ("amplitude", "amplitude-oiled"),
        "-v conveying_velocity",
        "the message is plain: with oil the same drive runs backward until 0.39 mm, and "
        "beyond it oil hardly matters; what the part does along the way is not shown, so look "
        "at each by itself, too.",
    ),
    Picture(
        "hop.png", "What does one part do in a period?", ("hop",), "",
        "height, velocity and way share one time, so that cause and effect stand above each "
        "other: it takes off while the track rises, once that slows down faster than a part "
        "falls, and loses speed at the landing; who has never seen such a picture needs the "
        "animation first.",
    ),
    Picture(
        "hop.gif", "How does that look, slowly?", ("hop",), "--slow 50",
        "shows in three seconds what takes a page to write: the track throws the part and "
        "lands behind it; the part's size is not its own, since the model has none, and a "
        "short slide forward lasts less than a frame, so only the strip shows it.",
    ),
    Picture(
        "wall.png", "Does the part leave the wall?", ("wall",), "",
        "the fourth panel answers it: the part leaves the wall for most of the period, by "
        "0.07 mm, and comes back to it with the next stroke; across and along are not seen "
        "together.",
    ),
    Picture(
        "tumble.png", "How does a dropped part come to rest?", ("tumble",), "",
        "outlines and the path of the middle show the fall well, and the lower panels say when "
        "it strikes; the upper panel is narrow because it is true to scale, and its outlines "
        "crowd where the pin rolls over.",
    ),
    Picture(
        "tumble.gif", "How does the fall look?", ("tumble",), "--slow 20",
        "the fall is understood without a word, at the part's own size and true to scale; the "
        "many small impacts at its end pass too fast to be counted even twenty times slower.",
    ),
    Picture(
        "accelerations.png", "What does the formula of the thesis say?", ("accelerations",),
        "-k contour -v acceleration_x",
        "the border between slip and flight is plain, and what lies above it is pale and "
        "hatched as it should be; the numbers of the upper half are of no use, so half of the "
        "picture says where not to look.",
    ),
    Picture(
        "front.png", "What does speed cost across the track?", ("front",), "-k front",
        "three clear lines, each with its knee; the scale makes much of differences of one "
        "per cent, so read the numbers before you trade anything.",
    ),
    Picture(
        "angles.png", "Which two angles are best, and what limits them?", ("angles",),
        "-k landscape",
        "optimum and both limits meet in one corner, which is the answer: floor and wall "
        "decide, not the objective; nine tenths of the picture are excluded and only frame "
        "it.",
    ),
)  # fmt: skip


def draw_all(folder: Path) -> None:
    """Run all studies and draw all pictures in a folder."""
    for name in sorted({name for picture in GALLERY for name in picture.studies}):
        _vibrafeed(folder, f"run {shlex.quote(str(STUDIES / name))}.toml -o {name}.nc")
    for picture in GALLERY:
        _vibrafeed(folder, picture.commands()[-1].removeprefix("vibrafeed "))


def shrink(source: Path, target: Path) -> None:
    """Copy a picture, reduced to the colours and width that a page needs."""
    if source.suffix != ".png":
        shutil.copyfile(source, target)
        return
    with Image.open(source) as picture:
        for width in WIDTHS:
            height = round(picture.height * width / picture.width)
            small = picture.convert("RGB").resize((width, height), Image.Resampling.LANCZOS)
            for colours in COLOURS:
                small.quantize(colours, dither=Image.Dither.NONE).save(target, optimize=True)
                if target.stat().st_size < LARGEST:
                    return


def page() -> str:
    """Return the text of the gallery page."""
    parts = [
        "# Gallery\n",
        "Every kind of picture, each with the question that it answers and the study that made it."
        " `python -m benchmarks.gallery` carries out all studies and draws all pictures anew. A"
        " sentence says how each was judged when it was opened: what it shows well, and what"
        " not.\n",
    ]
    for picture in GALLERY:
        studies = ", ".join(
            f"[{name}.toml](../configs/gallery/{name}.toml)" for name in picture.studies
        )
        parts += [
            f"## {picture.asks}\n",
            f"![{picture.asks}](gallery/{picture.file})\n",
            "```sh\n" + "\n".join(picture.commands()) + "\n```\n",
            f"Study: {studies}. Opened and judged: {picture.judged}\n",
        ]
    return "\n".join(parts)


def _vibrafeed(folder: Path, command: str) -> None:
    """Run a vibrafeed command in a folder, in this process to save loading time."""
    with contextlib.chdir(folder):
        app(shlex.split(command), standalone_mode=False)


def main() -> None:
    """Make all pictures and the gallery page."""
    PICTURES.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as name:
        draw_all(Path(name))
        for picture in GALLERY:
            shrink(Path(name) / picture.file, PICTURES / picture.file)
            size = (PICTURES / picture.file).stat().st_size
            print(f"{picture.file}: {size / 1000:.0f} kB")
    PAGE.write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main()
