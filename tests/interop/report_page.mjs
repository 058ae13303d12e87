// node report_page.mjs --programs FOLDER --out FOLDER: the page of `sceneplay report` in Chromium, on a phone, on a desk, in the dark and on
// paper, with results of a friend and of somebody who means harm.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import process from 'node:process';
import { pathToFileURL } from 'node:url';
import { parseArgs } from 'node:util';
import { PNG } from 'pngjs';
import { openBrowser } from './browser.mjs';

const { values: options } = parseArgs({ options: { programs: { type: 'string' }, out: { type: 'string' } } });

// ---- Results -------------------------------------------------------------------------------------------------------------------------------

const kHarm = '<script>window.harmed = 1</script>"\'><img src="http://example.org/x.png" onerror="window.harmed = 1">';
const column = (name, title, unit, origin = 'ours', better = 'none', against = undefined) => ({ name, title, unit, origin, better, against, digits: 3 });

function frameTimes() {
  const counts = [1000, 5000, 20000, 80000, 300000];
  const table = {
    kind: 'table', id: 'recording', title: 'Frame time by number of objects', note: 'The paper’s from its table 3.',
    columns: [column('objects', 'objects', ''), column('paperMs', 'every object', 'ms', 'paper', 'lower'),
      column('ms', 'every object', 'ms', 'ours', 'lower', 'paperMs'), column('paperFps', 'rate', '1/s', 'paper', 'higher'),
      column('fps', 'rate', '1/s', 'ours', 'higher', 'paperFps'), column('bytes', 'memory', 'B')],
    // Times: better, better, level, worse, not measured. Rates: better, worse, level, not measured, better.
    rows: [[1000, 2.0, 1.0, 500, 1000, 1.5e6], [5000, 9.5, 4.75, 105, 70, 6.1e6], [20000, 19.6, 19.7, 51, 51, 21e6],
      [80000, 55, 110, 18, null, 83e6], [300000, 160, null, 6, 12.5, 305e6]],
  };
  const chart = {
    kind: 'chart', id: 'recording', title: 'Frame time by number of objects', xTitle: 'objects', yTitle: 'frame time, ms', logX: true, logY: true,
    note: 'Spread: 95 % interval.',
    series: [
      { name: 'inline', origin: 'ours', points: counts.map((x) => ({ x, y: x / 2000, low: x / 2400, high: x / 1800 })) },
      { name: 'octree', origin: 'ours', points: counts.map((x) => ({ x, y: x / 5000 + 1 })) },
      { name: 'inline (paper)', origin: 'paper', points: counts.map((x) => ({ x, y: x / 1500 })) },
      { name: 'none', origin: 'ours', points: [{ x: 1000, y: 0 }] },
    ],
  };
  const verdicts = [
    { source: 'D tables 3-5', what: 'recording and submitting 300 000 objects, every object recorded', paper: '55.6 ms', ours: '9.27 ms', finding: 'better', why: '31 ns an object here, 185 ns on D’s machine: what the driver and the processor make of it' },
    { source: 'D tables 3-5', what: 'the same, kept, 1 a buffer', paper: '48.8 ms', ours: '569 ms', finding: 'worse', why: 'each command buffer takes 23 kB of the host’s memory here, and submitting reads them all' },
    { source: 'D figures 5.16-5.19', what: 'gain over Frustum Culling on sets 1 to 4', paper: '1.3 to 2.5×', ours: '1.4 to 2.1×', finding: 'level', why: 'x'.repeat(120) },
    { source: 'D 5.2, building', what: 'octree against Morton LBVH', paper: 'octree several times faster', ours: 'octree 6.7× slower', finding: 'differs', why: 'an LBVH sorts all codes at once' },
    { source: 'D 5.2, updates', what: 'octree against building a hierarchy anew', paper: 'octree faster', ours: 'octree 11× faster', finding: 'agrees', why: 'a change touches a few nodes' }];
  const failures = [1, 2, 3, 4, 5, 6].map((i) => ({ what: `recording, ${i} objects, kept`, why: 'device \'X\': out of memory' }));
  return { id: 'recording', title: 'Recording of commands', paragraphs: ['Recording is twice as fast as the paper’s.', 'Drivers differ.'], blocks: [table, chart], verdicts, failures };
}

