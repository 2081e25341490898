// SPDX-License-Identifier: MIT
// Arrays as fabseq_tools/report/views.py packs them: base64 of deflated bytes; low bytes before high ones;
// differences along each axis; 16-bit steps from the smallest value on.

export const MISSING = 65535;

// Numbers of an array, and its shape. Where there is no value the number is `missing`.
export async function unpack(packed, missing = NaN) {
  const bytes = Uint8Array.from(atob(packed.data), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  const halves = new Uint8Array(await new Response(stream).arrayBuffer());
  const count = halves.length / 2;
  const steps = new Uint16Array(count);
  for (let i = 0; i < count; i++) {
    const folded = halves[i] | (halves[count + i] << 8);
    steps[i] = (folded >> 1) ^ -(folded & 1);
  }
  sumUp(steps, packed.shape, packed.leading);
  const values = new Float32Array(count);
  for (let i = 0; i < count; i++) values[i] = steps[i] === MISSING ? missing : packed.low + packed.step * steps[i];
  return { values, shape: packed.shape };
}

// Undoes differences along all axes but the `leading` ones, in place.
function sumUp(steps, shape, leading) {
  let stride = steps.length;
  shape.forEach((length, axis) => {
    const block = stride;
    stride /= length;
    if (axis < leading) return;
    for (let start = 0; start < steps.length; start += block) {
      for (let i = start + stride; i < start + block; i++) steps[i] += steps[i - stride];
    }
  });
}
