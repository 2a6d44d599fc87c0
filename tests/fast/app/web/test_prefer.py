"""The Prefer header, after the examples and the rules of RFC 7240."""

import pytest

from vibrafeed.app.web.prefer import Preferences, preferences

NOTHING = Preferences()
ASYNC = Preferences(respond_async=True)


@pytest.mark.parametrize(
    ("headers", "expected"),
    [
        ([], NOTHING),
        ([""], NOTHING),
        (["respond-async"], ASYNC),
        (["Respond-Async"], ASYNC),  # names are case-insensitive
        (["wait=100"], Preferences(wait=100)),
        (["WAIT = 10"], Preferences(wait=10)),  # white space around the sign
        (['wait="10"'], Preferences(wait=10)),  # a quoted word means the same
        (["respond-async, wait=100"], Preferences(True, 100)),  # section 4.3
        (["respond-async", "wait=100"], Preferences(True, 100)),  # two fields are one list
        (["wait=1, wait=2"], Preferences(wait=1)),  # of one given twice the first counts
        (["wait=1", "wait=2"], Preferences(wait=1)),
        (["priority=5, respond-async; foo=bar; baz"], ASYNC),  # unknown ones, and parameters
        (['foo="a, wait=3", respond-async'], ASYNC),  # a comma in quotes parts nothing
        (['foo="\\", wait=3", respond-async'], ASYNC),
        (["respond-async=yes"], ASYNC),
        (["wait"], NOTHING),
        (["wait=-1"], NOTHING),
        (["wait=1.5"], NOTHING),
        (["wait=ten"], NOTHING),
        (["wait=1234567890"], NOTHING),  # longer than any wait
        (["wait=٣"], NOTHING),  # a digit, but not of ASCII
        (["=;,,;=, respond-async"], ASYNC),  # what is malformed does not count, the rest does
        (["respond-sync"], NOTHING),
        (["xrespond-async"], NOTHING),
    ],
)
def test_preferences(headers, expected):
    assert preferences(headers) == expected


HOSTILE = {
    "spaces between no parameters": ("a", "; ", "@"),
    "spaces before a sign": ("a", " ", "@"),
    "parameters": ("a", ";a=a ", "@"),
    "no names": ("", ",;", ""),
    "escapes": ('a="', "\\", ""),
    "quotes that open in every element": ("", 'a=",', ""),
    "elements in quotes": ('x="', ',a;b=";b="', "@"),
    "quotes that never end": ("", ",a", ';b="'),
    "signs": ("a", "=", ""),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_header_takes_no_time(name):
    """A header of any length keeps the event loop for no longer than a request does.

    Reading is linear, or quadratic in the 2,000 characters read: some milliseconds at worst, where
    backtracking takes three seconds for 24 repetitions and doubles with each: that this test ends
    at all shows that there is none.
    """
    before, repeated, after = HOSTILE[name]
    for count in (24, 8_000, 65_536):
        assert preferences([before + repeated * count + after]) == NOTHING


def test_what_is_past_the_limit_or_cut_off_does_not_count():
    filler = "foo, " * 398  # 1,990 characters
    assert preferences([filler + "wait=12345"]) == Preferences(wait=12345)  # ends at the limit
    assert preferences([filler + "wait=123456"]) == NOTHING  # not 12345
    assert preferences(["respond-async, " + filler + "wait=1"]) == ASYNC
