// The files that are played in the viewers, made with our own programs.
import { execFileSync } from 'node:child_process';
import { mkdirSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { kLayouts, kVisibilities } from './expectations.mjs';

const run = (program, args) => execFileSync(program, args, { stdio: ['ignore', 'ignore', 'pipe'] });
const combinations = kLayouts.flatMap((layout) => kVisibilities.map((visibility) => ({ layout, visibility })));

function writeCamera(file, eye_m, target_m, yfov_rad) {
  writeFileSync(file, JSON.stringify({ keys: [{ time_s: 0, eye_m, target_m, yfov_rad }] }));
  return file;
}

/// Objects on a grid, one or more of every kind. `features`: names begin with what is asked of the viewer.
function gridCases(programs, folder) {
  run(path.join(programs, 'interop_write_viewer_samples'), [folder]);
  return ['swap', 'pointer'].map((color) => ({
    name: `grid, ${color}`, features: true, camera: path.join(folder, 'camera.json'), times: [0, 1, 1.25, 2, 2.75, 3.5, 4, 3, 0.5, 1.5],
    files: combinations.map((form) => ({ ...form, color, file: path.join(folder, `grid_${color}_${form.layout}_${form.visibility}.glb`) })),
  }));
}

/// A house out of the generator, with textures. No windows: our pictures of ids leave glass out.
function townCase(programs, folder) {
  const file = ({ layout, visibility }) => path.join(folder, `town_${layout}_${visibility}.glb`);
  for (const form of combinations) {
    run(path.join(programs, 'scenegen'), ['--building-size', '4x4', '--floor-courses', '8', '--floors', '1', '--ground', 'off', '--windows', 'off', '--cells', '4x4x4',
      '--interval', '0.5', '--coherence', '0.9', '--quiet', '--layout', form.layout, '--visibility', form.visibility, '-o', file(form)]);
  }
  return {
    name: 'generated', features: false, camera: writeCamera(path.join(folder, 'town_camera.json'), [5, 4, 6.5], [0, 1.3, 0], 0.5),
    times: [0, 6, 9.75, 16.5, 22.25, 32.5, 20, 12.5], files: combinations.map((form) => ({ ...form, file: file(form) })),
  };
}

export function makeCases(programs, folder) {
  mkdirSync(folder, { recursive: true });
  return [...gridCases(programs, folder), townCase(programs, folder)];
}
