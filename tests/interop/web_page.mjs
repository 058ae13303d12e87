// node web_page.mjs --source FOLDER --programs FOLDER --out FOLDER: examples/web in Chromium, used as a person would: served
// by its documented command, played, sought, switched to the other viewer, given files by drag and drop.
import assert from 'node:assert/strict';
import { execFileSync, spawn, spawnSync } from 'node:child_process';
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import process from 'node:process';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { openBrowser } from './browser.mjs';

const { values: options } = parseArgs({ options: { source: { type: 'string' }, programs: { type: 'string' }, out: { type: 'string' } } });
const kModules = path.join(path.dirname(fileURLToPath(import.meta.url)), 'node_modules');
const kServe = path.join(options.source, 'examples', 'web', 'serve.mjs');

function makeFiles() {
  mkdirSync(options.out, { recursive: true });
  const file = (name) => path.join(options.out, name);
  const house = ['--building-size', '4x4', '--floor-courses', '8', '--floors', '1', '--ground', 'off'];
  const run = (...args) => execFileSync(path.join(options.programs, 'scenegen'), [...args, '--quiet'], { stdio: ['ignore', 'ignore', 'pipe'] });
  const scenegen = (...args) => run(...house, '--cells', '4x4x4', '--interval', '0.1', ...args);
  scenegen('-o', file('house.glb'));
  scenegen('--draco', '--layout', 'groups', '-o', file('draco.glb'));
  scenegen('--visibility', 'pointer', '-o', file('pointer.glb'));
  run(...house, '--curve', 'none', '-o', file('static.glb'));
  writeFileSync(file('plan.csv'), `id,name,start,finish,type,objects
1,Walls,2024-03-01,2024-03-21,construct,name=*/floor_0/*
2,Scaffold <b>,2024-03-11,2024-04-10,temporary,name=*/roof/*
3,Nothing,2024-03-13,2024-03-13,neutral,
`);
  run('schedule', file('static.glb'), file('plan.csv'), '-o', file('planned.glb'));
  writeFileSync(file('broken.glb'), readFileSync(file('house.glb')).subarray(0, 3000));
  return file;
}

/// The address that serve.mjs prints; the process ends with us.
async function startServer(file) {
  const server = spawn(process.execPath, [kServe, file, '--port', '0', '--modules', kModules], { stdio: ['ignore', 'pipe', 'inherit'] });
  process.on('exit', () => server.kill());
  let text = '';
  for await (const chunk of server.stdout) {
    text += chunk;
    if (text.includes('\n')) break;
  }
  return text.trim();
}

function checkCommand() {
  const run = (...args) => spawnSync(process.execPath, [kServe, '--modules', kModules, ...args], { encoding: 'utf8' });
  const refused = (code, pattern, ...args) => {
    const { status, stderr } = run(...args);
    assert.equal(status, code, `serve.mjs ${args.join(' ')}`);
    assert.match(stderr, pattern);
    assert.equal(stderr.trim().split('\n').length, 1, stderr);
  };
  refused(3, /nothere\.glb: there is no such file/, 'nothere.glb');
  refused(2, /a \.glb or \.gltf file is expected/, kServe);
  refused(2, /--port: 'x' is not a number/, '--port', 'x');
  refused(2, /Unknown option '--prot'/, '--prot', '1');
  assert.match(run('--help').stdout, /^Usage: node serve\.mjs/);
}

const ready = (page) => page.waitForFunction(() => document.body.dataset.state === 'ready');
const seek = (page, time_s) => page.locator('#slider').fill(String(Number(time_s.toFixed(3))));

/// Share of the pixels of the canvas that show anything. The canvas is seen through where nothing is.
const covered = (page) => page.evaluate(async () => {
  const { data } = await window.scenegenPlayer.state.viewer.pixels();
  let count = 0;
  for (let i = 3; i < data.length; i += 4) count += data[i] > 0 ? 1 : 0;
  return 4 * count / data.length;
});
async function coverage(page, times) {
  const shares = [];
  for (const time_s of times) {
    await seek(page, time_s);
    shares.push(await covered(page));
  }
  return shares;
}

async function drop(page, file, name) {
  await page.evaluate(async ([base64, label]) => {
    const bytes = Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
    const transfer = new DataTransfer();
    transfer.items.add(new File([bytes], label));
    for (const kind of ['dragenter', 'dragover', 'drop']) {
      document.querySelector('#stage').dispatchEvent(new DragEvent(kind, { dataTransfer: transfer, bubbles: true, cancelable: true }));
    }
  }, [readFileSync(file).toString('base64'), name]);
  await ready(page);
}

async function checkSeeking(page, viewer) {
  const [empty, half, whole, back] = await coverage(page, [0, 3, 7, 3]);
  assert.equal(empty, 0, `${viewer}: nothing is there in the beginning`);
  assert.ok(half > empty + 0.005 && whole > half + 0.005, `${viewer}: the house goes up: ${empty}, ${half}, ${whole}`);
  assert.equal(back, half, `${viewer}: going back shows the same`);
  return [empty, half, whole];
}

