"""The gallery of the site: `python -m benchmarks.gallery` draws the pictures in docs/gallery.

Each picture is made by its study and the command on the page, docs/generated/gallery.md.
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
    shows : str
        What to see in it.
    """

    file: str
    asks: str
    studies: tuple[str, ...]
    options: str
    shows: str

    def command(self) -> str:
        """Return the command that draws the picture from the results of its studies."""
        files = " ".join(f"{name}.nc" for name in self.studies)
        options = f" {self.options}" if self.options else ""
        return f"vibrafeed plot {files}{options} -o {self.file}"


GALLERY = (
    Picture(
        "amplitude.png", "What happens when I turn up the amplitude?", ("amplitude",), "-k line",
        "The colours behind the curve show where the part begins to hop, and where it no longer "
        "repeats every period.",
    ),
    Picture(
        "drive-levels.png", "How fast is it, over amplitude and angle?", ("drive",), "-k levels",
        "Lines are speeds, colours are regimes. In the hatched strip a flat drive carries parts "
        "backward down the climb. The kinks at doubled periods are real.",
    ),
    Picture(
        "drive-map.png", "Where does it stick, slide and hop?", ("drive",), "-k map",
        "The names separate the regimes in grey print, too. The steps of the borders are those "
        "of the grid.",
    ),
    Picture(
        "drive-contour.png", "Where is the fastest drive?", ("drive",), "-k contour",
        "The fastest drive is at 0.7 mm and 23 degrees. Hatches are regimes.",
    ),
    Picture(
        "friction.png", "Which angle suits which friction?", ("frictions",),
        "-k line -a beta,friction",
        "Slippery parts need a steep drive: 58 degrees instead of 38.",
    ),
    Picture(
        "oil.png", "What does oil change?", ("amplitude", "amplitude-oiled"),
        "-v conveying_velocity",
        "With oil the same drive conveys backward up to 0.39 mm. Beyond, oil hardly matters.",
    ),
    Picture(
        "hop.png", "What does one part do in a period?", ("hop",), "",
        "Height, velocity and distance share one time. The part takes off when the rising track "
        "slows down faster than a part falls, and loses speed at the landing.",
    ),
    Picture(
        "hop.gif", "How does that look, slowly?", ("hop",), "--slow 50",
        "The track throws the part and lands behind it. The model has no size of the part, so "
        "its size is arbitrary. A slide shorter than a frame is visible in the strip only.",
    ),
    Picture(
        "wall.png", "Does the part leave the wall?", ("wall",), "",
        "The fourth panel shows it: the part leaves the wall for most of the period, by 0.07 mm, "
        "and returns with the next stroke.",
    ),
    Picture(
        "tumble.png", "How does a dropped part come to rest?", ("tumble",), "",
        "The upper panel shows the outlines to scale, the lower panels the impacts.",
    ),
    Picture(
        "tumble.gif", "How does the fall look?", ("tumble",), "--slow 20",
        "The part has its own size, true to scale.",
    ),
    Picture(
        "accelerations.png", "What does the formula of the thesis say?", ("accelerations",),
        "-k contour -v acceleration_x",
        "Above the border between slip and flight the formula describes no real part: the cells "
        "are pale and hatched.",
    ),
    Picture(
        "front.png", "What does speed cost across the track?", ("front",), "-k front",
        "Each line has its knee. Read the scale: the differences are about one per cent.",
    ),
    Picture(
        "angles.png", "Which two angles are best, and what limits them?", ("angles",),
        "-k landscape",
        "The optimum is in the corner of both limits: floor and wall decide.",
    ),
)  # fmt: skip


def draw_all(folder: Path) -> None:
    """Run all studies and draw all pictures in a folder."""
    for name in sorted({name for picture in GALLERY for name in picture.studies}):
        _vibrafeed(folder, f"run {shlex.quote(str(STUDIES / name))}.toml -o {name}.nc")
    for picture in GALLERY:
        _vibrafeed(folder, picture.command().removeprefix("vibrafeed "))


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
        "The studies are in `configs/gallery`. `python -m benchmarks.gallery` runs them, as in"
        " `vibrafeed run configs/gallery/drive.toml -o drive.nc`, and draws all pictures.\n",
    ]
    for picture in GALLERY:
        parts += [
            f"## {picture.asks}\n",
            f"{picture.shows}\n",
            f"![{picture.file}](../gallery/{picture.file})\n",
            f"```sh\n{picture.command()}\n```\n",
        ]
    return "\n".join(parts)


def _vibrafeed(folder: Path, command: str) -> None:
    """Run a vibrafeed command in a folder, in this process to save loading time."""
    with contextlib.chdir(folder):
        app(shlex.split(command), standalone_mode=False)


def main() -> None:
    """Draw all pictures."""
    PICTURES.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as name:
        draw_all(Path(name))
        for picture in GALLERY:
            shrink(Path(name) / picture.file, PICTURES / picture.file)
            size = (PICTURES / picture.file).stat().st_size
            print(f"{picture.file}: {size / 1000:.0f} kB")


if __name__ == "__main__":
    main()
