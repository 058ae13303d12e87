// The player page: one file, one viewer at a time, one clock. URL parameters: file, viewer (three, babylon), t (seconds).
import { calendarOf } from './calendar.mjs';
import { openFile } from './scene_file.mjs';
import { create as babylon } from './viewers/babylon.mjs';
import { create as three } from './viewers/three.mjs';

const kViewers = { three, babylon };
const kMostTasks = 6, kMostTasksNarrow = 3;
const kSettleMs = 700;  // how long a touched camera may go on gliding

const $ = (selector) => document.querySelector(selector);
const parameters = new URLSearchParams(location.search);

const state = {
  file: null, viewer: null, viewerName: parameters.get('viewer') in kViewers ? parameters.get('viewer') : 'three',
  calendar: null, duration_s: 0, time_s: 0, playing: false, stale: false, drawUntil: 0, lastFrame: 0,
};

// ---- What is shown

function showTime() {
  const { time_s, duration_s, calendar } = state;
  $('#slider').value = time_s;
  $('#slider').style.setProperty('--done', `${duration_s > 0 ? 100 * time_s / duration_s : 0}%`);
  const seconds = `${time_s.toFixed(duration_s < 100 ? 2 : 1)} / ${duration_s.toFixed(duration_s < 100 ? 2 : 1)} s`;
  $('#date').textContent = calendar === null ? '' : calendar.dayAt(time_s);
  $('#time').textContent = [calendar?.hourAt(time_s), seconds].filter(Boolean).join(' · ');
  if (calendar !== null) showTasks(calendar.tasksAt(time_s));
}

function taskRow(task) {
  const row = document.createElement('li');
  row.dataset.type = task.type ?? '';
  const [dot, name, type, done] = ['i', 'b', 'small', 'progress'].map((tag) => document.createElement(tag));
  name.textContent = name.title = task.name || task.id;
  type.textContent = task.type ?? '';
  done.value = task.finish > task.start ? (state.time_s - task.start) / (task.finish - task.start) : 1;
  row.append(dot, name, type, done);
  return row;
}

function showTasks(tasks) {
  $('#tasks h2').textContent = tasks.length === 0 ? 'Nothing in progress' : 'In progress';
  const most = window.innerWidth > 640 ? kMostTasks : kMostTasksNarrow;
  $('#tasks ul').replaceChildren(...tasks.slice(0, most).map(taskRow));
  $('#tasks .more').textContent = tasks.length > most ? `and ${tasks.length - most} more` : '';
}

/// How much happens when, as a hill behind the slider.
function showEvents() {
  const bins = new Float64Array(120);
  for (const { time_s, count } of state.file.events) {
    bins[Math.min(Math.floor(time_s / state.duration_s * bins.length), bins.length - 1)] += count;
  }
  const most = Math.max(...bins);
  const step = 100 / bins.length;
  const hill = [...bins].map((count, i) => (count === 0 ? '' : `M${i * step} 1V${1 - Math.max(count / most, 0.08)}H${(i + 0.8) * step}V1z`));
  $('#events path').setAttribute('d', most > 0 ? hill.join('') : '');
}

function showFile() {
  const { name, json } = state.file;
  const scenegen = json.asset?.extras?.scenegen;
  const objects = scenegen?.objects ?? (json.nodes ?? []).filter((node) => node.mesh !== undefined).length;
  const layout = scenegen?.layout === 'patched' ? null : scenegen?.layout;  // nodes of the program that made the model
  const facts = [`${objects.toLocaleString('en')} objects`, layout, state.duration_s > 0 ? `${state.duration_s.toFixed(1)} s` : 'static'];
  $('#name').textContent = name;
  $('#facts').textContent = facts.filter(Boolean).join(' · ');
  document.title = `${name} – scenegen player`;
  $('#slider').max = Math.max(state.duration_s, 1e-3);
  $('#tasks').hidden = state.calendar === null || state.calendar.tasks.length === 0;
  showEvents();
  showTime();
}

function fault(error) {
  console.warn(error);
  $('#fault span').textContent = error.message.split('\n')[0];
  $('#fault').hidden = false;
}

// ---- What happens

function seek(time_s) {
  state.time_s = Math.min(Math.max(time_s, 0), state.duration_s);
  state.viewer?.seek(state.time_s);
  showTime();
  drawFor(0);
}

function play(playing) {
  if (playing && state.time_s >= state.duration_s) seek(0);
  state.playing = playing && state.duration_s > 0;
  document.body.toggleAttribute('data-playing', state.playing);
  $('#play').setAttribute('aria-label', state.playing ? 'Pause' : 'Play');
}

function drawFor(milliseconds) {
  state.stale = true;
  state.drawUntil = Math.max(state.drawUntil, performance.now() + milliseconds);
}

