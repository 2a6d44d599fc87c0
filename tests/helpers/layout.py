"""Whether the texts of a picture can be read."""

from itertools import combinations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.path import Path
from matplotlib.text import Text
from matplotlib.transforms import Affine2D, Bbox

from pictures import subtitle
from vibrafeed.core.plots.looks import ON_FILL

MEET = 1.0  # dots


def boxes(figure: Figure) -> list[tuple[Text, Bbox]]:
    """Return the texts that a picture shows, and where: of an axis those of ticks in sight."""
    figure.draw_without_rendering()
    renderer = figure.canvas.get_renderer()
    found = [text for text in figure.findobj(Text, include_self=False) if text.get_visible()]
    # To ask an axis for its ticks moves those of a surface.
    places = [(text, text.get_window_extent(renderer)) for text in found if text.get_text().strip()]
    ticks, drawn = set(), set()
    for axes in figure.findobj(Axes):
        for axis in axes._axis_map.values():
            for tick in (*axis.get_major_ticks(), *axis.get_minor_ticks()):
                ticks |= {tick.label1, tick.label2}
            if axis.get_visible():
                drawn |= {tick.label1 for tick in axis._update_ticks()}
    return [place for place in places if place[0] not in ticks - drawn]


def area(text: Text, box: Bbox) -> Path:
    """Return the outline of a text, a turned one in its own directions."""
    turn = text.get_rotation()
    text.set_rotation(0)
    level = text.get_window_extent()
    text.set_rotation(turn)
    half = np.array([level.width, level.height]) / 2 - MEET
    corners = half * [[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]
    middle = [(box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2]
    return Affine2D().rotate_deg(turn).translate(*middle).transform_path(Path(corners, closed=True))


def contrast(one: object, other: object) -> float:
    def luminance(colour: object) -> float:
        rgb = np.array(to_rgb(np.atleast_2d(colour)[0] if np.ndim(colour) > 1 else colour))
        linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
        return float(linear @ [0.2126, 0.7152, 0.0722])

    light, dark = sorted((luminance(one), luminance(other)), reverse=True)
    return (light + 0.05) / (dark + 0.05)


def judge(figure: Figure) -> None:
    """Fail where texts meet, leave the figure, or cannot be told from what lies below."""
    found = boxes(figure)
    frame = figure.bbox
    for text, box in found:
        across, up = (
            frame.x0 <= box.x0 < box.x1 <= frame.x1,
            frame.y0 <= box.y0 < box.y1 <= frame.y1,
        )
        assert (across, up) == (True, True), f"{text.get_text()!r} leaves the figure"
        if str(text.get_color()) != ON_FILL:
            assert contrast(text.get_color(), figure.get_facecolor()) > 4.5, text.get_text()
    areas = [(text.get_text(), area(text, box)) for text, box in found]
    for (one, mine), (other, its) in combinations(areas, 2):
        # Asked one way only, matplotlib finds areas to meet whose sides lie on one line.
        meet = mine.intersects_path(its) and its.intersects_path(mine)
        assert not meet, f"{one!r} meets {other!r}"
    assert len(subtitle(figure).split("\n")) <= 3  # two of fixed values, and the source
