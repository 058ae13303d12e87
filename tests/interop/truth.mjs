// What is to be seen: object ids per pixel as `sceneplay frames --ids` draws them, and the colour of each object as our
// player says (program interop_truth).
import { execFileSync } from 'node:child_process';
import { readFileSync, rmSync } from 'node:fs';
import path from 'node:path';
import { PNG } from 'pngjs';

export const kNobody = 0xffffffff;

const toByte = (linear) => 255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055);

/// {names, width, height, frames: Map(time_s → {ids: Uint32Array, colors: {id: [r, g, b] in 0 … 255, or null}})}
export function truthOf(file, { programs, times, size: [width, height], cameraPath, folder }) {
  rmSync(folder, { recursive: true, force: true });
  execFileSync(path.join(programs, 'sceneplay'), ['frames', file, '-o', folder, '--ids', '--size', `${width}x${height}`, '--samples', '1',
    '--shadows', 'off', '--times', times.join(','), '--camera-path', cameraPath, '--quiet'], { stdio: ['ignore', 'ignore', 'pipe'] });
  const said = JSON.parse(execFileSync(path.join(programs, 'interop_truth'), [file, ...times.map(String)], { maxBuffer: 2 ** 30 }));
  const frames = new Map();
  said.frames.forEach((frame, i) => {
    const { data } = PNG.sync.read(readFileSync(path.join(folder, `ids_${String(i).padStart(5, '0')}.png`)));
    const ids = Uint32Array.from({ length: width * height }, (_, p) => data.readUInt32LE(4 * p));
    const colors = Object.fromEntries(Object.entries(frame.colors).map(([id, color]) => [id, color?.map(toByte) ?? null]));
    frames.set(times[i], { ids, colors });
  });
  return { names: said.objects, duration_s: said.duration_s, width, height, frames };
}
