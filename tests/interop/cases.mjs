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

/// Files of one kind: every combination, made by `scenegen` with the arguments given (a list, or one for each form).
function filesOf(programs, folder, name, argumentsOf) {
  return combinations.map((form) => {
    const file = path.join(folder, `${name}_${form.layout}_${form.visibility}.glb`);
    run(path.join(programs, 'scenegen'), [...argumentsOf, '--quiet', '--layout', form.layout, '--visibility', form.visibility, '-o', file]);
    return { ...form, file };
  });
}

const kHouse = ['--building-size', '4x4', '--floor-courses', '8', '--floors', '1', '--ground', 'off', '--windows', 'off', '--cells', '4x4x4',
  '--interval', '0.5'];  // no windows, and seen from behind: our pictures of ids leave glass out

/// Houses out of the generator, with textures: one that appears, one in green while it is built, one that comes down.
function generatedCases(programs, folder) {
  const camera = writeCamera(path.join(folder, 'house_camera.json'), [5, 4, -6.5], [0, 1.3, 0], 0.5);
  const common = { features: false, camera };
  const files = (name, color, ...args) => filesOf(programs, folder, name, [...kHouse, ...args]).map((form) => ({ ...form, color }));
  return [
    { ...common, name: 'generated', times: [0, 6, 9.75, 16.5, 22.25, 32.5, 20, 12.5], files: files('appear', undefined, '--coherence', '0.9') },
    { ...common, name: 'generated, construct', times: [0, 6, 16.75, 33, 12.25], files: files('construct', 'swap', '--profile', 'construct', '--profile-duration', '2') },
    // Bricks are textured, so that their colours are not judged: the grid does that.
    { ...common, name: 'generated, demolish, pointer', color: 'pointer', times: [0, 9.25, 20, 34, 14.75], files: files('demolish', undefined, '--profile', 'demolish', '--profile-duration', '2', '--color', 'pointer') },
    { ...common, name: 'generated, drop', times: [0.25, 9, 16.6, 33, 12.25], files: files('drop', undefined, '--profile', 'drop', '--profile-duration', '2') },
  ];
}

/// A static model that was made dynamic: along a curve, and by a plan.
function authoredCases(programs, folder) {
  const scenegen = path.join(programs, 'scenegen'), model = path.join(folder, 'static.glb'), plan = path.join(folder, 'plan.csv');
  const house = kHouse.slice(0, kHouse.indexOf('--cells'));
  run(scenegen, [...house, '--curve', 'none', '--quiet', '-o', model]);
  writeFileSync(plan, `id,name,start,finish,type,objects
1,Walls,2024-03-01,2024-03-09,construct,name=*/floor_0/brick*
2,Joinery,2024-03-08,2024-03-11,drop,name=*/floor_0/frame*;name=*/floor_0/door*
3,Roof,2024-03-10,2024-03-17,construct,name=*/roof/*
`);
  const camera = path.join(folder, 'house_camera.json');
  // In layout `nodes` the model's own document, with times; in the others what `optimize` makes of that.
  const files = (name, args) => combinations.map(({ layout, visibility }) => {
    const fileOf = (form) => path.join(folder, `${name}_${form}_${visibility}.glb`);
    if (layout === 'nodes') run(scenegen, [...args, '--visibility', visibility, '--quiet', '-o', fileOf('nodes')]);
    else run(scenegen, ['optimize', fileOf('nodes'), '--layout', layout, '--visibility', visibility, '--quiet', '-o', fileOf(layout)]);
    return { layout, visibility, color: 'swap', file: fileOf(layout) };
  });
  return [
    { name: 'animated', features: false, camera, times: [0, 6, 16.75, 33, 12.25],
      files: files('animated', ['animate', model, '--cells', '4x4x4', '--interval', '0.5', '--profile', 'construct', '--profile-duration', '2']) },
    { name: 'scheduled', features: false, camera, times: [0.25, 4.375, 9.6875, 17, 7.8125], files: files('scheduled', ['schedule', model, plan, '--unmatched', 'hide']) },
  ];
}

export function makeCases(programs, folder) {
  mkdirSync(folder, { recursive: true });
  return [...gridCases(programs, folder), ...generatedCases(programs, folder), ...authoredCases(programs, folder)];
}
