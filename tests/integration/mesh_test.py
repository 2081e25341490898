# SPDX-License-Identifier: MIT
"""Parts that come from a CAD program: where the mesh goes, the box that follows, the elements it fills."""

import os
import zipfile

import h5py
import numpy as np

import run_fabseq
from run_fabseq import BAD_INPUT, FabseqTest, distinct

# A bar of 60 x 20 x 10 somewhere in space; its corners as a CAD program numbers none.
LOW, HIGH = np.array([5.0, -30.0, 7.0]), np.array([65.0, -10.0, 17.0])


def box_triangles(low, high):
    corners = np.array([[(low, high)[c >> axis & 1][axis] for axis in range(3)] for c in range(8)])
    faces = [(0, 2, 3), (0, 3, 1), (0, 1, 5), (0, 5, 4), (1, 3, 7), (1, 7, 5), (3, 2, 6), (3, 6, 7), (2, 0, 4), (2, 4, 6),
             (4, 5, 7), (4, 7, 6)]
    return corners[np.array(faces)]


def stl_text(triangles):
    lines = ["solid part"]
    for triangle in triangles:
        lines += [" facet normal 0 0 0", "  outer loop", *("   vertex {:.9g} {:.9g} {:.9g}".format(*x) for x in triangle),
                  "  endloop", " endfacet"]
    return "\n".join([*lines, "endsolid part", ""])


def bar(**mesh):
    return {"name": "bar", "domain": {"element": 2.5}, "part": {"mesh": {"file": "bar.stl", **mesh}},
            "node_sets": {"all": {"all": True}}, "sequence": {"type": "heat"}, "layers": {"count": 4},
            "objective": [{"type": "distortion", "nodes": "all"}]}


class MeshTest(FabseqTest):
    def setUp(self):
        super().setUp()
        self.write_stl("bar.stl", box_triangles(LOW, HIGH))

    def write_stl(self, name, triangles):
        with open(os.path.join(self.directory, name), "w", encoding="utf-8") as file:
            file.write(stl_text(triangles))

    def simulate(self, config, *arguments, ranks=2):
        run = self.run_config(ranks, config, "-task", "simulate", *arguments)
        self.assert_done(run)
        return run

    def density(self, run):
        with h5py.File(run.path("result.h5"), "r") as file:
            return file["density"][:]

    def assert_refused(self, config, *words, arguments=()):
        for ranks in distinct(3, 1):
            run = self.run_config(ranks, config, *arguments)
            self.assertEqual(run.status, BAD_INPUT, str(run))
            self.assertFalse(os.path.exists(run.output))
            messages = [line for line in run.messages() if not line.startswith("warning: ")]
            self.assertEqual(len(messages), 1, str(run))
            for word in words:
                self.assertIn(word, messages[0])


class PlaceTest(MeshTest):
    def test_the_box_follows_from_the_mesh(self):
        run = self.simulate(bar())
        domain = run.json("config.json")["domain"]
        self.assertEqual(domain["size"], [60, 20, 10])
        self.assertEqual(domain["elements"], [24, 8, 4])
        np.testing.assert_allclose(domain["origin"], [5, -30, 0])
        self.assertNotIn("element", domain)
        self.assertEqual(self.density(run).sum(), 24 * 8 * 4)
        placement = np.array(run.json("config.json")["run"]["mesh_placement"])
        np.testing.assert_allclose(placement @ [*LOW, 1], [5, -30, 0])
        # Run again, the config leads to the same.
        again = self.simulate(run.path("config.json"))
        self.assertEqual(again.json("summary.json")["responses"], run.json("summary.json")["responses"])

    def test_turned_scaled_and_left_where_it_is(self):
        """A turn around x and one around an axis in space, in inches."""
        config = bar(scale=25.4, rotate=[["x", 90], [[0, 0, 1], 90]], place="as_is")
        config["domain"]["element"] = [101.6, 127, 127]
        run = self.simulate(config)
        domain = run.json("config.json")["domain"]
        np.testing.assert_allclose(domain["size"], [254 + 50.8, 60 * 25.4, 20 * 25.4])  # 2.5 elements of 101.6 are 3
        self.assertEqual(domain["elements"], [3, 12, 4])
        placement = np.array(run.json("config.json")["run"]["mesh_placement"])
        x, y, z = LOW
        np.testing.assert_allclose(placement @ [x, y, z, 1], 25.4 * np.array([z, x, y]), atol=1e-9)

    def test_margin_is_on_all_sides_but_the_plates(self):
        config = bar()
        config["domain"]["margin"] = [5, 0, 2.5]
        run = self.simulate(config)
        domain = run.json("config.json")["domain"]
        self.assertEqual(domain["elements"], [28, 8, 5])
        np.testing.assert_allclose(domain["origin"], [0, -30, 0])
        self.assertEqual(self.density(run).sum(), 24 * 8 * 4)

    def test_another_plate(self):
        config = bar()
        config["build_plate"] = "x+"
        domain = self.simulate(config).json("config.json")["domain"]
        np.testing.assert_allclose(domain["origin"], [-60, -30, 7])

    def test_a_box_that_is_given(self):
        config = bar()
        config["domain"] = {"size": [70, 30, 10], "origin": [0, -35, 0], "elements": [28, 12, 4]}
        self.assertEqual(self.density(self.simulate(config)).sum(), 24 * 8 * 4)

    def test_the_same_displacements_anywhere(self):
        """As of the bar as a shape in a box at 0."""
        shape = bar()
        shape["domain"] = {"size": [60, 20, 10], "elements": [24, 8, 4]}
        shape["part"] = {"box": {"min": [0, 0, 0], "max": [60, 20, 10]}}
        with h5py.File(self.simulate(shape).path("result.h5"), "r") as file:
            expected = file["displacement"][:]
        with h5py.File(self.simulate(bar()).path("result.h5"), "r") as file:
            np.testing.assert_allclose(file["displacement"][:], expected, rtol=0, atol=1e-9 * abs(expected).max())


