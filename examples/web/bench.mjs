// node bench.mjs FILE... --camera-path PATH.json -o DIR: how long three.js and Babylon.js take for frames, as `sceneplay bench --readback`
// does for our own; results in the same form (docs/BENCH_FORMAT.md). Node 18 or later.
import { spawn, spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, readFileSync, renameSync, statSync, writeFileSync } from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import process from 'node:process';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { runCase } from './bench_case.mjs';
import { addVsBest, csv } from './bench_results.mjs';
import { coverageOf } from './bench_truth.mjs';
import { readCameraPath } from './camera_path.mjs';

const kHere = path.dirname(fileURLToPath(import.meta.url));
const kViewers = { three: 'three.js', babylon: 'Babylon.js' };
const kComparedMoments = 5;
const kHelp = `Usage: node bench.mjs FILE... --camera-path PATH.json -o DIR [options]

Measures how long three.js and Babylon.js take for a frame, until its pixels are in memory, in headless Chromium
that draws on the processor. Writes DIR/bench.json and DIR/bench.csv as sceneplay bench does.

  --camera-path FILE   as sceneplay camera-path writes it (docs/CAMERA_PATH.md)
  -o, --output DIR     folder for the results; made when missing
  --viewer LIST        three, babylon; separated by commas (default: both)
  --frames N           frames of a run, evenly over the timeline (default: 20)
  --warm-up N          frames before each run that do not count (default: 3)
  --repeat N           runs of each case (default: 3)
  --size WxH           size of the pictures in pixels (default: 1280x720)
  --samples 1|4        4: antialiased (default: 4)
  --limit S            seconds that a case may take, loading included (default: 300)
  --sceneplay PROGRAM  compare what is visible with what it draws, and measure it too
  --strategy LIST      ways in which sceneplay draws (default: instanced,queries)
  --modules DIR        node_modules with the packages (default: beside bench.mjs, installed when missing)
  --quiet              no progress`;

class Refusal extends Error {
  constructor(code, message) {
    super(message);
    this.code = code;
  }
}

function whole(name, text, low, high) {
  const value = Number(text);
  if (!/^\d+$/.test(text) || value < low || value > high) throw new Refusal(2, `--${name}: '${text}' is not a whole number from ${low} to ${high}`);
  return value;
}

function readArguments() {
  const text = (value) => ({ type: 'string', ...(value === undefined ? {} : { default: value }) });
  let values, positionals;
  try {
    ({ values, positionals } = parseArgs({ allowPositionals: true, options: {
      'camera-path': text(), output: { type: 'string', short: 'o' }, viewer: text('three,babylon'), frames: text('20'), 'warm-up': text('3'), repeat: text('3'),
      size: text('1280x720'), samples: text('4'), limit: text('300'), sceneplay: text(), strategy: text('instanced,queries'),
      modules: text(path.join(kHere, 'node_modules')), quiet: { type: 'boolean', default: false }, help: { type: 'boolean', short: 'h', default: false },
    } }));
  } catch (error) {
    throw new Refusal(2, error.message.split('\n')[0]);
  }
  if (values.help) return null;
  if (positionals.length === 0) throw new Refusal(2, 'no FILE (usage: node bench.mjs FILE... --camera-path PATH.json -o DIR)');
  for (const name of ['camera-path', 'output']) if (values[name] === undefined) throw new Refusal(2, `--${name}: missing`);
  const viewers = values.viewer.split(',');
  for (const viewer of viewers) if (!(viewer in kViewers)) throw new Refusal(2, `--viewer: unknown viewer '${viewer}'; one of three, babylon`);
  const size = /^(\d{1,5})x(\d{1,5})$/.exec(values.size)?.slice(1).map(Number);
  if (size === undefined || size.some((side) => side < 1 || side > 8192)) throw new Refusal(2, `--size: '${values.size}' is not WxH, each 1 to 8192`);
  if (!['1', '4'].includes(values.samples)) throw new Refusal(2, `--samples: '${values.samples}'; 1 or 4`);
  if (values.sceneplay !== undefined && !existsSync(values.sceneplay)) throw new Refusal(3, `--sceneplay: ${values.sceneplay}: there is no such file`);
  return {
    files: positionals, camera: values['camera-path'], folder: values.output, viewers: [...new Set(viewers)], size, samples: Number(values.samples),
    frames: whole('frames', values.frames, 1, 100000), warmUp: whole('warm-up', values['warm-up'], 1, 1000), repeat: whole('repeat', values.repeat, 1, 1000),
    limit_s: whole('limit', values.limit, 1, 86400), sceneplay: values.sceneplay, strategy: values.strategy, modules: values.modules, quiet: values.quiet,
  };
}

