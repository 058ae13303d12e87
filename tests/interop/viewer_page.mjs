// The page in which the tests drive viewers: one at a time, `window.viewer`.
import { create as babylon } from '../../examples/web/viewers/babylon.mjs';
import { create as three } from '../../examples/web/viewers/three.mjs';
import { create as modelViewer } from './model_viewer.mjs';

const kCreate = {
  'three': (canvas, options) => three(canvas, { ...options, pointer: false }),
  'three+pointer': three,
  'babylon': babylon,
  'model-viewer': modelViewer,
};

window.open_viewer = (name, [width, height], options) => {
  window.viewer?.dispose();
  document.body.replaceChildren();
  const canvas = document.createElement('canvas');
  canvas.width = width;
  canvas.height = height;
  document.body.append(canvas);
  window.viewer = kCreate[name](canvas, options);
  return `${window.viewer.name} ${window.viewer.version}`;
};

/// The image at a time, as base64: what the browser hands over fastest.
window.shot = async (time_s) => {
  window.viewer.seek(time_s);
  const { width, height, data } = await window.viewer.pixels();
  let text = '';
  for (let i = 0; i < data.length; i += 32768) text += String.fromCharCode(...data.subarray(i, i + 32768));
  return { width, height, data: btoa(text) };
};
window.ready = true;
