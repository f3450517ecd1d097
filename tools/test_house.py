#!/usr/bin/env python3
"""check_house.py must see what it is for: an arrow up, an arrow that is not drawn, one that is not there, a circle."""

import unittest

import check_house as house

ROOMS = [("base", "host/base", []), ("data", "host/data", ["base"]), ("top", "host/top", ["base", "data"])]
GOOD = {
    "host/base/error.h": [],
    "host/data/motor.h": ["host/base/error.h"],
    "host/top/main.c": ["host/data/motor.h", "host/base/error.h"],
}


def with_include(file, named):
    graph = {f: list(g) for f, g in GOOD.items()}
    graph[file].append(named)
    return graph


class House(unittest.TestCase):
    def one(self, rooms, graph, words):
        wrong = house.compare(rooms, graph)
        self.assertTrue(any(words in w for w in wrong), wrong)

    def test_as_drawn(self):
        self.assertEqual([], house.compare(ROOMS, GOOD))

    def test_arrow_up(self):
        self.one(ROOMS, with_include("host/base/error.h", "host/top/main.c"), "base <- top: an arrow up")

    def test_circle(self):
        self.one(ROOMS, with_include("host/base/error.h", "host/data/motor.h"), "a circle: ")

    def test_circle_within_a_room(self):
        graph = dict(GOOD, **{"host/base/a.h": ["host/base/b.h"], "host/base/b.h": ["host/base/a.h"]})
        self.assertEqual(["a circle: host/base/a.h -> host/base/b.h -> host/base/a.h"], house.compare(ROOMS, graph))

    def test_not_drawn(self):
        rooms = [(n, w, [x for x in names if x != "data"]) for n, w, names in ROOMS]
        self.one(rooms, GOOD, "top <- data: not drawn: host/top/main.c includes host/data/motor.h")

    def test_drawn_but_not_there(self):
        graph = dict(GOOD, **{"host/data/motor.h": []})
        self.one(ROOMS, graph, "data <- base: drawn, but nothing includes it")

    def test_no_such_room(self):
        self.one(ROOMS + [("attic", "host/attic", ["cellar"])], GOOD, "there is no room cellar")
        self.one(ROOMS + [("attic", "host/attic", [])], GOOD, "attic: no file in host/attic")

    def test_longest_path_is_the_room(self):
        rooms = ROOMS + [("inner", "host/data/inner", [])]
        self.assertEqual("inner", house.room_of("host/data/inner/x.c", rooms))
        self.assertEqual("data", house.room_of("host/data/x.c", rooms))
        self.assertIsNone(house.room_of("host/dataset/x.c", rooms))

    def test_names_of_the_library(self):
        rooms = [("numbers", "lib:iq24*,vector", []), ("cycle", "lib:cycle", ["numbers"])]
        self.assertEqual("numbers", house.room_of("include/iqfoc/iq24_math.h", rooms))
        self.assertEqual("numbers", house.room_of("src/vector.c", rooms))
        self.assertEqual("cycle", house.room_of("src/cycle.c", rooms))
        self.assertIsNone(house.room_of("src/recorder.c", rooms))
        self.assertIsNone(house.room_of("include/iqfoc/target/iq24.h", rooms))

    def test_the_page_is_read(self):
        text = "<!-- house -->\n\n    base   host/base   <-\n    data   host/data/  <- base\n\n<!-- end -->"
        self.assertEqual([("base", "host/base", []), ("data", "host/data", ["base"])], house.drawing(text))


if __name__ == "__main__":
    unittest.main()