function install(modules) {
  if (existsSync(path.join(modules, 'playwright-core'))) return;
  console.error('Installing three.js, Babylon.js and what drives the browser (npm ci) …');
  const npm = spawnSync('npm', ['ci', '--ignore-scripts', '--no-audit', '--no-fund'], { cwd: kHere, stdio: ['ignore', 'ignore', 'inherit'] });
  if (npm.status !== 0) throw new Refusal(3, 'npm ci failed; is npm installed, and the registry in reach?');
}

function systemName() {
  try {
    return /^PRETTY_NAME="?([^"\n]*)/m.exec(readFileSync('/etc/os-release', 'utf8'))[1];
  } catch {
    return os.version();
  }
}

const machine = () => ({
  processor: os.cpus()[0]?.model ?? '', cores: os.cpus().length, memoryBytes: os.totalmem(), system: systemName(), kernel: `${os.type()} ${os.release()}`, load: os.loadavg()[0],
});

/// What `sceneplay bench` finds with the same file, path and moments; {cases, devices, scenes}, or a case with an error.
async function runSceneplay(request, file) {
  const folder = path.join(request.folder, 'sceneplay');
  const args = ['bench', file, '-o', folder, '--camera-path', request.camera, '--frames', request.frames, '--warm-up', request.warmUp, '--repeat', request.repeat,
    '--size', request.size.join('x'), '--samples', request.samples, '--shadows', 'off', '--readback', '--frames-in-flight', '1', '--strategy', request.strategy, '--quiet'].map(String);
  const child = spawn(request.sceneplay, args, { stdio: ['ignore', 'ignore', 'pipe'] });
  let words = '';
  child.stderr.on('data', (chunk) => { words += chunk; });
  const code = await new Promise((resolve) => { child.on('error', () => resolve(-1)); child.on('close', resolve); });
  if (code !== 0) return { cases: [{ file, device: '', camera: request.camera, framesInFlight: 1, strategy: 'sceneplay', error: words.trim().split('\n')[0].replace(/^error: /, '') || `ended with ${code}` }] };
  return JSON.parse(readFileSync(path.join(folder, 'bench.json'), 'utf8'));
}

class Bench {
  constructor(request) {
    this.request = request;
    this.cameraPath = readCameraPath(request.camera);
    this.cases = [];
    this.scenes = new Map();
    this.devices = new Map();
  }

  say(text) {
    if (!this.request.quiet && process.stderr.isTTY) process.stderr.write(`\r\x1b[K${text}`);
  }

  truthOf(file) {
    const { sceneplay, size, camera, folder, modules } = this.request;
    if (sceneplay === undefined) return null;
    return {
      indicesOf: (frames) => [...new Set(Array.from({ length: kComparedMoments }, (_, i) => Math.round(i * (frames - 1) / (kComparedMoments - 1))))],
      coverage: (times_s) => coverageOf(file, { sceneplay, times_s, size, cameraPath: camera, folder: path.join(folder, 'ids'), modules }),
    };
  }