function fitCanvas() {
  const scale = Math.min(window.devicePixelRatio, 2), stage = $('#stage');
  state.viewer?.resize(Math.max(1, Math.round(stage.clientWidth * scale)), Math.max(1, Math.round(stage.clientHeight * scale)));
  drawFor(100);
}

/// A canvas belongs to the context that it was first used with: every viewer gets a new one.
function newViewer(name) {
  state.viewer?.dispose();
  const canvas = document.createElement('canvas');
  $('#stage').replaceChildren(canvas);
  canvas.width = $('#stage').clientWidth;
  canvas.height = $('#stage').clientHeight;
  state.viewer = kViewers[name](canvas, { controls: true });
  state.viewerName = name;
  for (const button of document.querySelectorAll('[data-viewer]')) button.setAttribute('aria-checked', button.dataset.viewer === name);
  fitCanvas();
}

/// Gives the open file to the viewer; one call at a time, since viewers cannot be hurried.
let queue = Promise.resolve();
function enqueue(work) {
  queue = queue.then(work).catch(fault).finally(() => { document.body.dataset.state = state.file === null ? 'empty' : 'ready'; });
  return queue;
}

const open = (from) => enqueue(async () => {
  $('#fault').hidden = true;
  play(false);
  document.body.dataset.state = 'loading';
  const file = await openFile(from);
  if (state.viewer === null) newViewer(state.viewerName);
  const { duration_s } = await state.viewer.load(file.source);
  Object.assign(state, { file, duration_s, calendar: calendarOf(file.json), time_s: 0 });
  state.viewer.frame();
  showFile();
  seek(0);
});

const switchTo = (name) => enqueue(async () => {
  if (name === state.viewerName && state.viewer !== null) return;
  document.body.dataset.state = 'loading';
  const camera = state.file === null ? null : state.viewer.getCamera();
  newViewer(name);
  if (state.file === null) return;
  await state.viewer.load(state.file.source);
  state.viewer.setCamera(camera);
  seek(state.time_s);
});

function frame(now) {
  const elapsed_s = (now - state.lastFrame) / 1000;
  state.lastFrame = now;
  if (document.body.dataset.state === 'ready') {
    if (state.playing) {
      seek(state.time_s + Math.min(elapsed_s, 0.25) * Number($('#speed').value));
      if (state.time_s >= state.duration_s) play(false);
    }
    if (state.stale || now <= state.drawUntil) {
      state.stale = false;
      state.viewer.draw();
    }
  }
  requestAnimationFrame(frame);
}

// ---- Who asks for it

function listen() {
  $('#play').addEventListener('click', () => play(!state.playing));
  $('#slider').addEventListener('input', (event) => seek(Number(event.target.value)));
  $('#fit').addEventListener('click', () => { state.viewer?.frame(); drawFor(kSettleMs); });
  $('#fault button').addEventListener('click', () => { $('#fault').hidden = true; });
  $('#open').addEventListener('change', (event) => { if (event.target.files.length > 0) open(event.target.files[0]); });
  for (const button of document.querySelectorAll('[data-viewer]')) button.addEventListener('click', () => switchTo(button.dataset.viewer));
  for (const kind of ['pointerdown', 'pointermove', 'pointerup', 'wheel']) $('#stage').addEventListener(kind, () => drawFor(kSettleMs), { passive: true });
  new ResizeObserver(fitCanvas).observe($('#stage'));
  window.addEventListener('keydown', (event) => {
    if (event.target.matches('input, select, button') && event.key === ' ') return;
    if (event.key === ' ') play(!state.playing);
    else if (event.key === 'f') $('#fit').click();
    else if (event.key === 'Home' && event.target === document.body) seek(0);
    else return;
    event.preventDefault();
  });
  let inside = 0;  // dragenter and dragleave come for every element on the way
  const dragging = (change) => { inside = Math.max(0, inside + change); document.body.toggleAttribute('data-dragging', inside > 0); };
  window.addEventListener('dragenter', () => dragging(1));
  window.addEventListener('dragleave', () => dragging(-1));
  window.addEventListener('dragover', (event) => event.preventDefault());
  window.addEventListener('drop', (event) => {
    event.preventDefault();
    dragging(-inside);
    if (event.dataTransfer.files.length > 0) open(event.dataTransfer.files[0]);
  });
}

listen();
for (const button of document.querySelectorAll('[data-viewer]')) button.setAttribute('aria-checked', button.dataset.viewer === state.viewerName);
if (parameters.has('file')) {
  open(parameters.get('file')).then(() => { if (state.file !== null && parameters.has('t')) seek(Number(parameters.get('t')) || 0); });
}
requestAnimationFrame(frame);
window.scenegenPlayer = { state, seek, play, open, switchTo };  // for scripts and tests
