"""A generated block of a page, between two marks."""

from __future__ import annotations


def with_block(page: str, begin: str, block: str, end: str = "<!-- end -->") -> str:
    """The page with `block` between the marks, of which `begin` stands in it once."""
    before, _, rest = page.partition(begin)
    return f"{before}{begin}\n{block}\n{end}{rest.partition(end)[2]}"
