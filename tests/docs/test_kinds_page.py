"""The page of kinds says what their records say today, and its examples are carried out."""

import re

import pytest

from benchmarks.kinds_page import PAGE, page
from vibrafeed.core.intake import prepare_content, read_toml
from vibrafeed.core.kinds import KINDS, tabulate

EXAMPLES = re.findall(r"^```toml\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.M | re.S)


def test_the_page_is_up_to_date():
    assert page() == PAGE.read_text(encoding="utf-8"), "python -m benchmarks.kinds_page"


@pytest.mark.parametrize(("kind", "example"), [*zip(KINDS, EXAMPLES, strict=True)])
def test_examples_are_carried_out(kind, example):
    content = read_toml(example)
    assert content["kind"] == kind
    assert tabulate(prepare_content(content)).variables