async function checkPlaying(page) {
  await seek(page, 0);
  await page.locator('#speed').selectOption('1');
  await page.keyboard.press('Escape');
  await page.locator('#play').click();
  await page.waitForFunction(() => window.scenegenPlayer.state.time_s > 0.3);
  await page.locator('#play').click();
  const at = Number(await page.locator('#slider').inputValue());
  assert.ok(at > 0.3 && at < 6.5, `paused at ${at}`);
  await page.waitForTimeout(150);
  assert.equal(Number(await page.locator('#slider').inputValue()), at, 'paused is still');
  await page.locator('#speed').selectOption('50');
  await page.locator('#play').click();
  await page.waitForFunction(() => !window.scenegenPlayer.state.playing);
  assert.equal(await page.evaluate(() => window.scenegenPlayer.state.time_s - window.scenegenPlayer.state.duration_s), 0, 'it stops at the end');
  await page.locator('#play').click();
  assert.ok(await page.evaluate(() => window.scenegenPlayer.state.time_s < window.scenegenPlayer.state.duration_s), 'and begins again');
  await page.waitForFunction(() => !window.scenegenPlayer.state.playing);
}

async function checkCalendar(page, file) {
  assert.equal(await page.locator('#date').textContent(), '', 'no date without a schedule');
  assert.ok(await page.locator('#tasks').isHidden());
  await drop(page, file('planned.glb'), 'planned.glb');
  assert.equal(await page.locator('#name').textContent(), 'planned.glb');
  const at = async (days) => {  // a second is a day
    await seek(page, days);
    return { date: await page.locator('#date').textContent(), tasks: await page.locator('#tasks b').allTextContents() };
  };
  assert.deepEqual(await at(4.5), { date: 'Tue, Mar 5, 2024', tasks: ['Walls'] });
  assert.deepEqual(await at(12.5), { date: 'Wed, Mar 13, 2024', tasks: ['Walls', 'Scaffold <b>', 'Nothing'] });
  assert.deepEqual(await at(20.5), { date: 'Thu, Mar 21, 2024', tasks: ['Walls', 'Scaffold <b>'] }, 'the last day of the walls');
  assert.deepEqual(await at(21.5), { date: 'Fri, Mar 22, 2024', tasks: ['Scaffold <b>'] });
  assert.deepEqual(await at(41.5), { date: 'Thu, Apr 11, 2024', tasks: [] });
  assert.doesNotMatch(await page.locator('#facts').textContent(), /patched/);
  const [before, walls, scaffold, after] = await coverage(page, [0, 9.5, 25, 41.5]);
  assert.ok(before < walls && walls < scaffold && after < scaffold, `it is built by the plan: ${before}, ${walls}, ${scaffold}, ${after}`);
  await seek(page, 15);
}

async function checkOtherFiles(page, file, plain) {
  for (const name of ['draco.glb', 'pointer.glb']) {
    await drop(page, file(name), name);
    assert.equal(await page.locator('#name').textContent(), name);
    const shares = await coverage(page, [0, 3, 7]);
    shares.forEach((share, i) => assert.ok(Math.abs(share - plain[i]) < 0.002, `${name} covers ${shares}, the plain file ${plain}`));
  }
  await drop(page, file('broken.glb'), 'broken.glb');
  assert.match(await page.locator('#fault').innerText(), /the file is cut off/);
  assert.equal(await page.locator('#name').textContent(), 'pointer.glb', 'what was there stays');
  await page.locator('#fault button').click();
  assert.ok(await page.locator('#fault').isHidden());
}

async function checkPhone(browser, url) {
  const page = await browser.page(390, 760, { isMobile: true, hasTouch: true, locale: 'en-US' });
  await page.goto(`${url.replace('house', 'planned')}&viewer=babylon`);
  await ready(page);
  await seek(page, 2);
  for (const selector of ['#play', '#slider', '#speed', '[data-viewer=three]', '[data-viewer=babylon]', '#tasks li']) {
    const box = await page.locator(selector).first().boundingBox();
    assert.ok(box !== null && box.x >= 0 && box.x + box.width <= 390 && box.y + box.height <= 760, `${selector} is on the screen: ${JSON.stringify(box)}`);
  }
  await page.screenshot({ path: path.join(options.out, 'phone.png') });
  await page.context().close();
}

checkCommand();
const file = makeFiles();
const url = await startServer(file('house.glb'));
const browser = await openBrowser();
const page = await browser.page(640, 480, { locale: 'en-US' });
await page.goto(url);
await ready(page);
assert.match(await page.locator('#facts').textContent(), /^\d+ objects · nodes · [\d.]+ s$/);
const three = await checkSeeking(page, 'three.js');
await checkPlaying(page);
await checkCalendar(page, file);
await page.screenshot({ path: path.join(options.out, 'three.png') });
await checkOtherFiles(page, file, three);
await page.locator('[data-viewer=babylon]').click();
await page.waitForFunction(() => window.scenegenPlayer.state.viewer.name === 'Babylon.js');
await ready(page);
await page.locator('#fit').click();
const babylon = await checkSeeking(page, 'Babylon.js');
babylon.forEach((share, i) => assert.ok(Math.abs(share - three[i]) < 0.004, `both show the same: ${three}; ${babylon}`));
await checkOtherFiles(page, file, babylon);
await page.screenshot({ path: path.join(options.out, 'babylon.png') });
await checkPhone(browser, url);
assert.deepEqual(browser.faults, []);
await browser.close();
console.log('the page plays, seeks, switches, takes files and shows dates');
process.exit(0);
