"""Random studies of all kinds, sent to a server of its own: none ends in a mistake of ours.

A few by day, 20,000 by night; `VIBRAFEED_FUZZ_CASES` says how many else.
"""

from __future__ import annotations

import pytest

from night import count
from random_search import searched

CASES = count(12, 20_000, "VIBRAFEED_FUZZ_CASES")


@pytest.mark.timeout(1800 + 3 * CASES)
def test_random_studies_end_in_no_mistake_of_ours():
    search = searched(CASES, seed=CASES)
    # What took longer than its price is a matter of a busy machine.
    assert [line for line in search.wrong if not line.startswith("took")] == []
    answers = {name: n for name, n in search.statuses.items() if not name.startswith("job")}
    assert sum(answers.values()) == CASES
    assert set(answers) <= {"200", "201", "422", "429"}
