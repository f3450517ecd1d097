#!/usr/bin/env python3
"""site_search.py SITE: a search of the built pages finds the page on its subject first, and the front page shows a figure."""

import pathlib
import sys
import time

import browser

# What a reader types, and the page that must be the first result.
WANTED = {"dead time": "Dead time", "glossary": "Glossary", "own controller": "Test your own controller on the PC", "blind": "Blind tests"}
RESULTS = "return [...document.querySelectorAll('.md-search-result__item h1, .md-search-result__item h2')].map(h => h.textContent)"


def results(page, words):
    """The titles of a search's results, in their order."""
    page.run("const q = document.querySelector('.md-search__input'); q.focus(); q.value = arguments[0];"
             "q.dispatchEvent(new KeyboardEvent('keyup', {bubbles: true}));", words)
    for _ in range(100):
        time.sleep(0.2)
        found = page.run(RESULTS)
        if found:
            return found
    return []


def main(site):
    failed = 0
    with browser.Browser(1280, 900) as page:
        page.open(site / "index.html")
        figures = page.run("return [...document.querySelectorAll('article img')].filter(i => i.complete && i.clientWidth > 300).length")
        if not figures:
            failed += 1
            print("index.html: no figure is shown")
        for words, title in WANTED.items():
            page.open(site / "index.html")
            found = results(page, words)
            if not found or found[0] != title:
                failed += 1
                print(f"a search for {words!r} finds {found[:3]}, not {title!r} first")
    print(f"{len(WANTED)} searches, {failed} failures")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1])))
