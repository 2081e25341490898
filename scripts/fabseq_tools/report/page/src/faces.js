// SPDX-License-Identifier: MIT
// Faces of the part's elements, those of the surface and those between two elements. A face is seen while the
// element on one of its sides is built and what is on the other is not: so the part is closed at any time.

const NONE = -1;

// `places`: four numbers a face: x, y, z of the element behind it (along its axis), and the axis. `before`,
// `behind`: the elements on both sides, or NONE. Elements are z, y, x as in the files. In 2D the faces are the
// elements themselves.
export function facesOf(built, [nz, ny, nx], flat) {
  const places = [], before = [], behind = [];
  const at = (x, y, z) => {
    const number = (z * ny + y) * nx + x;
    return x >= 0 && y >= 0 && z >= 0 && x < nx && y < ny && z < nz && built[number] > 0 ? number : NONE;
  };
  for (let z = 0; z <= nz; z++) {
    for (let y = 0; y <= ny; y++) {
      for (let x = 0; x <= nx; x++) {
        for (let axis = flat ? 2 : 0; axis < 3; axis++) {
          const sides = [at(x - (axis === 0), y - (axis === 1), z - (axis === 2)), at(x, y, z)];
          if (flat ? sides[0] === NONE : sides[0] === sides[1]) continue;
          places.push(x, y, z, axis);
          before.push(sides[0]);
          behind.push(sides[1]);
        }
      }
    }
  }
  return { places: Uint16Array.from(places), before: Int32Array.from(before), behind: Int32Array.from(behind) };
}

// Copies the faces that are seen at a time to `seen`, with 3 added to the axis where the built element is the
// one behind; returns how many there are. The graphics card could sort them out as well, but then computers
// without one would have to look at every face for every picture.
export function chooseFaces({ places, before, behind }, times, now, seen) {
  let count = 0;
  for (let face = 0; face < before.length; face++) {
    const first = before[face] !== NONE && times[before[face]] <= now;
    const second = behind[face] !== NONE && times[behind[face]] <= now;
    if (first === second) continue;
    for (let k = 0; k < 4; k++) seen[4 * count + k] = places[4 * face + k];
    if (second) seen[4 * count + 3] += 3;
    count++;
  }
  return count;
}
