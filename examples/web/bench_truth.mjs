// Whether a viewer shows what is there: its pictures beside the ids that `sceneplay frames --ids` draws.
import { execFileSync } from 'node:child_process';
import { readFileSync, rmSync } from 'node:fs';
import path from 'node:path';
import { pathToFileURL } from 'node:url';

const kReach = 2;  // edges are drawn a little differently by every rasteriser

/// [Uint8Array]: for each time one byte a pixel, 1 where an opaque or masked object is.
export async function coverageOf(file, { sceneplay, times_s, size: [width, height], cameraPath, folder, modules }) {
  rmSync(folder, { recursive: true, force: true });
  execFileSync(sceneplay, ['frames', file, '-o', folder, '--ids', '--size', `${width}x${height}`, '--samples', '1', '--shadows', 'off',
    '--times', times_s.join(','), '--camera-path', cameraPath, '--quiet'], { stdio: ['ignore', 'ignore', 'pipe'] });
  const { PNG } = (await import(pathToFileURL(path.join(modules, 'pngjs', 'lib', 'png.js')).href)).default;
  const found = times_s.map((_, i) => {
    const { data } = PNG.sync.read(readFileSync(path.join(folder, `ids_${String(i).padStart(5, '0')}.png`)));
    return Uint8Array.from({ length: width * height }, (__, p) => (data.readUInt32LE(4 * p) === 0xffffffff ? 0 : 1));
  });
  rmSync(folder, { recursive: true, force: true });
  return found;
}

/// {pixels, right}: of the pixels round which ours shows something everywhere, or nothing, those where the viewer does too.
export function agreement(ours, theirs, [width, height]) {
  let pixels = 0, right = 0;
  for (let y = kReach; y < height - kReach; y += 1) {
    for (let x = kReach; x < width - kReach; x += 1) {
      const here = ours[y * width + x];
      let clear = true;
      for (let row = y - kReach; clear && row <= y + kReach; row += 1) {
        for (let column = x - kReach; clear && column <= x + kReach; column += 1) clear = ours[row * width + column] === here;
      }
      if (!clear) continue;
      pixels += 1;
      right += theirs[y * width + x] === here ? 1 : 0;
    }
  }
  return { pixels, right };
}
