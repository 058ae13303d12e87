// node optimize_load.mjs --source FOLDER --programs FOLDER --out FOLDER [--limit S] [--check] [--town]
// What `scenegen optimize` makes of a file of 211 000 objects (test set 32; --town: a town of 202 427) in layout nodes with visibility
// scale: size, draws, and how long three.js takes in Chromium to load and to show it, beside the file that it was made from, in one
// run. The small file is loaded three times, each in a browser of its own, and the quickest counts, as the machine may be busy with
// something else; the large one once, and it may take --limit seconds to load and to show. CPU seconds are of the page's process, all
// its threads. --check: fails unless the small file has at most 25 % of the bytes and loads in 2 s, by the wall clock or, where the
// machine is too busy for that to mean anything, in CPU seconds.
import { execFileSync } from 'node:child_process';
import { mkdirSync } from 'node:fs';
import path from 'node:path';
import process from 'node:process';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { parseArgs } from 'node:util';
import { openBrowser } from './browser.mjs';

const { values: options } = parseArgs({ options: {
  source: { type: 'string' }, programs: { type: 'string' }, out: { type: 'string' }, limit: { type: 'string', default: '200' },
  check: { type: 'boolean', default: false }, town: { type: 'boolean', default: false },
} });
if (options.source === undefined || options.programs === undefined || options.out === undefined) {
  console.error('usage: node optimize_load.mjs --source FOLDER --programs FOLDER --out FOLDER [--limit S] [--check] [--town]');
  process.exit(2);
}
const kFrames = 9, kLoads = 3, kLongest_s = 2, kLargestShare = 0.25;
const here = path.dirname(fileURLToPath(import.meta.url));
const { serve } = await import(pathToFileURL(path.join(options.source, 'examples', 'web', 'server.mjs')).href);
const scenegen = (...args) => execFileSync(path.join(options.programs, 'scenegen'), args, { encoding: 'utf8', maxBuffer: 2 ** 26 });

/// Promise<value>, or null after so many seconds.
function within(seconds, promise) {
  promise.catch(() => {});  // the browser is closed under what takes too long
  let timer;
  const limit = new Promise((resolve) => { timer = setTimeout(resolve, seconds * 1000, null); });
  return Promise.race([promise, limit]).finally(() => clearTimeout(timer));
}

/// Times in a browser of its own, so that no file suffers from what another left behind; null for what was not reached in time.
async function timed(file) {
  const server = await serve({
    scripts: { '/page.js': path.join(options.source, 'tests', 'interop', 'load_page.mjs') },
    folders: { '/': path.join(options.source, 'tests', 'interop'), '/files/': options.out }, modules: path.join(here, 'node_modules'),
  });
  const browser = await openBrowser();
  try {
    const page = await browser.page(320, 240);
    await page.goto(`${server.url}/viewer_page.html`);
    await page.waitForFunction(() => window.ready === true);
    const session = await page.context().newCDPSession(page);
    await session.send('Performance.enable');
    const cpu_s = async () => (await session.send('Performance.getMetrics')).metrics.find((metric) => metric.name === 'ProcessTime').value;
    const cpu_before_s = await cpu_s();
    const limit_s = Number(options.limit);
    const load_s = await within(limit_s, page.evaluate((url) => window.time_load(url), `/files/${path.basename(file)}`));
    if (load_s === null) return null;
    const cpu_load_s = await cpu_s() - cpu_before_s;
    const frames = await within(limit_s - load_s, page.evaluate((count) => window.time_frames(count), kFrames));
    return { load_s, cpu_load_s, frames };
  } finally {
    await browser.close();
    await server.close();
  }
}

function told(load) {
  if (load === null) return `not loaded in ${options.limit} s`;
  const shown = load.frames === null ? `no frame in ${options.limit} s`
    : `first frame ${load.frames.first_ms.toFixed(0)} ms, then ${load.frames.frame_ms.toFixed(0)} ms`;
  return `three.js: loaded in ${load.load_s.toFixed(2)} s (${load.cpu_load_s.toFixed(2)} s CPU), ${shown}`;
}

mkdirSync(options.out, { recursive: true });
const nodes = path.join(options.out, 'nodes.glb'), small = path.join(options.out, 'optimized.glb');
const what = options.town ? ['--grid', '9x9'] : ['--test-set', '32'];
scenegen(...what, '--layout', 'nodes', '--visibility', 'scale', '-o', nodes);
const report = JSON.parse(scenegen('optimize', nodes, '-o', small, '--format', 'json'));
console.log(`scenegen diff: ${scenegen('diff', nodes, small).trim()}`);
const tell = (when, load) => console.log(
  `${when.padEnd(6)}  ${(report.bytes[when] / 1e6).toFixed(1)} MB  ${report.draws[when]} draws  ${report.channels[when]} channels  ${told(load)}`);
const loads = [];
for (let i = 0; i < kLoads; ++i) loads.push(await timed(small));
loads.forEach((load) => tell('after', load));
tell('before', await timed(nodes));
const least = (what) => Math.min(...loads.map((load) => load?.[what] ?? Infinity));
const best_s = least('load_s'), best_cpu_s = least('cpu_load_s');
const share = report.bytes.after / report.bytes.before;
console.log(`${(100 * share).toFixed(1)} % of the size (aim: ${100 * kLargestShare} %), optimized in ${report.seconds.toFixed(2)} s; `
  + `loaded in ${best_s.toFixed(2)} s (${best_cpu_s.toFixed(2)} s CPU), the best of ${kLoads} (aim: ${kLongest_s} s)`);
if (options.check && (share > kLargestShare || Math.min(best_s, best_cpu_s) > kLongest_s)) process.exit(1);