class FillTest(MeshTest):
    def test_grey_elements_and_thresholds(self):
        """3.75 in place of 2.5: edges lie within elements."""
        config = bar(fill="grey", least_elements=0)
        config["domain"] = {"size": [67.5, 22.5, 11.25], "origin": LOW.tolist()[:2] + [0], "elements": [18, 6, 3]}
        grey = self.density(self.simulate(config))
        self.assertAlmostEqual(grey.sum() * 3.75**3 / 12000, 1, delta=0.03)
        self.assertTrue(np.any((grey > 0) & (grey < 1)))
        for fill in distinct(0.2, 0.9):
            config["part"]["mesh"]["fill"] = fill
            np.testing.assert_array_equal(self.density(self.simulate(config)), grey >= fill)

    def test_ranks(self):
        one, three = (self.density(self.simulate(bar(), ranks=ranks)) for ranks in (1, 3))
        np.testing.assert_array_equal(one, three)

    def test_elements_without_the_meshs_volume(self):
        """Elements of 3 in a bar of 10: four rows or three, 20 % too much or 10 % too little."""
        config = bar(least_elements=0)
        config["domain"]["element"] = 3
        run = self.run_config(2, config, "-task", "check")
        self.assert_done(run)
        (warning,) = [line for line in run.messages() if "volume" in line]
        self.assertRegex(warning, r"^warning: /domain: the part's elements have (0|1)\.\d+ times the volume of the mesh")

    def test_a_box_that_cuts_the_mesh_off(self):
        config = bar(least_elements=0)
        for length, elements in ((30, 12), (57.5, 23), (60, 24)):
            config["domain"] = {"size": [length, 20, 10], "origin": LOW.tolist()[:2] + [0], "elements": [elements, 8, 4]}
            run = self.run_config(2, config, "-task", "check")
            self.assert_done(run)
            warnings = [line for line in run.messages() if "/domain" in line]
            self.assertEqual(len(warnings), int(length < 60), str(run))
            if warnings:
                self.assertIn(f"/domain: {100 * (1 - length / 60):.3g} % of the mesh's volume lies outside the box", warnings[0])
        config["domain"] = {"size": [27.5, 20, 10], "origin": LOW.tolist()[:2] + [0], "elements": [11, 8, 4]}
        self.assert_refused(config, "/domain", "54.2 % of the mesh's volume", "[5,-30,0]..[32.5,-10,10]", "up to 50 %")

    def test_a_mesh_that_is_open(self):
        self.write_stl("bar.stl", box_triangles(LOW, HIGH)[:-2])
        run = self.run_config(2, bar(), "-task", "simulate")
        (warning,) = [line for line in run.messages() if "/part/mesh" in line]
        self.assertRegex(warning, r"holes.* [\d.]+ % of \d+ points, least at \[[\d.]+,-[\d.]+,[\d.]+\]")
        self.assertGreater(self.density(run).sum(), 0.6 * 24 * 8 * 4)

    def test_nodes_near_a_face(self):
        self.write_stl("face.stl", box_triangles(LOW, HIGH)[-2:])  # its top
        config = bar()
        config["node_sets"]["all"] = {"near": {"mesh": "face.stl", "distance": 0.5}}
        run = self.run_config(2, config, "-task", "check")
        self.assertIn("node set all: 225 nodes", run.stdout)  # 25 x 9
        config["node_sets"]["all"]["near"]["distance"] = 2.5
        self.assertIn("node set all: 450 nodes", self.run_config(1, config, "-task", "check").stdout)

    def test_a_face_in_another_unit(self):
        self.write_stl("face.stl", box_triangles(LOW, HIGH)[-2:] / 1000)
        config = bar(place="as_is")
        config["node_sets"]["all"] = {"near": {"mesh": "face.stl", "distance": 0.5}}
        self.assert_refused(config, "/node_sets/all", "a mesh 0.06 long", "which is 60 long", "its unit of length is another")
        config["node_sets"]["all"]["near"]["distance"] = 20
        run = self.run_config(1, config, "-task", "check")
        self.assertIn("warning: /node_sets/all/near/mesh: found a mesh 0.06 long", run.stderr)


