#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""The answer at a glance: what report and overview begin with, on made-up results with places."""

import json
import re
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import h5py
import numpy as np
from matplotlib import image
from matplotlib.colors import to_rgb

from fabseq_tools.plot import overview, render_part
from fabseq_tools.plot.camera import View
from fabseq_tools.plot.overview_pictures import PIXELS, pins_of
from fabseq_tools.report.report import ReportRun, page_of
from fabseq_tools.run.read_run import Run
from fabseq_tools.run.verdict_words import COLOURS, FAULTS

import browser
import fake_places
import fake_results

SIZE = (2.0, 1.0, 2.0)
TILT = 2  # among the faults


def skin(rms):
    return {"as_built": {"skin": {"rms": rms, "max": 10 * rms}}, "released": None}


def write_run(directory, density, size, most_tilt=30.0):
    """Planar layers begin in the air, even ones are buildable; optimized ones tilt in their last tenth."""
    fake_results.write_run(directory, "v_shape", density, size)
    fake_results.add_checks(directory)
    fake_results.add_torch(directory, most_tilt)
    with h5py.File(directory / "result.h5", "r+") as file:
        for name in ("time", "layer", "displacement"):
            file[f"even/{name}"] = file[f"planar/{name}"][()]

    def edit(summary):
        summary["baseline_even"] = dict(summary["baseline"])
        for number, state in enumerate(("binary", "baseline_even", "baseline")):
            summary[state]["finished"] = skin([0.1, 0.2, 0.3][number])

    fake_results.change(directory, "summary.json", edit)
    fake_places.add_places(directory)


def data_of(page):
    return json.loads(page.split('type="application/json">')[1].split("</script>")[0])


