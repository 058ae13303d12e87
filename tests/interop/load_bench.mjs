// node load_bench.mjs --source FOLDER [--limit S] FILE.glb …: how long three.js takes to load each file in Chromium, in one run,
// with the validator's package folder beside this script. A file that is not there after --limit seconds counts as not loading.
import { statSync } from 'node:fs';
import path from 'node:path';
import process from 'node:process';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { parseArgs } from 'node:util';
import { openBrowser } from './browser.mjs';

const { values: options, positionals: files } = parseArgs({ allowPositionals: true, options: {
  source: { type: 'string' }, limit: { type: 'string', default: '200' }, frames: { type: 'string', default: '9' }, json: { type: 'boolean', default: false },
} });
if (options.source === undefined || files.length === 0) {
  console.error('usage: node load_bench.mjs --source FOLDER [--limit S] [--frames N] [--json] FILE.glb …');
  process.exit(2);
}

const here = path.dirname(fileURLToPath(import.meta.url));
const { serve } = await import(pathToFileURL(path.join(options.source, 'examples', 'web', 'server.mjs')).href);

/// One file in a browser of its own, so that none suffers from what another left behind.
async function timed(file) {
  const server = await serve({
    scripts: { '/page.js': path.join(options.source, 'tests', 'interop', 'load_page.mjs') },
    folders: { '/': path.join(options.source, 'tests', 'interop'), '/files/': path.dirname(path.resolve(file)) },
    modules: path.join(here, 'node_modules'),
  });
  const browser = await openBrowser();
  try {
    const page = await browser.page(320, 240);
    await page.goto(`${server.url}/viewer_page.html`);
    await page.waitForFunction(() => window.ready === true);
    const measured = page.evaluate(([url, frames]) => window.time_load(url, frames),
      [`/files/${encodeURIComponent(path.basename(file))}`, Number(options.frames)]);
    measured.catch(() => {});  // the page may be closed under it
    const limit = new Promise((resolve) => setTimeout(resolve, Number(options.limit) * 1000, null).unref());
    return (await Promise.race([measured, limit])) ?? { load_s: null };
  } finally {
    await browser.close();
    await server.close();
  }
}

const rows = [];
for (const file of files) {
  const row = { file: path.basename(file), bytes: statSync(file).size, ...(await timed(file)) };
  rows.push(row);
  if (options.json) continue;
  const frame = row.load_s === null ? '' : `  first frame ${row.first_ms.toFixed(0)} ms  then ${row.frame_ms.toFixed(0)} ms  ${row.draws} draws`;
  console.log(`${row.file}  ${(row.bytes / 1e6).toFixed(1)} MB  ${row.load_s === null ? `not loaded in ${options.limit} s` : `loaded in ${row.load_s.toFixed(2)} s`}${frame}`);
}
if (options.json) console.log(JSON.stringify(rows, null, 1));
