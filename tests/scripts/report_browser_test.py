#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""fabseq-tools report on made-up results: what a browser shows of its page."""

import unittest
from pathlib import Path

import h5py
import numpy as np
from matplotlib import image

from fabseq_tools.geometry.grid import nodes_of

import browser
from report_case import Report, report
from run_fabseq import Runner


@unittest.skipIf(browser.PROGRAM is None, "chromium is not installed: scripts/setup.sh --ci")
class InBrowser(browser.WithBrowser, Report):

    def open(self, state, directory=None, page="report.html"):
        """Opens the page and returns the pixels of its views."""
        path = (directory or self.solid) / page
        self.browser.open(f"file://{path}#{state}")
        self.assertEqual(self.browser.complaints, [])
        asked_for = {address.split("#")[0] for address in self.browser.requests} - {"about:blank"}
        self.assertLessEqual(asked_for, {f"file://{path}"})
        self.browser.requests.clear()
        self.browser.value("document.querySelector('.views').scrollIntoView()")
        picture = Path(self.folder.name) / "picture.png"
        self.browser.picture(picture)
        boxes = self.browser.value("""[...document.querySelectorAll('.surface')].map((surface) => {
          const box = surface.getBoundingClientRect();
          return [box.top, box.bottom, box.left, box.right].map(Math.round); })""")
        pixels = image.imread(picture)[..., :3]
        return [pixels[top + 2:bottom - 2, left + 2:right - 2] for top, bottom, left, right in boxes]

    def coloured(self, pixels):
        return float((pixels.max(axis=-1) - pixels.min(axis=-1) > 0.15).mean())

    def words(self, selector):
        return self.browser.value(f"[...document.querySelectorAll('{selector}')].map((each) => each.textContent)")

    def test_slider_builds_the_part(self):
        with h5py.File(self.solid / "result.h5") as file:
            built, time, layer = file["density"][:] > 0, file["time"][:], file["layer"][:]
        shares = []
        for now in (0.2, 0.5, 1.0):
            views = self.open(f"time={now}&field=layer")
            self.assertEqual(len(views), 3)
            shares.append([self.coloured(view) for view in views])
            done = time[built] <= now
            self.assertIn(f"{round(100 * done.mean())} % built", self.words(".state")[2])
            self.assertIn(f"layer {int(layer[built][done].max())} of {int(layer.max())}", self.words(".state")[2])
        for earlier, later in zip(shares, shares[1:]):
            for view in range(3):
                self.assertGreater(later[view], earlier[view] + 0.01)
        self.assertGreater(shares[0][0], 0.005)

    def test_fields_look_different_and_displacement_deforms(self):
        pictures = {state: self.open(state) for state in (
            "field=layer", "field=time", "field=displacement&magnification=0", "field=displacement")}
        states = list(pictures)
        for first, second in zip(states, states[1:]):
            difference = np.abs(pictures[first][1] - pictures[second][1]).max(axis=-1).mean()
            self.assertGreater(float(difference), 0.005, (first, second))
        labels = self.words(".legend span")
        self.assertTrue(labels[2].endswith(" mm"), labels)
        with h5py.File(self.solid / "result.h5") as file:
            lengths = np.sqrt((file["planar/displacement"][:]**2).sum(axis=-1)).ravel()
            largest = lengths[nodes_of(file["density"][:] > 0)].max()
        self.assertAlmostEqual(float(labels[2].split()[0]), largest, delta=0.01 * largest)

    def test_released_and_hanging(self):
        built, released = (self.open(f"field=displacement&magnification=10{state}")
                           for state in ("", "&state=released"))
        self.assertGreater(float(np.abs(built[1] - released[1]).max(axis=-1).mean()), 0.005)
        self.assertEqual(self.browser.value("document.querySelectorAll('.bar select')[1].value"), "released")
        views = self.open("field=hanging&camera=1,0,0.5,0,0,0,2")
        red = [float((view[..., 0] - view[..., 1] > 0.4).mean()) for view in views]
        self.assertGreater(red[1], 0.001)
        self.assertEqual([red[0], red[2]], [0.0, 0.0])
        self.assertIn("6 elements in the air", self.words(".state")[1])

    def test_torch_colours(self):
        views = self.open("field=blocked&camera=1,0,0.5,0,0,0,2")
        self.assertTrue(self.words(".state")[2].endswith("; 4 elements out of the torch's reach"), self.words(".state"))
        tilted = self.open("field=tilt&camera=1,0,0.5,0,0,0,2")
        self.assertIn("up to 33.3 degrees", self.words(".state")[2])
        self.assertGreater(float(np.abs(views[2] - tilted[2]).max(axis=-1).mean()), 0.02)
        self.assertEqual(self.words(".legend span")[2], "33.3 degrees")

    def test_keys_move_the_slider_and_the_address_follows(self):
        self.open("time=0.5")
        self.browser.value("document.querySelector('.time input').focus()")
        for kind in ("keyDown", "keyUp"):
            self.browser.call("Input.dispatchKeyEvent", type=kind, key="ArrowRight", code="ArrowRight",
                              windowsVirtualKeyCode=39)
        self.assertIn("time=0.505", self.browser.value("location.hash"))

    def test_one_camera_for_all_views(self):
        views = self.open("camera=1,0,0,0,0,0,2")
        turned = self.open("camera=0,0,1,0,0,0,1")
        for before, after in zip(views, turned):
            self.assertGreater(float(np.abs(before - after).mean()), 0.01)

    def test_narrow_and_dark(self):
        for width in (390, 1200):
            self.browser.size(width, 800)
            light = self.open("scheme=light")
            self.assertLessEqual(self.browser.value("document.documentElement.scrollWidth"), width)
            self.assertGreater(min(map(self.coloured, light[:1])), 0.03)
            background = self.open("scheme=dark")[0][0, 0]
            self.assertLess(background.max(), 0.2)
        self.browser.size(1200, 900)

    def test_flat_parts_and_comparisons(self):
        whole, half = (self.open(f"time={now}", self.flat) for now in (1, 0.5))
        self.assertGreater(self.coloured(whole[0]), self.coloured(half[0]) + 0.1)
        self.assertEqual(report(self.solid, self.flat).returncode, 0)
        views = self.open("", self.solid, "report_compare.html")
        self.assertEqual(len(views), 2)
        self.assertGreater(min(map(self.coloured, views)), 0.03)
        self.assertGreater(len(self.words(".chart h3")), 5)


if __name__ == "__main__":
    unittest.main(verbosity=2, testRunner=Runner)
