// One viewer with one file along one camera path.
import path from 'node:path';
import { cameraAt } from './camera_path.mjs';
import { openBrowser } from './browser.mjs';
import { agreement } from './bench_truth.mjs';
import { frameFigures, spread } from './bench_results.mjs';
import { serve } from './server.mjs';

/// A limit for all of a case: within() fails with what was being waited for when it is over.
class Limit {
  constructor(seconds) {
    this.seconds = seconds;
    this.end = Date.now() + 1000 * seconds;
  }

  async within(what, promise) {
    promise.catch(() => {});  // the browser is closed under what takes too long
    let timer;
    const over = new Promise((_, reject) => {
      timer = setTimeout(() => reject(new Error(`${what} took longer than the ${this.seconds} s that a case may take (--limit)`)), Math.max(this.end - Date.now(), 0));
    });
    return Promise.race([promise, over]).finally(() => clearTimeout(timer));
  }
}

/// As `sceneplay bench`: the path is walked to and fro, so that frames before the first change as much as those that count.
export function momentOfFrame(frame, moments) {
  if (moments <= 1) return 0;
  const last = moments - 1, there = ((frame % (2 * last)) + 2 * last) % (2 * last);
  return Math.min(there, 2 * last - there);
}

async function measure(browser, limit, url, { viewer, size, samples, frames, warmUp, repeat, cameraPath, truth, onFrame }) {
  const { page } = browser;
  const ask = (what, call, ...args) => limit.within(what, page.evaluate(([name, values]) => window[name](...values), [call, args]));
  await limit.within('opening the page', page.goto(`${url.page}/bench_page.html`).then(() => page.waitForFunction(() => window.ready === true)));
  const about = await ask('opening the viewer', 'open_viewer', viewer, { size, samples });
  const { fetch_ms, load_ms, duration_s } = await ask('loading', 'load', url.file);
  const times_s = Array.from({ length: frames }, (_, i) => (frames === 1 ? 0 : duration_s * i / (frames - 1)));
  const moment = (i) => ({ time_s: times_s[i], camera: cameraAt(cameraPath, times_s[i]) });
  let done = 0, started_ms = null;
  const draw = async (i) => {
    const what = started_ms === null ? 'the first frame' : `frame ${done + 1}`;
    const frame_ms = await ask(what, 'frame', moment(momentOfFrame(i, frames)));
    onFrame(done += 1, repeat * (warmUp + frames));
    started_ms ??= frame_ms;
    return frame_ms;
  };
  const runs = [], cpuOfRuns = [];
  for (let run = 0; run < repeat; run += 1) {
    for (let i = -warmUp; i < 0; i += 1) await draw(i);
    const before = browser.use(), times = [];
    for (let i = 0; i < frames; i += 1) times.push(await draw(i));
    runs.push(times);
    const after = browser.use();
    if (before !== null && after !== null) cpuOfRuns.push(1000 * (after.cpu_s - before.cpu_s) / frames);
  }
  const found = {
    version: about.version, device: about.renderer, samples: about.samples, ...frameFigures(runs, times_s), loadMs: fetch_ms + load_ms, startMs: started_ms,
    processCpuMs: cpuOfRuns.length > 0 ? spread(cpuOfRuns) : null, memoryBytes: browser.use()?.bytes ?? null, jsHeapBytes: await ask('the heap', 'heap_bytes'),
  };
  if (truth === null) return found;
  const sums = { pixels: 0, right: 0 }, indices = truth.indicesOf(frames), ours = await truth.coverage(indices.map((i) => times_s[i]));
  for (const [k, i] of indices.entries()) {
    const theirs = Buffer.from(await ask('the comparison', 'coverage', moment(i)), 'base64'), { pixels, right } = agreement(ours[k], theirs, size);
    sums.pixels += pixels;
    sums.right += right;
  }
  return { ...found, correctness: sums.pixels > 0 ? 100 * sums.right / sums.pixels : null };
}

/// Promise<members of a case> ({error} when it failed). request: file, viewer, size, samples, frames, warmUp, repeat, cameraPath (as read),
/// limit_s, modules, truth ({indicesOf(frames), coverage(times_s)} or null), onFrame(done, of).
export async function runCase(request) {
  const limit = new Limit(request.limit_s), here = path.dirname(new URL(import.meta.url).pathname);
  let server = null, browser = null;
  try {
    server = await serve({
      scripts: { '/page.js': path.join(here, 'bench_page.mjs') },
      folders: { '/': here, '/files/': path.dirname(path.resolve(request.file)) }, modules: request.modules,
    });
    browser = await openBrowser(request.modules, request.size);
    const found = await measure(browser, limit, { page: server.url, file: `/files/${encodeURIComponent(path.basename(request.file))}` }, request);
    return { ...found, warnings: [...new Set(browser.faults)] };
  } catch (error) {
    const gone = /Target (page, context or browser has been closed|crashed)|Page crashed/.test(error.message);
    return { error: gone ? 'the browser crashed; out of memory?' : error.message.replace(/^page\.\w+: (Error: )?/, '').split('\n')[0] };
  } finally {
    if (browser !== null) await browser.close();
    if (server !== null) await server.close();
  }
}