function wideTable() {
  const columns = [column('name', 'scene', '')];
  for (let i = 0; i < 12; ++i) columns.push(column(`c${i}`, `quantity number ${i}`, 'ms'));
  const rows = Array.from({ length: 60 }, (_, row) => [`scene_${row}_${'long'.repeat(8)}`, ...columns.slice(1).map((_c, i) => (row + 1) * (i + 1) / 7)]);
  const line = Array.from({ length: 300 }, (_, i) => ({ x: i, y: 20 + 5 * Math.sin(i / 20), low: 18 + 5 * Math.sin(i / 20), high: 23 + 5 * Math.sin(i / 20) }));
  return { id: 'wide', title: 'A wide table', paragraphs: ['Sixty scenes.'], blocks: [
    { kind: 'table', id: 'wide-table', title: 'All scenes', columns, rows },
    { kind: 'chart', id: 'long-chart', title: 'Frame by frame', xTitle: 'frame', yTitle: 'frame time, ms', series: [{ name: 'adaptive', points: line }] },
    { kind: 'picture', id: 'view', title: 'The scene', file: 'view.png', note: 'At half time.' },
    { kind: 'picture', id: 'gone', title: 'A lost picture', file: 'gone.png' },
  ] };
}

/// Marks far to the right: what they hide from eyes must not widen the page.
function comparedTable() {
  const pairs = Array.from({ length: 9 }, (_, i) => [column(`p${i}`, `quantity number ${i}`, 'ms', 'paper', 'lower'), column(`o${i}`, `quantity number ${i}`, 'ms', 'ours', 'lower', `p${i}`)]);
  return { kind: 'table', id: 'compared', title: 'Many comparisons', columns: [column('name', 'scene', ''), ...pairs.flat()], rows: [['town', ...pairs.flatMap(() => [10, 20])]] };
}

function harmful() {
  return { id: 'harm', title: kHarm, paragraphs: [kHarm, 'x'.repeat(900)], blocks: [
    { kind: 'table', id: 'harm-table', title: kHarm, note: kHarm, columns: [column(kHarm, kHarm, kHarm), column('b', 'figure', kHarm)],
      rows: [[kHarm, 1e300], [kHarm, -1e-300]] },
    comparedTable(),
    { kind: 'chart', id: 'harm-chart', title: kHarm, xTitle: kHarm, yTitle: kHarm, series: [{ name: kHarm, points: [{ x: -1e308, y: 1e308 }, { x: 0, y: 1e-320 }] }] },
  ] };
}

function writeResults(folder, device, sections) {
  mkdirSync(folder, { recursive: true });
  const facts = [['device', device], ['arguments', `sceneplay experiment all ${'--a-long-option value '.repeat(12)}`], ['seed', '1']]
    .map(([name, value]) => ({ name, value }));
  const results = { schema: 'sceneplay/experiment', version: 1, document: { title: `Experiments on ${device}`, facts, sections } };
  writeFileSync(path.join(folder, 'experiment.json'), JSON.stringify(results));
  const image = new PNG({ width: 1920, height: 1080 });
  for (let i = 0; i < image.data.length; ++i) image.data[i] = i % 4 === 3 ? 255 : (i * 2654435761 >>> 20) & 255;  // does not compress
  writeFileSync(path.join(folder, 'view.png'), PNG.sync.write(image, { deflateLevel: 1 }));
}

// ---- The page ------------------------------------------------------------------------------------------------------------------------------

