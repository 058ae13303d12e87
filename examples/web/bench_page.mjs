// The page in which bench.mjs measures one viewer with one file.
import { create as babylon } from './viewers/babylon.mjs';
import { create as three } from './viewers/three.mjs';

const kCreate = { three, babylon };
let viewer = null, gl = null, pixels = null;

const canvasContext = (canvas) => canvas.getContext('webgl2') ?? canvas.getContext('webgl');

/// {name, version, renderer: what WebGL draws with, samples}
window.open_viewer = (which, { size: [width, height], samples }) => {
  const canvas = document.createElement('canvas');
  Object.assign(canvas, { width, height });
  document.body.replaceChildren(canvas);
  viewer = kCreate[which](canvas, { antialias: samples > 1, shadows: false, plainLight: true });
  viewer.resize(width, height);
  gl = canvasContext(canvas);
  pixels = new Uint8Array(4 * width * height);
  const names = gl.getExtension('WEBGL_debug_renderer_info');
  return {
    name: viewer.name, version: String(viewer.version), samples: Math.max(gl.getParameter(gl.SAMPLES), 1),
    renderer: gl.getParameter(names === null ? gl.RENDERER : names.UNMASKED_RENDERER_WEBGL),
  };
};

/// {fetch_ms, load_ms, duration_s}: the file into memory, then a scene made of it.
window.load = async (url) => {
  const began = performance.now(), source = await (await fetch(url)).arrayBuffer(), fetched = performance.now();
  const { duration_s } = await viewer.load(source);
  return { fetch_ms: fetched - began, load_ms: performance.now() - fetched, duration_s };
};

function drawn({ time_s, camera }) {
  viewer.seek(time_s);
  viewer.setCamera(camera);
  viewer.draw();
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
}

/// Milliseconds from the call until the pixels are in memory; what was compiled or uploaded on the way counts.
window.frame = (moment) => {
  const began = performance.now();
  drawn(moment);
  return performance.now() - began;
};

/// Base64 of one byte a pixel, rows from the top: 1 where anything is. Nothing but what stands in the scene covers the canvas.
window.coverage = (moment) => {
  drawn(moment);
  const width = gl.drawingBufferWidth, height = gl.drawingBufferHeight;
  let text = '';
  for (let row = height - 1; row >= 0; row -= 1) {
    const line = new Uint8Array(width);
    for (let x = 0; x < width; x += 1) line[x] = pixels[4 * (row * width + x) + 3] > 127 ? 1 : 0;
    text += String.fromCharCode(...line);
  }
  return btoa(text);
};

window.heap_bytes = () => performance.memory?.usedJSHeapSize ?? null;
window.ready = true;
