#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Links between the documents: files and headings that they name are there, as are paths of this tree in
their text, and pictures are shown somewhere."""

import re
import unittest
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]
FOLDERS = [PROJECT / "docs", PROJECT / "benchmarks"]
PAGES = [*PROJECT.glob("*.md"), *(page for folder in FOLDERS for page in folder.rglob("*.md"))]


def text_of(page):
    """Without blocks and words of code, whose brackets are no links."""
    text = re.sub(r"^```.*?^```|^    .*?$", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
    return re.sub(r"`[^`\n]*`", "", text)


def links_of(page):
    """Files, by their paths from the page, and headings of pages of this tree."""
    text = text_of(page)
    found = re.findall(r"\]\(\s*([^)\s]+)\s*\)", text) + re.findall(r"^\[[^]]+\]: (\S+)", text, re.MULTILINE)
    return [link for link in found if not re.match("[a-z]+:", link)]


def anchors_of(page):
    """Of headings, as GitHub makes them: small letters, digits, hyphens for spaces, numbered if several are
    alike."""
    anchors = []
    for line in re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE).splitlines():
        if re.match("#+ ", line):
            heading = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", line.lstrip("#").strip())
            anchor = re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
            count = sum(other == anchor or re.fullmatch(re.escape(anchor) + r"-\d+", other) is not None for other in anchors)
            anchors.append(f"{anchor}-{count}" if count else anchor)
    return anchors


class LinksTest(unittest.TestCase):
    def test_links(self):
        for page in PAGES:
            for link in links_of(page):
                with self.subTest(page=str(page.relative_to(PROJECT)), link=link):
                    name, _, anchor = link.partition("#")
                    target = (page.parent / name).resolve() if name else page
                    self.assertTrue(target.exists(), "no such file")
                    if anchor:
                        self.assertIn(anchor, anchors_of(target))

    def test_paths(self):
        """Those that stand in the text, but for NAME."""
        for page in PAGES:
            text = page.read_text(encoding="utf-8")
            for name in set(re.findall(r"(?<![\w./~-])(?:scripts|configs|docs|benchmarks|tests)/[\w./-]*\w", text)):
                with self.subTest(page=str(page.relative_to(PROJECT)), path=name):
                    self.assertTrue("NAME" in name or (PROJECT / name).exists(), "no such file")

    def test_pictures_are_shown(self):
        shown = {(page.parent / link).resolve() for page in PAGES for link in links_of(page)}
        kinds = (path for folder in FOLDERS for path in folder.rglob("*") if path.suffix in (".png", ".svg"))
        self.assertEqual([str(path.relative_to(PROJECT)) for path in kinds if path not in shown], [])


if __name__ == "__main__":
    unittest.main(verbosity=2)