/// In the page: what is wrong with it, at this width.
function faultsOfPage() {
  const out = [];
  const shown = (node) => node.getClientRects().length > 0;
  if (document.documentElement.scrollWidth > window.innerWidth) out.push(`the page is ${document.documentElement.scrollWidth} pixels wide`);
  for (const figure of document.querySelectorAll('figure.chart')) {
    const count = [...figure.querySelectorAll('svg.chart')].filter(shown).length;
    if (count !== 1) out.push(`${figure.id}: ${count} charts are shown`);
  }
  for (const svg of [...document.querySelectorAll('svg.chart, svg.strip')].filter(shown)) {
    const frame = svg.viewBox.baseVal;
    const boxes = [...svg.querySelectorAll('text')].map((text) => ({ text: text.textContent, box: text.getBBox() }));
    for (const { text, box } of boxes) {
      const inside = box.x >= -1 && box.y >= -1 && box.x + box.width <= frame.width + 1 && box.y + box.height <= frame.height + 1;
      if (!inside && text.length < 60) out.push(`'${text}' leaves its drawing`);
      const size = parseFloat(getComputedStyle(svg.querySelector('text')).fontSize) * svg.getBoundingClientRect().width / frame.width;
      if (size < 10.5) out.push(`'${text}' is ${size} pixels high`);
    }
    boxes.forEach((a, i) => boxes.slice(i + 1).forEach((b) => {
      const apart = a.box.x + a.box.width <= b.box.x || b.box.x + b.box.width <= a.box.x || a.box.y + a.box.height <= b.box.y + 2 || b.box.y + b.box.height <= a.box.y + 2;
      if (!apart && a.text.length + b.text.length < 60) out.push(`'${a.text}' and '${b.text}' overlap`);
    }));
  }
  for (const head of document.querySelectorAll('th')) if (!head.hasAttribute('scope')) out.push('a heading without scope');
  for (const image of document.querySelectorAll('img')) {
    if (!image.alt || !image.complete || image.naturalWidth === 0) out.push('an image without words or without picture');
  }
  for (const svg of document.querySelectorAll('svg[role=img]')) if (!svg.querySelector('title')?.textContent) out.push('a drawing without title');
  const ids = [...document.querySelectorAll('[id]')].map((node) => node.id);
  if (new Set(ids).size !== ids.length) out.push('an id is there twice');
  for (const link of document.querySelectorAll('a')) if (!document.getElementById(link.getAttribute('href').slice(1))) out.push(`${link.href} leads nowhere`);
  return out.slice(0, 20);
}

