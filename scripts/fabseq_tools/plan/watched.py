# SPDX-License-Identifier: MIT
"""How far the runs below a folder have come, said while somebody waits for them."""

import pathlib
import threading

from fabseq_tools.run.progress import Progress

PAUSE = 2.0  # seconds between two looks


class Watched:
    """`with Watched(folder) as progress: progress.say("guided")` says that, and behind it the iteration of
    the optimization that is under way."""

    def __init__(self, folder):
        self.folder, self.what, self.progress = pathlib.Path(folder), "", Progress("plan")
        self.ended = threading.Event()
        self.known = self.histories()
        self.thread = threading.Thread(target=self.watch, daemon=True)

    def say(self, words):
        self.what = words
        self.progress.say(words)

    def watch(self):
        while not self.ended.wait(PAUSE):
            before, self.known = self.known, self.histories()
            grown = [path for path, size in self.known.items() if before.get(path) != size]
            if grown:
                with open(grown[0], encoding="utf-8") as file:
                    self.progress.say(f"{self.what}: iteration {sum(1 for _ in file)} of {grown[0].parent}")

    def histories(self):
        """Sizes of the records of all optimizations, by path."""
        return {path: path.stat().st_size for path in self.folder.glob("**/history.jsonl") if path.is_file()}

    def __enter__(self):
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.ended.set()
        self.thread.join()
        self.progress.clear()
