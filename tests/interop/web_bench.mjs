// node web_bench.mjs --source FOLDER --programs FOLDER --out FOLDER: `node examples/web/bench.mjs` with a small scene: figures of both
// viewers and of sceneplay in one file, what fails beside what does not, and words for what cannot be.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import { mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import process from 'node:process';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { parseArgs } from 'node:util';

const { values: options } = parseArgs({ options: { source: { type: 'string' }, programs: { type: 'string' }, out: { type: 'string' } } });
const kWeb = path.join(options.source, 'examples', 'web'), kModules = path.join(path.dirname(fileURLToPath(import.meta.url)), 'node_modules');
const file = (name) => path.join(options.out, name);
const bench = (...args) => spawnSync(process.execPath, [path.join(kWeb, 'bench.mjs'), '--modules', kModules, ...args], { encoding: 'utf8' });
const small = ['--camera-path', file('path.json'), '--warm-up', '1', '--size', '160x120', '--samples', '1', '--quiet'];

function makeFiles() {
  rmSync(options.out, { recursive: true, force: true });
  mkdirSync(options.out, { recursive: true });
  execFileSync(path.join(options.programs, 'scenegen'), ['--building-size', '4x4', '--floor-courses', '8', '--floors', '1', '--ground', 'off', '--windows', 'off',
    '--cells', '4x4x4', '--interval', '0.5', '--quiet', '-o', file('house.glb')]);
  writeFileSync(file('broken.glb'), readFileSync(file('house.glb')).subarray(0, 3000));
  writeFileSync(file('path.json'), JSON.stringify({ keys: [
    { time_s: 0, eye_m: [5, 4, -6.5], target_m: [0, 1.3, 0] }, { time_s: 12, eye_m: [8, 3, 2], target_m: [0, 1, 0], yfov_rad: 0.7 },
    { time_s: 33, eye_m: [2, 5, 8], target_m: [0, 1.3, 0] }] }));
}

function checkFigures() {
  const run = bench(file('broken.glb'), file('house.glb'), ...small, '--frames', '4', '--repeat', '1', '-o', file('results'), '--sceneplay',
    path.join(options.programs, 'sceneplay'), '--strategy', 'instanced');
  assert.equal(run.status, 3, run.stderr);
  const found = JSON.parse(readFileSync(file('results/bench.json'), 'utf8'));
  assert.equal(found.schema, 'sceneplay/bench');
  assert.equal(found.settings.readback, true);
  const of = (name) => found.cases.filter((one) => path.basename(one.file) === name);
  assert.equal(of('broken.glb').length, 3);
  for (const one of of('broken.glb')) assert.ok(one.error.length > 5 && one.frameMs === undefined, JSON.stringify(one));
  assert.deepEqual(of('house.glb').map((one) => one.strategy), ['three.js', 'Babylon.js', 'instanced']);
  for (const one of of('house.glb')) {
    assert.equal(one.error, undefined);
    assert.deepEqual([one.frames, one.repetitions], [4, 1], one.strategy);
    assert.ok(one.frameMs.min > 0 && one.frameMs.median <= one.frameMs.p95 && one.vsBest >= 1, one.strategy);
    assert.ok(one.processCpuMs.mean > 0, `${one.strategy}: processor time of all threads`);
    if (one.strategy === 'instanced') continue;
    assert.match(one.device, /SwiftShader/);
    assert.deepEqual([one.samples, one.overTime.timeS.length], [1, 4]);
    assert.ok(one.loadMs > 0 && one.startMs > 0 && one.memoryBytes > 3e7 && one.jsHeapBytes > 1e6 && one.processCpuMs.mean >= 0, one.strategy);
    assert.ok(one.correctness > 99.5, `${one.strategy}: ${one.correctness} %`);
    assert.deepEqual(one.warnings, []);
  }
  assert.equal(readFileSync(file('results/bench.csv'), 'utf8').trim().split('\n').length, 1 + found.cases.length);
  // All three stand in one table of a report, with what failed.
  const report = JSON.parse(execFileSync(path.join(options.programs, 'sceneplay'), ['report', file('results/bench.json'), '-o', '-', '--format', 'json'], { encoding: 'utf8' }));
  const [section] = report.runs[0].sections, frames = section.blocks.filter((block) => block.title === 'Frame time: house.glb, path.json');
  assert.equal(frames.length, 1);
  const cpu = frames[0].columns.findIndex((column) => column.name === 'processCpuMs');
  assert.deepEqual(frames[0].rows.map((row) => row[0].split(' ')[0]), ['three.js', 'Babylon.js', 'instanced']);
  for (const [i, one] of of('house.glb').entries()) assert.equal(frames[0].rows[i][cpu], one.processCpuMs.mean);
  assert.equal(section.failures.length, 3);
}

/// What is out of place is found: all of it, or a part.
async function checkComparison() {
  const { agreement } = await import(pathToFileURL(path.join(kWeb, 'bench_truth.mjs')).href);
  const size = [20, 10], left = Uint8Array.from({ length: 200 }, (_, i) => (i % 20 < 10 ? 1 : 0)), nothing = new Uint8Array(200);
  const pixels = 6 * 12;  // not the two at each edge of the picture, nor the two on each side of where it changes
  assert.deepEqual(agreement(left, left, size), { pixels, right: pixels });
  assert.deepEqual(agreement(left, nothing, size), { pixels, right: pixels / 2 });
}

function checkRefusals() {
  const refused = (code, pattern, ...args) => {
    const { status, stderr } = bench(...args);
    assert.equal(status, code, `${args.join(' ')}: ${stderr}`);
    assert.match(stderr, pattern);
    assert.equal(stderr.trim().split('\n').length, 1, stderr);
  };
  refused(2, /no FILE/);
  refused(2, /--output: missing/, 'a.glb', '--camera-path', 'p.json');
  refused(2, /unknown viewer 'tree'; one of three, babylon/, 'a.glb', ...small, '-o', file('none'), '--viewer', 'tree');
  refused(2, /--frames: '0' is not a whole number from 1/, 'a.glb', ...small, '-o', file('none'), '--frames', '0');
  refused(3, /nothere\.json: there is no such file/, 'a.glb', '-o', file('none'), '--camera-path', 'nothere.json');
  refused(3, /loading|the page|the viewer|first frame/, file('house.glb'), ...small, '-o', file('late'), '--limit', '1', '--viewer', 'three', '--frames', '100000');
  assert.match(JSON.parse(readFileSync(file('late/bench.json'), 'utf8')).cases[0].error, /took longer than the 1 s that a case may take/);
}

makeFiles();
await checkComparison();
checkRefusals();
checkFigures();
