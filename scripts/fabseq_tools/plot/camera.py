# SPDX-License-Identifier: MIT
"""From where the pictures of a part are seen."""

import itertools

import numpy as np

from fabseq_tools.geometry.grid import in_space

MARGIN = 0.06  # of the longest side: how far the plate and the picture reach beyond the box
VIEW_DIRECTION = (0.62, -1.0, 0.55)  # from the part towards the eye, z up


class View:
    """Parallel projection along VIEW_DIRECTION (2D: straight down) that just holds `frame` and the plate.
    `scale`: half the height of what is seen."""

    def __init__(self, part, frame, pixels):
        margin = MARGIN * max(part.size)
        box = in_space(np.array(list(itertools.product(*((-margin, s + margin) for s in part.size)))))
        points, self.pixels = np.vstack([frame, box]), pixels
        view, self.up = (VIEW_DIRECTION, (0.0, 0.0, 1.0)) if part.dimension == 3 else ((0.0, 0.0, 1.0), (0.0, 1.0, 0.0))
        self.toward = np.array(view) / np.linalg.norm(view)
        self.right = np.cross(self.up, self.toward)
        self.right /= np.linalg.norm(self.right)
        self.upward = np.cross(self.toward, self.right)
        horizontal, vertical, depth = points @ self.right, points @ self.upward, points @ self.toward
        self.middle = 0.5 * ((horizontal.min() + horizontal.max()) * self.right + (vertical.min() + vertical.max()) * self.upward)
        self.distance = depth.max() + 2.0 * np.ptp(depth) + max(part.size)
        self.scale = 0.51 * max(np.ptp(vertical), np.ptp(horizontal) * pixels[1] / pixels[0])

    def places(self, points):
        """Of points in the picture: columns and rows of pixels."""
        across, above = (points - self.middle) @ self.right, (points - self.middle) @ self.upward
        size = 0.5 * self.pixels[1] / self.scale
        return 0.5 * self.pixels[0] + size * across, 0.5 * self.pixels[1] - size * above


def aim_camera(renderer, view):
    camera = renderer.GetActiveCamera()
    camera.ParallelProjectionOn()
    camera.SetFocalPoint(*view.middle)
    camera.SetPosition(*(view.middle + view.distance * view.toward))
    camera.SetViewUp(*view.up)
    camera.SetParallelScale(view.scale)
    renderer.ResetCameraClippingRange()
