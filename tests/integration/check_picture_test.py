# SPDX-License-Identifier: MIT
"""The picture of -task check: elements by the layers of the start design, the plate, node sets."""

import re
import xml.etree.ElementTree as ElementTree

import numpy as np

import run_fabseq
from run_fabseq import FabseqTest
from small_parts import hook_3d, plate_2d

SVG = "{http://www.w3.org/2000/svg}"
FRONT = 0.88  # brightness of faces towards y-; those on top have their layer's colour


class Picture:
    def __init__(self, text):
        root = ElementTree.fromstring(text)
        paths = [path.get("fill") for path in root.iter(SVG + "path")]
        self.plate, self.faces = paths[0], paths[1:]
        self.title, *self.words = [text.text for text in root.iter(SVG + "text")]
        self.colors = [square.get("fill") for square in root.iter(SVG + "rect") if square.get("height") == "14"]
        self.dots = {group.get("fill"): len(group.findall(SVG + "circle"))
                     for group in root.iter(SVG + "g") if group.get("fill") not in (None, "none")}

    def color(self, words):
        """Of a line of the legend."""
        return self.colors[self.words.index(words)]


def darker(color, brightness):
    return "#" + "".join(f"{round(int(color[i:i + 2], 16) * brightness):02x}" for i in (1, 3, 5))


def near(color, others):
    """Whether a colour is one of several, but for rounding."""
    values = np.array([[int(c[i:i + 2], 16) for i in (1, 3, 5)] for c in others])
    return np.any(np.all(np.abs(values - [int(color[i:i + 2], 16) for i in (1, 3, 5)]) <= 1, axis=1))


class CheckPictureTest(FabseqTest):
    def picture_of(self, config, *arguments):
        texts = []
        for ranks in run_fabseq.distinct(1, 2):
            path = self.write_config(config)
            run = self.run_program(ranks, "-config", path, "-task", "check", "-picture", *arguments)
            self.assert_done(run)
            path = re.search("^picture: (.*)$", run.stdout, re.MULTILINE).group(1)
            self.assertEqual(path, run.path("check.svg"))
            with open(path, encoding="utf-8") as file:
                texts.append(file.read())
        self.assertEqual(len(set(texts)), 1)
        return Picture(texts[0])

    def test_solids_show_the_faces_that_are_seen(self):
        picture = self.picture_of(hook_3d())
        filled = np.zeros((10, 6, 10), dtype=bool)
        filled[1:5, 1:5, 1:9] = True
        filled[1:9, 1:5, 6:9] = True
        seen = sum(np.sum(filled & ~np.roll(filled, -step, axis)) for axis, step in ((0, 1), (1, -1), (2, 1)))
        self.assertEqual(len(picture.faces), seen)
        self.assertEqual(picture.title, "hook: [8,4,8] elements")
        self.assertEqual(picture.plate, picture.color("build plate z-"))
        self.assertTrue(near(darker(picture.color("layer 1 of the start design"), FRONT), picture.faces))
        self.assertIn(picture.color("layer 3"), picture.faces)
        self.assertEqual(picture.dots, {picture.color("node set edge, 5 nodes"): 5,
                                        picture.color("node set top, 45 nodes"): 45})

    def test_plates_are_seen_from_the_front(self):
        config = plate_2d()
        config["node_sets"]["a < b & \"c\""] = config["node_sets"]["top"]
        picture = self.picture_of(config)
        x, y = np.meshgrid((np.arange(20) + 0.5) / 10, (np.arange(12) + 0.5) / 10, indexing="ij")
        self.assertEqual(len(picture.faces), np.sum((x - 2) ** 2 + (y - 0.6) ** 2 > 0.31 ** 2))
        self.assertEqual(len(set(picture.faces)), 4)
        self.assertEqual(picture.faces[-20:], [picture.color("layer 1 of the start design")] * 20)
        self.assertIn("node set a < b & \"c\", 21 nodes", picture.words)

    def test_fine_grids_are_drawn_in_blocks(self):
        picture = self.picture_of(plate_2d(), "-elements", "150,90")
        self.assertEqual(picture.title, "plate: [150,90] elements, drawn in blocks of 3")
        self.assertGreater(len(picture.faces), 1300)
        self.assertLessEqual(len(picture.faces), 50 * 30)

    def test_the_substrate_has_a_colour_of_its_own(self):
        config = hook_3d()
        config["substrate"] = {"box": {"min": [0, 0, 0], "max": [0.8, 0.8, 0.4]}}
        picture = self.picture_of(config)
        self.assertIn(darker(picture.color("substrate"), FRONT), picture.faces)


if __name__ == "__main__":
    run_fabseq.main()
