// node optimize_load.mjs --source FOLDER --programs FOLDER --out FOLDER [--limit S] [--check] [--town]
// What `scenegen optimize` makes of a file of 211 000 objects (test set 32; --town: a town of 202 427) in layout nodes with visibility
// scale: size, draws, and how long three.js takes to load both in Chromium, in one run. A file that is not there after
// --limit seconds counts as not loading. CPU seconds are of the page's process, all its threads: what others do beside it counts
// less there. --check: fails unless the file is at most 25 % and loads in 2 s of CPU.
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
const kFrames = 9;
const here = path.dirname(fileURLToPath(import.meta.url));
const { serve } = await import(pathToFileURL(path.join(options.source, 'examples', 'web', 'server.mjs')).href);
const scenegen = (...args) => execFileSync(path.join(options.programs, 'scenegen'), args, { encoding: 'utf8', maxBuffer: 2 ** 26 });

/// A browser of its own, so that no file suffers from what another left behind.
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
    const loading = page.evaluate((url) => window.time_load(url), `/files/${path.basename(file)}`);
    loading.catch(() => {});  // the page is closed under a file that takes too long
    let timer;
    const limit = new Promise((resolve) => { timer = setTimeout(resolve, Number(options.limit) * 1000, null); });
    const load_s = await Promise.race([loading, limit]);
    clearTimeout(timer);
    if (load_s === null) return null;
    const load_cpu_s = await cpu_s() - cpu_before_s;
    return { load_s, load_cpu_s, ...(await page.evaluate((frames) => window.time_frames(frames), kFrames)) };
  } finally {
    await browser.close();
    await server.close();
  }
}

mkdirSync(options.out, { recursive: true });
const nodes = path.join(options.out, 'nodes.glb'), small = path.join(options.out, 'optimized.glb');
const what = options.town ? ['--grid', '9x9'] : ['--test-set', '32'];
scenegen(...what, '--layout', 'nodes', '--visibility', 'scale', '-o', nodes);
const report = JSON.parse(scenegen('optimize', nodes, '-o', small, '--format', 'json'));
console.log(`scenegen diff: ${scenegen('diff', nodes, small).trim()}`);
const loads = { before: await timed(nodes), after: await timed(small) };
for (const when of ['before', 'after']) {
  const load = loads[when];
  const time = load === null ? `not loaded in ${options.limit} s`
    : `three.js: loaded in ${load.load_s.toFixed(2)} s (${load.load_cpu_s.toFixed(2)} s CPU), first frame ${load.first_ms.toFixed(0)} ms, then ${load.frame_ms.toFixed(0)} ms`;
  console.log(`${when.padEnd(6)}  ${(report.bytes[when] / 1e6).toFixed(1)} MB  ${report.draws[when]} draws  ${report.channels[when]} channels  ${time}`);
}
const share = report.bytes.after / report.bytes.before;
console.log(`${(100 * share).toFixed(1)} % of the size (aim: 25 %), optimized in ${report.seconds.toFixed(2)} s`);
if (options.check && (share > 0.25 || loads.after === null || loads.after.load_cpu_s > 2)) process.exit(1);
