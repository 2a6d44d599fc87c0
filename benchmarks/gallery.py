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

from app.cli import app

ROOT = Path(__file__).parents[1]
STUDIES = ROOT / "configs" / "gallery"
PICTURES = ROOT / "docs" / "gallery"
PAGE = ROOT / "docs" / "gallery.md"
WIDTHS = (1000, 800, 640)  # dots
COLOURS = (160, 64, 32)  # of a PNG: flat colours need few, and the file is a third as large
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
        """Return the commands that make it, from the root of the repository."""
        runs = [f"vibrafeed run configs/gallery/{name}.toml -o {name}.nc" for name in self.studies]
        files = " ".join(f"{name}.nc" for name in self.studies)
        options = f" {self.options}" if self.options else ""
        return [*runs, f"vibrafeed plot {files}{options} -o {self.file}"]


GALLERY = (
    Picture(
        "amplitude.png", "What happens when I turn up the amplitude?", ("amplitude",),
        "-k thresholds",
        "JUDGE",
    ),
    Picture(
        "drive-levels.png", "How fast, and in which way, over amplitude and angle?", ("drive",),
        "-k levels",
        "JUDGE",
    ),
    Picture(
        "drive-map.png", "Where does it stick, slide and hop?", ("drive",), "-k map",
        "JUDGE",
    ),
    Picture(
        "drive-contour.png", "Where is the fastest drive?", ("drive",), "-k contour",
        "JUDGE",
    ),
    Picture(
        "friction.png", "Which angle suits which friction?", ("frictions",),
        "-k line -a beta,friction",
        "JUDGE",
    ),
    Picture(
        "oil.png", "What does oil change?", ("amplitude", "amplitude-oiled"),
        "-v conveying_velocity",
        "JUDGE",
    ),
    Picture(
        "hop.png", "What does one part do in a period?", ("hop",), "",
        "JUDGE",
    ),
    Picture(
        "hop.gif", "How does that look, slowly?", ("hop",), "--slow 50",
        "JUDGE",
    ),
    Picture(
        "wall.png", "Does the part leave the wall?", ("wall",), "",
        "JUDGE",
    ),
    Picture(
        "tumble.png", "How does a dropped part come to rest?", ("tumble",), "",
        "JUDGE",
    ),
    Picture(
        "tumble.gif", "How does the fall look?", ("tumble",), "--slow 20",
        "JUDGE",
    ),
    Picture(
        "designs.png", "Which of a thousand designs are fast, and what do they share?",
        ("designs",), "-k parallel",
        "JUDGE",
    ),
    Picture(
        "accelerations.png", "What does the formula of the thesis say?", ("accelerations",),
        "-k contour -v acceleration_x",
        "JUDGE",
    ),
    Picture(
        "surface.png", "The same as a relief", ("accelerations",), "-k surface -v acceleration_x",
        "JUDGE",
    ),
    Picture(
        "front.png", "What does speed cost across the track?", ("front",), "-k front",
        "JUDGE",
    ),
    Picture(
        "angles.png", "Which two angles are best, and what limits them?", ("angles",),
        "-k landscape",
        "JUDGE",
    ),
)  # fmt: skip


def draw_all(folder: Path) -> None:
    """Carry out all studies and draw all pictures in a folder."""
    for name in sorted({name for picture in GALLERY for name in picture.studies}):
        _vibrafeed(folder, f"run {shlex.quote(str(STUDIES / name))}.toml -o {name}.nc")
    for picture in GALLERY:
        _vibrafeed(folder, picture.commands()[-1].removeprefix("vibrafeed "))


def shrink(source: Path, target: Path) -> None:
    """Copy a picture; a PNG with the colours and the width that a page needs."""
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
    """Return the text of the page."""
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
    """Carry out a command in a folder; in this process, that the libraries are loaded once."""
    with contextlib.chdir(folder):
        app(shlex.split(command), standalone_mode=False)


def main() -> None:
    """Make all pictures and the page."""
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