/// In the page: texts whose contrast to what is behind them is below 4.5 (WCAG AA).
function faintTexts() {
  const channels = (color) => color.match(/[\d.]+/g).map(Number);
  const luminance = (color) => {
    const [r, g, b] = channels(color).map((c) => (c / 255 <= 0.03928 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const behind = (node) => {
    for (let n = node; n; n = n.parentElement) {
      const color = getComputedStyle(n).backgroundColor;
      if ((channels(color)[3] ?? 1) > 0) return color;
    }
    return 'rgb(255, 255, 255)';
  };
  const out = new Map();
  for (const node of document.querySelectorAll('p, th, td, dt, dd, li, a, h1, h2, h3, figcaption, summary, .mark, .tag, .unit, .better, .worse, .level, svg text, .typical')) {
    if (node.closest('.bar') || !node.textContent.trim()) continue;
    const style = getComputedStyle(node);
    const [a, b] = [luminance(node.closest('svg') ? style.fill : style.color), luminance(behind(node))].sort((x, y) => y - x);
    const ratio = (a + 0.05) / (b + 0.05);
    if (ratio < 4.5) out.set(`${node.tagName}.${node.getAttribute('class')}`, ratio.toFixed(2));
  }
  return [...out].map(([what, ratio]) => `${what}: ${ratio}`);
}

async function open(browser, file, width, height, more = {}) {
  const page = await browser.page(width, height, more);
  page.on('console', (message) => browser.faults.push(`console: ${message.text()}`));
  page.on('request', (request) => {
    if (request.url() !== pathToFileURL(file).href && !request.url().startsWith('data:')) browser.faults.push(`asked for ${request.url()}`);
  });
  await page.goto(pathToFileURL(file).href);
  return page;
}

async function checkWords(page) {
  assert.equal(await page.title(), 'Both');
  assert.deepEqual(await page.locator('h2').allTextContents(), ['At a glance', 'llvmpipe', 'GPU & Co. <4>']);
  const headlines = await page.locator('.headline').allTextContents();
  assert.equal(headlines[0], 'llvmpipe: better than the paper in 4 of 8 figures, level in 2, worse in 2.');
  const counts = await page.locator('.glance').first().locator('.counts').innerText();
  assert.match(counts.replaceAll(/\s+/g, ' '), /✓ 4 better ≈ 2 level ✗ 2 worse typically 1\.5× better/);
  const verdict = (n) => page.locator('.verdicts').first().locator('tbody tr').nth(n).locator('th, td').allInnerTexts();
  assert.deepEqual((await verdict(1)).slice(2, 5).map((cell) => cell.replaceAll(/\s+/g, ' ').trim()), ['48.8 ms', '569 ms', '✗ worse']);
  assert.match(await page.locator('.failures').first().innerText(), /6 cases failed\s+recording, 1 objects, kept; .*; recording, 3 objects, kept and 3 more: device 'X': out of memory/);
  const row = (n) => page.locator('#run1-table-recording tbody tr').nth(n).locator('th, td').allInnerTexts().then((cells) => cells.map((c) => c.replaceAll(/\s+/g, ' ').trim()));
  assert.deepEqual((await row(0)).slice(0, 5), ['1000', '2.0', '1.0✓ 2.0× better', '500.0', '1000.0✓ 2.0× better']);
  assert.deepEqual((await row(3)).slice(2, 5), ['110.0✗ 2.0× worse', '18.0', '–']);
  assert.deepEqual(await page.locator('#run1-table-recording thead th').last().innerText(), 'memory MB', 'bytes are scaled');
  assert.match(await page.locator('#run1-picture-gone').innerText(), /gone\.png cannot be shown/);
  assert.match(await page.locator('#run1-chart-recording .note').innerText(), /1 point is not drawn/);
  assert.equal(await page.locator('#run1-chart-recording svg.broad path.line.paper').count(), 1);
  assert.notEqual(await page.locator('#run1-chart-recording svg.broad path.line.paper').evaluate((n) => getComputedStyle(n).strokeDasharray), 'none');
  const color = (selector) => page.locator(`#run1-chart-recording svg.broad ${selector}`).first().evaluate((n) => getComputedStyle(n).stroke);
  assert.equal(await color('path.line.paper'), await color('path.line:not(.paper).s0'), 'the paper’s curve has the color of ours');
  assert.equal(await page.locator('#run1-chart-recording svg.broad path.band').count(), 1);
  assert.equal(await page.locator('#run1-chart-recording svg.broad path.whisker').count(), 1);
  assert.equal(await page.evaluate(() => window.harmed ?? document.querySelectorAll('script').length), 0);
}

async function checkPaper(page) {
  await page.emulateMedia({ media: 'print', colorScheme: 'light' });
  for (const chart of await page.locator('figure.chart').all())
    assert.equal(await chart.evaluate((n) => getComputedStyle(n).breakInside), 'avoid', 'charts are not cut');
  assert.equal(await page.locator('.scroll').first().evaluate((n) => getComputedStyle(n).overflowX), 'visible', 'tables are whole');
  const pdf = await page.pdf({ format: 'A4', path: path.join(options.out, 'report.pdf') });
  assert.equal(pdf.subarray(0, 5).toString(), '%PDF-');
  const pages = pdf.toString('latin1').match(/\/Type\s*\/Page\b(?!s)/g)?.length ?? 0;
  assert.ok(pages >= 4 && pages <= 30, `${pages} pages`);
}

const file = (name) => path.join(options.out, name);
rmSync(options.out, { recursive: true, force: true });
writeResults(file('results/a'), 'llvmpipe', [frameTimes(), wideTable()]);
writeResults(file('results/b'), 'GPU & Co. <4>', [frameTimes(), harmful()]);
const report = (name) => {
  execFileSync(path.join(options.programs, 'sceneplay'), ['report', file('results'), '-o', file(name), '--title', 'Both', '--quiet'], { stdio: ['ignore', 'ignore', 'pipe'] });
  return readFileSync(file(name));
};
const bytes = report('report.html');
assert.ok(bytes.equals(report('again.html')), 'the same results give the same bytes');
assert.ok(bytes.length < 4_000_000, `${bytes.length} bytes: the picture is made smaller`);

const browser = await openBrowser();
const desk = await open(browser, file('report.html'), 1280, 900);
assert.deepEqual(await desk.evaluate(faultsOfPage), []);
assert.deepEqual(await desk.evaluate(faintTexts), []);
await checkWords(desk);
await desk.screenshot({ path: file('desk.png'), fullPage: true });
const phone = await open(browser, file('report.html'), 360, 740, { isMobile: true, hasTouch: true, deviceScaleFactor: 2, colorScheme: 'dark' });
assert.deepEqual(await phone.evaluate(faultsOfPage), []);
assert.deepEqual(await phone.evaluate(faintTexts), []);
const dark = await phone.evaluate(() => getComputedStyle(document.body).backgroundColor.match(/\d+/g).map(Number));
assert.ok(Math.max(...dark) < 60, `the dark page is ${dark}`);
await phone.screenshot({ path: file('phone.png'), fullPage: true });
await checkPaper(desk);
assert.deepEqual(browser.faults, []);
await browser.close();
console.log('the report reads well on phone, desk and paper');
process.exit(0);
