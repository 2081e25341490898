# SPDX-License-Identifier: MIT
"""How the torch stands about its own axis: x axes of the tool's frames along passes, and their Euler angles.

A frame's z axis points against the build direction, as the torch does. `still`: within a pass the frame turns
by the least rotation that carries its axis from waypoint to waypoint, so never about the axis. On closed ways
of a tilted axis that adds up (by the solid angle that the axis goes around): where a pass ends more than
MOST_TWIST from the frame that the least rotation from the plate's normal gives, the next one begins in that
frame, and the torch turns back in between. `travel`: x axes point against the travel."""

import numpy as np

ABOUT_AXIS = ("still", "travel")
MOST_TWIST = 90.0    # degrees
OVERHEAD = -0.95     # cosine with the plate's inner normal: beyond it the least rotation from there is arbitrary
UPRIGHT = 1e-5       # radians between the axis and z: nearer, it has no azimuth


def set_frames(passes, up, about="still"):
    """Sets the x axes of all passes; `up`: unit normal of the plate, in their coordinates."""
    reference = Reference(up)
    x, before = None, None
    for one in passes:
        down = -one.axes
        if about == "travel":
            one.x_axes = against_travel(one, reference)
            continue
        x = reference.x_axis(down[0]) if x is None else carried(x, before, down[0])
        if abs(reference.twist(x, down[0])) > MOST_TWIST:
            x = reference.x_axis(down[0])
        one.x_axes = np.empty_like(down)
        for number, direction in enumerate(down):
            x = carried(x, down[max(number - 1, 0)], direction)
            one.x_axes[number] = x
        before = down[-1]


class Reference:
    """The frame that the least rotation of one, which points at the plate, gives to a torch."""

    def __init__(self, up):
        self.down = -np.asarray(up, float)
        first = np.eye(3)[np.argmin(np.round(np.abs(self.down), 6))]  # x where the plate's normal is y or z
        first = first - (first @ self.down) * self.down
        self.first = first / np.linalg.norm(first)

    def x_axis(self, direction):
        return carried(self.first, self.down, direction)

    def twist(self, x, direction):
        """Degrees from this frame to another one, about the torch; 0 where it points away from the plate."""
        if direction @ self.down < OVERHEAD:
            return 0.0
        own = self.x_axis(direction)
        return float(np.degrees(np.arctan2(np.cross(own, x) @ direction, own @ x)))


def carried(x, before, after):
    """A vector at right angles with the unit vector `before`, turned as the least rotation turns that to
    `after`."""
    both = 1.0 + before @ after
    if both > 1e-9:
        x = x - (x @ after) / both * (before + after)
    x = x - (x @ after) * after
    return x / np.linalg.norm(x)


def against_travel(one, reference):
    across = across_travel(one)
    x = np.cross(one.axes, across)
    without = np.linalg.norm(across, axis=1) < 0.5
    for number in np.flatnonzero(without):
        x[number] = reference.x_axis(-one.axes[number])
    return x


def across_travel(one):
    """Unit vectors at right angles with axis and travel; 0 where these are parallel."""
    across = np.cross(one.axes, np.gradient(one.points, axis=0))
    length = np.linalg.norm(across, axis=1)
    return across / np.where(length > 0, length, 1.0)[:, None]


def euler_angles(x_axes, z_axes):
    """Angles a, b, c (n, 3) in radians with RotZ(a) RotY(b) RotZ(c) the frames of a sequence, each as near to
    the one before as these angles allow; they may leave a single turn."""
    directions = turning_angles(z_axes)
    result, c = np.empty((len(z_axes), 3)), 0.0
    for number, (x, (a, b)) in enumerate(zip(x_axes, directions)):
        u = np.array([np.cos(a) * np.cos(b), np.sin(a) * np.cos(b), -np.sin(b)])
        v = np.array([-np.sin(a), np.cos(a), 0.0])
        c = nearest(np.arctan2(x @ v, x @ u), c)
        result[number] = a, b, c
    return result


def turning_angles(z_axes, before=None):
    """Angles a, b (n, 2) in radians with RotZ(a) RotY(b) z the directions of a sequence, each as near to the
    one before as these angles allow; they may leave a single turn. Upright ones keep a. `before`: the angles
    that the first is near to."""
    level = np.hypot(z_axes[:, 0], z_axes[:, 1])
    azimuth, polar = np.arctan2(z_axes[:, 1], z_axes[:, 0]), np.arctan2(level, z_axes[:, 2])
    result = np.empty((len(z_axes), 2))
    a, b = (0.0, polar[0]) if before is None else before
    for number in range(len(z_axes)):
        if level[number] < UPRIGHT:
            b = nearest(round(polar[number] / np.pi) * np.pi, b)
        elif number == 0 and before is None:
            a = azimuth[0]
        else:
            choices = [(nearest(azimuth[number], a), nearest(polar[number], b)),
                       (nearest(azimuth[number] + np.pi, a), nearest(-polar[number], b))]
            a, b = min(choices, key=lambda one: abs(one[0] - a) + abs(one[1] - b))
        result[number] = a, b
    return result


def nearest(angle, to):
    """The angle, by whole turns nearest to another."""
    return angle + 2.0 * np.pi * np.round((to - angle) / (2.0 * np.pi))