class Answer(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.solid, cls.flat = (Path(cls.folder.name) / name for name in ("solid", "flat"))
        write_run(cls.solid, fake_results.v_shape_density((20, 10, 20)), SIZE)
        write_run(cls.flat, np.ones((8, 12)), (3.0, 2.0))
        cls.pages = {run: page_of([ReportRun(run)]) for run in (cls.solid, cls.flat)}
        for run, page in cls.pages.items():
            (run / "report.html").write_text(page, encoding="utf-8")
        cls.page = cls.pages[cls.solid]
        cls.summary = json.loads((cls.solid / "summary.json").read_text(encoding="utf-8"))


class Page(Answer):
    def test_verdict_is_a_colour_with_words(self):
        self.assertIn('<section id="answer" class="bad"><p class="verdict">Not buildable</p>', self.page)
        self.assertIn("The skin distorts 2.0 times less than in the best alternative, even layers (buildable).", self.page)
        reason = self.summary["binary"]["verdict"]["reasons"][0]["words"]
        self.assertIn(reason[1:], self.page.split("</section>")[0])

    def test_three_figures(self):
        cards = re.findall(r'<div class="card.*?</dl></div>', self.page, re.DOTALL)
        self.assertEqual([re.search(r"<b title=\"(.*?)\"", card)[1] for card in cards], ["0.3", "0.2", "0.1"])
        for card, words in zip(cards, ("buildable but for 1 place", "buildable", "not buildable")):
            self.assertIn(f">{words}</p>", card)
            self.assertRegex(card, r"largest [123] mm")
        self.assertIn("<dt>largest tilt</dt> <dd>33.3°</dd>", cards[2])

    def test_views_and_places(self):
        data = data_of(self.page)
        left, right = data["answer"]["views"]
        self.assertEqual([left["state"], right["state"]], ["baseline_even", "binary"])
        self.assertEqual([data["scene"]["views"][view["view"]]["state"] for view in (left, right)], ["baseline_even", "binary"])
        self.assertEqual([kind["colour"] for kind in data["scene"]["fields"]["fault"]["kinds"]],
                         [colour for _, _, colour in FAULTS])
        self.assertEqual([place["words"] for place in right["places"]],
                         [place["words"] for place in self.summary["binary"]["places"]])
        self.assertEqual(self.page.count('data-view="1"'), len(right["places"]))
        self.assertIn("Even layers: can be built everywhere", self.page)

    def test_places_begin_at_the_corner_of_the_box(self):
        with tempfile.TemporaryDirectory() as folder:
            run = Path(folder)
            fake_results.write_run(run, "plate", np.ones((8, 12)), (3.0, 2.0))
            fake_results.add_checks(run)
            fake_results.change(run, "config.json", lambda config: config["domain"].update(origin=[10.0, -5.0]))
            fake_places.add_places(run)
            (place,) = data_of(page_of([ReportRun(run)]))["answer"]["views"][0]["places"]
            self.assertEqual((place["lower"], place["upper"], place["layer"]), ([1.5, 1.75], [3.0, 2.0], 10))
            self.assertEqual(Run(run).summary["baseline"]["places"][0]["lower"], [11.5, -3.25])

    def test_everything_else_is_folded(self):
        for heading in ("Conclusions", "Figures", "Part and layers", "Constraints", "Curves", "What was run"):
            self.assertIn(f"<details><summary>{heading}</summary>", self.page)
        self.assertIn("<details open><summary>Figures</summary>", page_of([ReportRun(self.solid), ReportRun(self.flat)]))

    def test_comparison_of_runs_begins_with_their_verdicts(self):
        page = page_of([ReportRun(self.solid), ReportRun(self.flat)])
        self.assertIn('<b>solid</b>: <span class="chip bad">Not buildable</span> The skin distorts 2.0 times', page)

    def test_without_faults_there_are_no_views(self):
        run = ReportRun(self.solid)
        for name in [name for name in run.fields if name.endswith("fault")]:
            del run.fields[name]
        page = page_of([run])
        self.assertEqual(data_of(page)["answer"]["views"], [])
        self.assertNotIn('<section id="pair">', page)
        self.assertIn('<p class="verdict">Not buildable</p>', page)

    def test_simulation(self):
        with tempfile.TemporaryDirectory() as folder:
            run = Path(folder)
            write_run(run, np.ones((8, 12)), (3.0, 2.0))
            fake_results.make_simulation(run)
            fake_results.change(run, "summary.json", lambda summary: summary.pop("answer"))
            page = page_of([ReportRun(run)])
            self.assertIn('<p class="verdict">Not buildable</p>', page)
            (view,) = data_of(page)["answer"]["views"]
            self.assertEqual((view["state"], view["title"]), ("simulated", "These layers"))


class Overview(Answer):
    def test_title_is_the_verdict(self):
        with mock.patch.object(overview, "draw_sheet") as sheet, mock.patch.object(overview, "Shapes") as shapes:
            shapes.return_value.largest_each = [0.1, 0.2]
            with mock.patch.object(render_part, "render", return_value=np.zeros((4, 4, 3), np.uint8)) as render:
                overview.draw_optimization(Run(self.solid), "none.png")
        _, content, layers, _ = sheet.call_args.args
        self.assertEqual((content.title, content.kind), ("V shape: not buildable", "not_buildable"))
        self.assertEqual([words for words, _, _ in content.captions], ["Best alternative: even layers", "Optimized layers"])
        self.assertEqual(content.captions[0][1:], ("buildable", "buildable"))
        self.assertEqual(content.place_lines[0], f"1   {self.summary['binary']['places'][0]['words']}")
        self.assertEqual([len(pins) for pins in layers.pins], [0, min(9, self.summary["binary"]["places_in_all"])])
        self.assertEqual(layers.faults, [1 + TILT])
        colours = [{tuple(colour) for colour in call.kwargs["face_colours"]} for call in render.call_args_list]
        self.assertEqual([bool(shades(FAULTS[TILT][2]) & each) for each in colours], [False, True])

    def test_pins_are_where_the_camera_sees_the_places(self):
        part = render_part.VoxelPart(np.ones((2, 2)), (2.0, 2.0), "y-")
        run = mock.Mock(config={"domain": {"size": [2.0, 2.0], "origin": [5.0, 5.0]}})
        place = {"kind": "tilt", "centre": [6.0, 6.0]}
        ((column, row, colour, number),) = pins_of(run, View(part, part.nodes, PIXELS), [place])
        np.testing.assert_allclose([column, row], [0.5 * size for size in PIXELS], atol=1e-9)
        self.assertEqual((colour, number), (FAULTS[TILT][2], 1))

    def test_picture(self):
        for run in (self.solid, self.flat):
            path = Path(self.folder.name) / "overview.png"
            overview.main([str(run), str(path)])
            pixels = image.imread(path)[..., :3]
            np.testing.assert_allclose(pixels[5, 5], to_rgb(COLOURS["not_buildable"]), atol=0.01)
            upper = pixels[:len(pixels) // 2]
            left, right = (share(half) for half in np.array_split(upper, 2, axis=1))
            self.assertGreater(right, left + 0.002)  # on the left are amber words alone


def share(pixels):
    """Of the pixels that have the colour of tilted elements, in any light."""
    hue = np.array(to_rgb(FAULTS[TILT][2]))
    bright = pixels / np.maximum(pixels.max(axis=-1, keepdims=True), 0.3)
    return float((np.abs(bright - hue / hue.max()).max(axis=-1) < 0.06).mean())


def shades(colour):
    return {tuple((255 * np.array(to_rgb(colour)) * shade).astype(np.uint8)) for shade in (1.0, 0.84)}


@unittest.skipIf(browser.PROGRAM is None, "chromium is not installed: scripts/setup.sh --ci")
class InBrowser(browser.WithBrowser, Answer):
    WINDOW = 1300, 900

    def open(self, run=None, state=""):
        self.browser.open(f"file://{(run or self.solid) / 'report.html'}#{state}")
        self.assertEqual(self.browser.complaints, [])
        return self.views()

    def views(self):
        """Pixels of the two views."""
        picture = Path(self.folder.name) / "picture.png"
        self.browser.value("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
        self.browser.picture(picture)
        boxes = self.browser.value("""[...document.querySelectorAll('#pair .surface')].map((surface) => {
          const box = surface.getBoundingClientRect(); return [box.top, box.bottom, box.left, box.right].map(Math.round); })""")
        pixels = image.imread(picture)[..., :3]
        return [pixels[top + 2:bottom - 2, left + 2:right - 2] for top, bottom, left, right in boxes]

    def test_two_views_in_the_first_screen(self):
        for run in (self.solid, self.flat):
            left, right = self.open(run)
            self.assertLess(self.browser.value("document.querySelector('#pair .views').getBoundingClientRect().bottom"), 900)
            self.assertEqual(share(left), 0.0)
            self.assertGreater(share(right), 0.005)
            self.assertIsNone(self.browser.value("document.querySelector('#viewer .views')"))

    def test_a_click_turns_to_the_place(self):
        before = self.open()
        button = "document.querySelector('#places button')"
        self.browser.value(f"{button}.click()")
        after = self.views()
        for old, new in zip(before, after):
            self.assertGreater(float(np.abs(old - new).mean()), 0.02)
        self.assertEqual(self.browser.value(f"{button}.getAttribute('aria-pressed')"), "true")
        self.assertEqual(self.browser.value("document.querySelector('.pin.chosen').textContent"), "1")
        self.browser.value("document.getElementById('whole').click()")
        for old, new in zip(before, self.views()):
            self.assertLess(float(np.abs(old - new).mean()), 1e-3)
        self.browser.value("document.querySelector('.pin').click()")
        self.assertEqual(self.browser.value(f"{button}.getAttribute('aria-pressed')"), "true")

    def test_folded_sections_draw_once_they_are_opened(self):
        self.open()
        for place, found in (("viewer", "#viewer .views canvas"), ("charts", ".chart canvas")):
            self.browser.value(f"document.getElementById('{place}').closest('details').open = true")
            self.browser.value("new Promise((done) => { const wait = () => "
                               f"document.querySelector('{found}') ? done() : setTimeout(wait, 20); wait(); }})")
        self.assertEqual(self.browser.complaints, [])

    def test_a_link_opens_the_views(self):
        self.open(state="time=0.5&field=fault")
        self.assertTrue(self.browser.value("document.getElementById('viewer').closest('details').open"))
        self.assertEqual(self.browser.value("document.querySelector('#viewer .time output').textContent"), "0.500")
        self.assertIn(FAULTS[0][1], self.browser.value("document.querySelector('#viewer figure .note').textContent"))

    def test_narrow(self):
        self.browser.size(390, 800)
        self.open()
        self.assertLessEqual(self.browser.value("document.documentElement.scrollWidth"), 390)
        self.browser.size(1300, 900)


if __name__ == "__main__":
    unittest.main()
