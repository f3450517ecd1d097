"""A part of a page that a tool writes: what stands between <!-- NAME: begin --> and <!-- NAME: end -->."""


def with_table(page, name, table):
    """The page with this table there."""
    start, end = f"<!-- {name}: begin -->", f"<!-- {name}: end -->"
    return page[:page.index(start) + len(start)] + "\n" + table + "\n" + page[page.index(end):]
