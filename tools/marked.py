"""A part of a page that a tool writes, between <!-- NAME: begin --> and <!-- NAME: end -->."""


def _place(page, name):
    start, end = f"<!-- {name}: begin -->", f"<!-- {name}: end -->"
    return page.index(start) + len(start), page.index(end)


def table_in(page, name):
    """The table that is there."""
    begin, end = _place(page, name)
    return page[begin:end]


def with_table(page, name, table):
    """The page with this table there."""
    begin, end = _place(page, name)
    return page[:begin] + "\n" + table + "\n" + page[end:]
