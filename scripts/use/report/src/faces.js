// SPDX-License-Identifier: MIT
// Faces of the part's elements: those of the surface first, then those between two elements. A face between
// two elements is seen while one of them is built and the other is not, so that the part is closed at any time.

// Four numbers each: x, y, z of the element behind the face (along the axis), and the axis. Elements are
// z, y, x as in the files. In 2D the faces are the elements themselves.
export function facesOf(built, [nz, ny, nx], flat) {
  const surface = [], inner = [];
  const at = (x, y, z) => x >= 0 && y >= 0 && z >= 0 && x < nx && y < ny && z < nz && built[(z * ny + y) * nx + x] > 0;
  const axes = flat ? [2] : [0, 1, 2];
  for (let z = 0; z <= nz; z++) {
    for (let y = 0; y <= ny; y++) {
      for (let x = 0; x <= nx; x++) {
        const here = at(x, y, z);
        for (const axis of axes) {
          const before = at(x - (axis === 0), y - (axis === 1), z - (axis === 2));
          if (flat ? before : here !== before) surface.push(x, y, z, axis);
          else if (here && before) inner.push(x, y, z, axis);
        }
      }
    }
  }
  const faces = new Uint16Array(surface.length + inner.length);
  faces.set(surface);
  faces.set(inner, surface.length);
  return { faces, surface: surface.length / 4 };
}
