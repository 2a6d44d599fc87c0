"""Random links of the page: such as it makes, such as an older one made, and such as mean harm."""

import random
import string
import urllib.parse
from typing import Any

SHORT = (
    "rectangle-on-plane",
    "cylinder-on-plane",
    "rectangle-on-track",
)  # whose motion is soon known
SCRIPTS = [
    "<img src=x onerror=window.harmed=1>",
    "<script>window.harmed=1</script>",
    "javascript:window.harmed=1",
    '"><svg onload=window.harmed=1>',
    "${window.harmed=1}",
    "'-(window.harmed=1)-'",
]
CRITERIA = ["maximise", "minimise", "weighted", "limit", "pareto"]
NAMES = ["__proto__", "constructor", "prototype", "toString", "hasOwnProperty", "valueOf", "length"]
NUMBERS = [
    "1e999",
    "-1e308",
    "1e308",
    "NaN",
    "Infinity",
    "-0",
    "0x10",
    "1_000",
    "",
    " ",
    "١٢",
    "5,3",
]
TEXTS = ["🦆" * 8, "\u202eabc", "\x00", "%00", "a\nb", "ﷺ", "null", "undefined", "[object Object]"]


# Links that once left no working page: an output without parameters, one that has a single one, an
# axis twice, names that every object of JavaScript has.
ONCE_BROKEN = [
    ("old", "#kind=sweep&scene=rectangle-isolated&choice=thesis&output=inertia_ratio&question=all"),
    (
        "valid",
        "#question=all&kind=sweep&scene=cylinder-rolling&choice=thesis&output=gravity_normal"
        "&y=gravity:1:2",
    ),
    ("old", "#question=all&kind=sweep&x=beta:1:9&y=beta:1:2"),
    ("hostile", "#question=all&kind=sweep&x=constructor:0:1&p.__proto__=5&band=toString:0.5"),
]


def valid(random_: random.Random, scenes: dict[str, Any]) -> dict[str, str]:
    """Return a link as the page makes it."""
    kind = random_.choice(["sweep", "simulate"])
    names = [name for name in scenes if kind == "sweep" or name in SHORT]
    scene = scenes[random_.choice(names)][kind]
    output = random_.choice([one for one in scene["outputs"] if one["asks"]])
    link = {
        "question": random_.choice(["speed", "drive", "all"]),
        "kind": kind,
        "scene": scene["name"],
        "choice": "",
        "output": output["name"],
    }
    ranges = [
        ("amplitude", 1e-4, 7e-4),
        ("beta", 5, 60),
        ("frequency", 20, 100),
        ("friction", 0.1, 0.9),
    ]
    known = [one for one in ranges if one[0] in output["asks"]]
    random_.shuffle(known)
    for place, (name, low, high) in zip("xy", known, strict=False):
        link[place] = f"{name}:{low}:{low + random_.uniform(0.1, 1) * (high - low)}"
    if len(known) > 2 and random_.random() < 0.5:
        name, low, high = known[2]
        link[f"p.{name}"] = str(random_.uniform(low, high))
        if link["question"] == "drive":
            link["vary"] = f"{name}:{low}:{high}"
    if link["question"] == "drive":
        others = [one["name"] for one in scene["outputs"] if one != output]
        link |= {"best": random_.choice(CRITERIA), "keep": f"{output['name']}:-1::size"}
        link |= {"against": random_.choice(others)} if others else {}
    return link


def old(random_: random.Random, scenes: dict[str, Any]) -> dict[str, str]:
    """Return a link with parts left out, and at least one that is renamed or of another form."""
    link = valid(random_, scenes)
    for name in random_.sample(list(link), random_.randint(0, 2)):
        if name not in ("kind", "scene"):
            del link[name]
    wrong = random_.choice(
        [
            {"output": "feed_speed"},
            {"x": "amplitude"},
            {"x": "stroke:1:2"},
            {"x": "beta:5:60", "y": "beta:5:60"},
            {"p.mu": "0.3"},
            {"kind": "closed"},
            {"scene": "bowl", "kind": "sweep", "question": "all"},
            {"question": "explore"},
            {"band": "20"},
            {"point": "here"},
        ]
    )
    return soon(link | wrong | {"version": "1"})


def hostile(random_: random.Random, scenes: dict[str, Any]) -> dict[str, str]:
    """Return a link that means harm in one or some of its parts."""
    link = valid(random_, scenes)
    bad = random_.choice(
        [SCRIPTS, NAMES, NUMBERS, TEXTS, ["x" * random_.choice([300, 3000, 30_000])]]
    )

    def word() -> str:
        if random_.random() < 0.2:
            return "".join(random_.choice(string.printable) for _ in range(20))
        return random_.choice(bad)

    places = ["question", "kind", "scene", "choice", "output", "x", "y", "band", "point"]
    for _ in range(random_.randint(1, 3)):
        match random_.randrange(5):
            case 0:
                link[random_.choice(places)] = word()
            case 1:
                link[f"p.{word()}"] = random_.choice([word(), "1"])
            case 2:
                link[random_.choice("xy")] = f"{word()}:{random_.choice([word(), '0'])}:1"
            case 3:
                name = random_.choice(["best", "limit", "keep", "vary", "given"])
                link |= {"question": "drive", "best": "limit", name: word()}
            case _:
                link["band"] = f"{word()}:{random_.choice(['0.5', word()])}"
    return soon(link)


def soon(link: dict[str, str]) -> dict[str, str]:
    """Return a link whose picture is soon there, also where the page falls back to another kind."""
    if link.get("kind") not in ("sweep", "simulate") and link.get("scene") not in SHORT:
        link["question"] = "all"
    return link


def links(count: int, seed: int, scenes: dict[str, Any]) -> list[tuple[str, str]]:
    """Return so many pairs of a kind and a link."""
    random_ = random.Random(seed)
    makers = {"valid": valid, "old": old, "hostile": hostile}
    found = [*ONCE_BROKEN]
    for _ in range(count - len(found)):
        kind = random_.choice(["valid", "old", "hostile", "hostile"])
        made = makers[kind](random_, scenes)
        quote = random_.choice([urllib.parse.quote, urllib.parse.quote_plus])
        found.append((kind, "#" + urllib.parse.urlencode(made, quote_via=quote)))
    return found
