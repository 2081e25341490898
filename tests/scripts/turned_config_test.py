#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Turned configs: what stays of a config whose part is turned, and what is said of the rest."""

import copy
import unittest
from pathlib import Path
from unittest import mock

import numpy as np

from fabseq_tools.orientation import turned_config
from fabseq_tools.orientation.turned_config import TurnedConfig, with_absolute_files
from fabseq_tools.orientation.turned_shapes import Motion
from fabseq_tools.run.command_line import RunError

PROJECT = Path(__file__).resolve().parents[2]

CONFIG = {"domain": {"element": 2}, "part": {"mesh": {"file": "part.stl"}}, "material": {"file": "/else/steel.json"},
          "node_sets": {"top": {"box": {"min": [0, 0, 4], "max": [2, 2, 4]}},
                        "top_edge": {"sphere": {"center": [0, 0, 0], "radius": 1}},
                        "face": {"near": {"mesh": "face.stl"}}},
          "sequence": {"type": "heat", "characteristic_length": 20}, "projection": {"beta": 40, "max": "auto"},
          "layers": {"count": "auto"}, "baseline": {"layers": 9},
          "objective": [{"type": "distortion", "nodes": "top"}, {"type": "layer_uniformity"}],
          "constraints": [{"type": "layer_thickness", "target": 2}, {"type": "distortion", "measure": "angle", "nodes": "face",
                                                                     "to": "top"}]}


def turned(config=CONFIG, turn=(("x", 90),), shift=(0.0, 0.0, 0.0)):
    motion = Motion(turn)
    motion.shift, motion.unknown = None if shift is None else np.array(shift), "nobody knows"
    return TurnedConfig(config, [list(one) for one in turn], motion)


class TurnedConfigTest(unittest.TestCase):
    def test_files(self):
        found = with_absolute_files(CONFIG, "/folder")
        self.assertEqual((found["part"]["mesh"]["file"], found["material"]["file"], found["node_sets"]["face"]["near"]["mesh"]),
                         ("/folder/part.stl", "/else/steel.json", "/folder/face.stl"))
        self.assertEqual(CONFIG["part"]["mesh"]["file"], "part.stl")

    def test_sets_without_a_place(self):
        """They go with all terms that name them; the objective keeps a distortion."""
        result = turned(shift=None)
        self.assertEqual(set(result.content["node_sets"]), {"face", "compared_surface"})
        self.assertEqual([term.get("measure") for term in result.content["objective"]], ["shape", None])
        self.assertEqual(result.content["constraints"], CONFIG["constraints"][:1])
        self.assertEqual(
            result.notes[0], "node set top is left out, with 2 of objective and constraints that name it: nobody knows")
        self.assertEqual(result.notes[2], "node set top_edge is left out: nobody knows")

    def test_sequences(self):
        for sequence, expected, words in (
                ({"type": "direct", "start": {"box": {}}}, {"type": "direct"}, "sequence.start: the plate"),
                ({"type": "direct", "start": "plate"}, {"type": "direct", "start": "plate"}, None),
                ({"type": "file", "file": "t.h5"}, {"type": "planar"}, "sequence: planar in place of the file")):
            result = turned(CONFIG | {"sequence": sequence})
            self.assertEqual(result.content["sequence"], expected)
            self.assertEqual([note for note in result.notes if words and note.startswith(words)], result.notes)
        angles = turned(CONFIG | {"layers": {"type": "multi_planar", "angles": [[1.57, 0]]}})
        self.assertIn("layers.angles: kept", angles.notes[0])

    def test_numbers_that_follow_the_layers(self):
        for before, length, beta in ((10, 30.0, 60.0), (15, 20, 40), (None, "auto", "auto")):
            result = turned()
            result.follow(15, 12, lambda count=before: count)
            content = result.content
            self.assertEqual((content["layers"]["count"], content["baseline"]["layers"]), ("auto", 12))
            self.assertEqual((content["sequence"]["characteristic_length"], content["projection"]),
                             (length, {"beta": beta, "max": "auto"}))
            self.assertIn("baseline.layers 9 to 12", result.notes[-1])
        result = turned()
        result.follow(None, 12, None)  # multi-planar layers
        self.assertEqual(result.notes, ["with the number of layers: baseline.layers 9 to 12"])
        result = turned(turn=(("x", 360),))
        result.follow(15, 12, None)
        self.assertEqual((result.content["baseline"], result.notes), ({"layers": 9}, []))

    def test_settling(self):
        """A set without nodes, one with too few of them, and one that stays refused; names begin alike."""
        answers = iter([RunError("/node_sets/top_edge: no node that touches the part or the substrate lies"),
                        "node set top: 3 nodes\nnode set top_edge: 2 nodes\nnode set face: 4 nodes\n",
                        RunError("/node_sets/top_edge/samples: 9 of a set of 2 nodes"),
                        "node set top: 5 nodes\nnode set face: 4 nodes\n"])

        def check(*_):
            answer = next(answers)
            if isinstance(answer, RunError):
                raise answer
            return answer

        result = turned()
        with mock.patch.multiple(turned_config, run_program=check, write_json=lambda *_: None):
            result.settle(None, "config.json", 2.0, {"top": 30, "face": 4})
        self.assertEqual(result.content["node_sets"]["top"]["within"], 1.0)
        self.assertEqual(result.notes, [
            "node set top: nodes within 1 of it count, since 3 of the turned grid lie on it, 30 before the turn",
            "node set top_edge is left out: /node_sets/top_edge/samples: 9 of a set of 2 nodes"])
        again, refused = turned(), RunError("/tool/max_tilt: found 0")
        with mock.patch.multiple(turned_config, run_program=mock.Mock(side_effect=refused), write_json=lambda *_: None):
            again.settle(None, "config.json", 2.0, {})
        self.assertEqual(again.notes, ["the program refuses it: /tool/max_tilt: found 0"])

    def test_the_given_config_stays(self):
        before = copy.deepcopy(CONFIG)
        turned().follow(3, 3, lambda: 5)
        self.assertEqual(CONFIG, before)


if __name__ == "__main__":
    unittest.main()
