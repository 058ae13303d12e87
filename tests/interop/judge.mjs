// Compares a viewer's pixels with the truth. Only pixels count whose whole neighbourhood shows the same object (or none),
// so that edges, which every rasteriser draws a little differently, do not matter.
import { kNobody } from './truth.mjs';

const kReach = 2;          // pixels round the one judged
const kFewPixels = 6;      // an object with less than this many clear pixels is not judged
const kNone = new Set();
const kWrongShare = 0.1;   // of an object's clear pixels

const distance = (data, at, color) =>
  Math.max(Math.abs(data[at] - color[0]), Math.abs(data[at + 1] - color[1]), Math.abs(data[at + 2] - color[2]));

function isClear(ids, width, x, y) {
  const id = ids[y * width + x];
  for (let row = y - kReach; row <= y + kReach; row += 1) {
    for (let column = x - kReach; column <= x + kReach; column += 1) if (ids[row * width + column] !== id) return false;
  }
  return true;
}

/// Who was at a pixel, or beside it (smoothed edges reach that far), at any of the times: on them falls what is seen there
/// when nothing should be.
export function ownersOf(truth) {
  const { width, height } = truth;
  const owners = Array.from({ length: width * height }, () => null);
  const own = (x, y, id) => {
    if (x < 0 || y < 0 || x >= width || y >= height) return;
    (owners[y * width + x] ??= new Set()).add(id);
  };
  for (const { ids } of truth.frames.values()) {
    ids.forEach((id, pixel) => {
      if (id === kNobody) return;
      const x = pixel % width, y = (pixel - x) / width;
      for (let row = y - 1; row <= y + 1; row += 1) for (let column = x - 1; column <= x + 1; column += 1) own(column, row, id);
    });
  }
  return owners;
}

/// {judged: Set(id), wrong: Set(id), stray: pixels that should be background and where no object ever is}.
export function judge(truth, owners, time_s, image, { background, tolerance }) {
  const { width, height } = truth;
  if (image.width !== width || image.height !== height) throw new Error(`image is ${image.width}x${image.height}, not ${width}x${height}`);
  const { ids, colors } = truth.frames.get(time_s);
  const clear = new Map(), bad = new Map();
  const count = (map, id) => map.set(id, (map.get(id) ?? 0) + 1);
  let stray = 0;
  for (let y = kReach; y < height - kReach; y += 1) {
    for (let x = kReach; x < width - kReach; x += 1) {
      if (!isClear(ids, width, x, y)) continue;
      const pixel = y * width + x, id = ids[pixel], away = distance(image.data, 4 * pixel, background);
      if (id === kNobody) {
        const here = owners[pixel] ?? kNone;
        for (const owner of here) count(clear, owner);
        if (away <= tolerance) continue;
        if (here.size === 0) stray += 1;
        for (const owner of here) count(bad, owner);
      } else {
        count(clear, id);
        const color = colors[id];
        if (color === undefined) throw new Error(`object ${id} is drawn at ${time_s} s, but hidden for the player`);
        if (color === null ? away <= tolerance : distance(image.data, 4 * pixel, color) > tolerance) count(bad, id);
      }
    }
  }
  const judged = new Set(), wrong = new Set();
  for (const [id, pixels] of clear) {
    if (pixels < kFewPixels) continue;
    judged.add(id);
    if ((bad.get(id) ?? 0) > kWrongShare * pixels) wrong.add(id);
  }
  return { judged, wrong, stray };
}
