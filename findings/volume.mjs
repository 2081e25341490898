// SPDX-License-Identifier: MIT
// The triangles and the signed volume of a three.js geometry, as text.
export function volume(geometry) {
  const p = (geometry.index ? geometry.toNonIndexed() : geometry).attributes.position;
  const corner = (i) => [p.getX(i), p.getY(i), p.getZ(i)];
  let sum = 0;
  for (let i = 0; i < p.count; i += 3) {
    const [a, b, c] = [corner(i), corner(i + 1), corner(i + 2)];
    sum += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return `${p.count / 3} triangles, ${(sum / 6).toFixed(3)} mm3`;
}