class SurfaceTest(MeshTest):
    def test_bodies_that_overlap_one_inside_out(self):
        middle = np.array([HIGH[0] - 20, *HIGH[1:]])
        turned = box_triangles(LOW + [20, 0, 0], HIGH)[:, ::-1]
        self.write_stl("bar.stl", np.concatenate([box_triangles(LOW, middle), turned]))
        run = self.simulate(bar(), ranks=3)
        self.assertEqual(self.density(run).sum(), 24 * 8 * 4)
        self.assertIn("1 closed surface, [25,-30,7]..[65,-10,17] in the file, not inside another", run.stderr)

    def test_cavities(self):
        inner = box_triangles(LOW + 2.5, HIGH - 2.5)
        self.write_stl("bar.stl", np.concatenate([box_triangles(LOW, HIGH), inner[:, ::-1]]))
        run = self.simulate(bar(least_elements=0))
        self.assertEqual(self.density(run).sum(), 24 * 8 * 4 - 22 * 6 * 2)
        self.assertIn("taken as a cavity", run.stderr)
        self.write_stl("bar.stl", np.concatenate([box_triangles(LOW, HIGH), inner]))
        run = self.simulate(bar(least_elements=0))
        self.assertEqual(self.density(run).sum(), 24 * 8 * 4)
        self.assertIn("taken as solid; if it is a cavity, turn it round", run.stderr)

    def test_a_stray_triangle(self):
        stray = np.array([[[1e5, 0, 0], [1e5, 0, 1e-3], [1e5, 1e-3, 0]]])
        self.write_stl("bar.stl", np.concatenate([box_triangles(LOW, HIGH), stray]))
        run = self.simulate(bar())
        self.assertEqual(run.json("config.json")["domain"]["elements"], [24, 8, 4])
        self.assertIn("1 stray triangle at [100000,0,0]", run.stderr)

    def test_far_from_the_origin(self):
        """Single precision has steps of 4 there."""
        away = np.array([5e7, 0, 0])
        with open(os.path.join(self.directory, "bar.stl"), "w", encoding="utf-8") as file:
            file.write(stl_text(box_triangles(LOW + away, HIGH + away)).replace("e+07", "e7"))
        run = self.simulate(bar())
        self.assertEqual(self.density(run).sum(), 24 * 8 * 4)

    def test_units(self):
        self.write_three_mf("bar.3mf", box_triangles(LOW, HIGH) / 25.4, "inch")
        config = bar(file="bar.3mf")
        config["domain"]["unit"] = "mm"
        run = self.simulate(config)
        self.assertIn("is in inch, converted to mm", run.stderr)
        np.testing.assert_allclose(run.json("config.json")["domain"]["size"], [60, 20, 10])
        placement = np.array(run.json("config.json")["run"]["mesh_placement"])
        np.testing.assert_allclose(placement @ [*LOW / 25.4, 1], [5, -30, 0], atol=1e-5)  # single precision
        config["part"]["mesh"]["scale"] = 0.5
        config["domain"]["element"] = 1.25
        np.testing.assert_allclose(self.simulate(config).json("config.json")["domain"]["size"], [30, 10, 5])
        config = bar(file="bar.3mf", scale=25.4)
        run = self.simulate(config)
        self.assertIn("is in inch, but domain.unit names no unit of length", run.stderr)
        np.testing.assert_allclose(run.json("config.json")["domain"]["size"], [60, 20, 10])

    def write_three_mf(self, name, triangles, unit):
        vertices = "".join('<vertex x="{:.12g}" y="{:.12g}" z="{:.12g}"/>'.format(*x) for x in triangles.reshape(-1, 3))
        numbers = "".join(f'<triangle v1="{3 * t}" v2="{3 * t + 1}" v3="{3 * t + 2}"/>' for t in range(len(triangles)))
        model = (f'<model unit="{unit}" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources>'
                 f'<object id="1"><mesh><vertices>{vertices}</vertices><triangles>{numbers}</triangles></mesh></object>'
                 '</resources><build><item objectid="1"/></build></model>')
        packages = "http://schemas.openxmlformats.org/package/2006"
        types = "".join(f'<Default Extension="{extension}" ContentType="application/{kind}+xml"/>' for extension, kind in (
            ("rels", "vnd.openxmlformats-package.relationships"), ("model", "vnd.ms-package.3dmanufacturing-3dmodel")))
        with zipfile.ZipFile(os.path.join(self.directory, name), "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("[Content_Types].xml", f'<Types xmlns="{packages}/content-types">{types}</Types>')
            archive.writestr("_rels/.rels", f'<Relationships xmlns="{packages}/relationships"><Relationship Id="model" '
                             'Target="/3D/3dmodel.model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>'
                             '</Relationships>')
            archive.writestr("3D/3dmodel.model", model)


class CheckTest(MeshTest):
    def test_what_check_says(self):
        config = bar()
        config["constraints"] = [{"type": "layer_thickness", "target": 2.0}]
        run = self.run_config(2, config, "-task", "check")
        self.assert_done(run)
        for words in ("mesh: 12 triangles, volume 12000; its elements have 1.0000 times as much",
                      "placed in [5,-30,0] to [65,-10,10]", "volume 12000",
                      "thinnest wall: 4 elements", "elements per layer: 0.8", "by default 8", "plate contact: 192 elements"):
            self.assertIn(words, run.stdout)
        for words in ("become ragged", "no sequence satisfies"):
            self.assertIn(words, run.stderr)

    def test_grid_sequencing(self):
        run = self.run_config(2, bar(), "-max_iterations", 1, "-coarse_iterations", 2)
        self.assert_done(run)
        self.assertIn("2 iterations on [12,4,2] elements", run.stdout)


class RefusalTest(MeshTest):
    def test_thin_walls(self):
        config = bar()
        config["domain"]["element"] = 5
        self.assert_refused(config, "/part/mesh", "2 elements across the wall at [", "3 or more", "least_elements")
        config["part"]["mesh"]["least_elements"] = 2
        self.simulate(config)

    def test_no_volume(self):
        self.write_stl("bar.stl", np.concatenate([box_triangles(LOW, HIGH)[:1], box_triangles(LOW, HIGH)[:1, ::-1]]))
        self.assert_refused(bar(), "/part/mesh/file", "bar.stl", "no volume")

    def test_files(self):
        os.mkfifo(os.path.join(self.directory, "pipe.stl"))
        for name, words in (("nothing.stl", "No such file"), ("pipe.stl", "regular file"), ("/dev/zero", "regular file"),
                            ("case.json", "STL")):
            self.assert_refused(bar(file=name), "/part/mesh/file", words)

    def test_keys(self):
        for mesh, words in (({"rotate": ["x", 90]}, "/part/mesh/rotate/0"), ({"rotate": [["w", 90]]}, "[axis, degrees]"),
                            ({"rotate": [[[0, 0, 0], 90]]}, "[axis, degrees]"), ({"place": "air"}, "plate, as_is"),
                            ({"scale": 0}, "> 0"), ({"fill": "black"}, "grey")):
            self.assert_refused(bar(**mesh), "/part/mesh/", words)
        for domain, words in (({"element": 0}, "/domain/element"), ({"element": [1, 2]}, "/domain/element"),
                              ({"element": 2.5, "margin": -1}, "/domain/margin"), ({}, "/domain/"),
                              ({"element": 2.5, "size": [1, 1, 1]}, "/domain/size"), ({"element": 1e-9}, "/domain/element")):
            config = bar()
            config["domain"] = domain
            self.assert_refused(config, words)
        config = bar()
        config["part"] = {"box": {"min": [0, 0, 0], "max": [1, 1, 1]}}
        self.assert_refused(config, "/domain/")


if __name__ == "__main__":
    run_fabseq.main()