  async runFile(file) {
    const { request } = this;
    this.scenes.set(file, { file, bytes: existsSync(file) ? statSync(file).size : 0 });
    for (const viewer of request.viewers) {
      const name = kViewers[viewer], onFrame = (done, of) => this.say(`${path.basename(file)}  ${name}  frame ${done} of ${of} `);
      onFrame(0, request.repeat * (request.warmUp + request.frames));
      const found = existsSync(file) ? await runCase({ ...request, file, viewer, cameraPath: this.cameraPath, truth: this.truthOf(file), onFrame })
        : { error: `${file}: there is no such file` };
      const { device = 'Chromium', ...rest } = found;
      this.devices.set(device, { name: device, type: /swiftshader|llvmpipe/i.test(device) ? 'CPU' : '', driver: 'WebGL' });
      this.cases.push({ file, device, camera: request.camera, framesInFlight: 1, strategy: name, ...rest });
      this.write();
    }
    if (request.sceneplay === undefined) return;
    this.say(`${path.basename(file)}  sceneplay`);
    const { cases, devices = [], scenes = [] } = await runSceneplay(request, file);
    for (const device of devices) this.devices.set(device.name, device);
    for (const scene of scenes) this.scenes.set(scene.file, { ...this.scenes.get(scene.file), ...scene });
    this.cases.push(...cases);
    this.write();
  }

  /// After every case: a run that is killed leaves what it has measured.
  write() {
    const { request } = this, { files, frames, warmUp, repeat, size, samples, limit_s } = request;
    addVsBest(this.cases);
    const json = {
      schema: 'sceneplay/bench', version: 2, program: { name: 'examples/web', version: JSON.parse(readFileSync(path.join(kHere, 'package.json'), 'utf8')).version ?? '', compiler: `node ${process.versions.node}` },
      arguments: process.argv.slice(2), machine: machine(), devices: [...this.devices.values()],
      settings: { size, samples, shadows: false, frames, warmUp, repeat, readback: true, limitS: limit_s },
      scenes: files.filter((file) => this.scenes.has(file)).map((file) => this.scenes.get(file)), cases: this.cases,
    };
    for (const [name, text] of [['bench.json', `${JSON.stringify(json, null, 2)}\n`], ['bench.csv', csv(this.cases)]]) {
      const file = path.join(request.folder, name);
      writeFileSync(`${file}.part`, text);
      renameSync(`${file}.part`, file);
    }
  }

  table() {
    const lines = this.cases.map((c) => [path.basename(c.file), c.strategy, ...(c.error !== undefined ? [`failed: ${c.error}`] : [
      `${c.frameMs.median.toFixed(1)} ms a frame`, `${(1000 / c.frameMs.median).toFixed(2)} fps`, c.loadMs === undefined ? '' : `loaded in ${(c.loadMs / 1000).toFixed(2)} s`,
      c.memoryBytes == null ? '' : `${Math.round(c.memoryBytes / 1e6)} MB`, c.correctness == null ? '' : `${c.correctness.toFixed(2)} % as ours`])]);
    const widths = lines.reduce((most, line) => line.map((cell, i) => Math.max(cell.length, most[i] ?? 0)), []);
    return lines.map((line) => line.map((cell, i) => (i + 1 < line.length ? cell.padEnd(widths[i]) : cell)).join('  ').trimEnd()).join('\n');
  }
}

async function main() {
  const request = readArguments();
  if (request === null) return console.log(kHelp);
  let bench;
  try {
    bench = new Bench(request);
  } catch (error) {
    throw new Refusal(3, `${request.camera}: ${error.code === 'ENOENT' ? 'there is no such file' : error.message}`);
  }
  try {
    mkdirSync(request.folder, { recursive: true });
    writeFileSync(path.join(request.folder, 'bench.json.part'), '');
  } catch (error) {
    throw new Refusal(3, `${request.folder}: cannot be written (${error.code})`);
  }
  install(request.modules);
  for (const file of request.files) await bench.runFile(file);
  bench.say('');
  console.log(bench.table());
  const failed = bench.cases.filter((c) => c.error !== undefined);
  for (const { file, strategy, error } of failed) console.error(`error: ${path.basename(file)}, ${strategy}: ${error}`);
  process.exitCode = failed.length > 0 ? 3 : 0;
}

for (const signal of ['SIGINT', 'SIGTERM', 'SIGHUP']) process.once(signal, () => process.exit(130));  // what was measured is written
try {
  await main();
} catch (error) {
  if (!(error instanceof Refusal)) throw error;
  console.error(`error: ${error.message}`);
  process.exitCode = error.code;
}
