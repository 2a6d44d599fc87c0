"""The page of mistakes says what is said today, and each mistake gets one message."""

from benchmarks.mistakes_page import GROUPS, PAGE, page


def test_the_page_is_up_to_date():
    assert page() == PAGE.read_text(encoding="utf-8"), "python -m benchmarks.mistakes_page"


def test_there_are_thirty_at_least_and_none_twice():
    typed = [mistake.typed for group in GROUPS.values() for mistake in group]
    assert len(typed) == len(set(typed)) >= 30
