"""The Prefer header, after the examples and the rules of RFC 7240."""

import pytest

from app.prefer import Preferences, preferences

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


def test_a_hostile_header_takes_no_time():
    """64 KiB, as much as a server lets through, in well under the second that a hang would take."""
    for text in ('a="' + "\\" * 65_536, "a;" * 32_768 + "=", "a=" * 32_768, ",;" * 32_768):
        assert preferences([text]) == NOTHING
