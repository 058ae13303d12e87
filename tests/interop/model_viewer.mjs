// <model-viewer>, an element and not a library: the interface of examples/web/viewers/viewer.mjs as far as it can be had.
import { ModelViewerElement } from '@google/model-viewer/dist/model-viewer.min.js';
import { kDefaults } from '../../examples/web/viewers/viewer.mjs';

// A Radiance picture, all of it light of strength 1.
const kWhite = new Blob(['#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 128 +X 256\n', new Uint8Array(128 * 256 * 4).map((_, i) => (i % 4 === 3 ? 129 : 128))]);
const degrees = (radians) => radians * 180 / Math.PI;

class ModelViewer {
  name = 'model-viewer';
  version = '4.4.0';

  constructor(canvas, options) {
    this.options = options;
    ModelViewerElement.minimumRenderScale = 1;  // else it draws smaller where drawing is slow
    this.element = document.createElement('model-viewer');
    this.element.style.cssText = `display:block;width:${canvas.width}px;height:${canvas.height}px;--poster-color:transparent`;
    const attributes = {
      'interaction-prompt': 'none', 'min-camera-orbit': 'auto 0deg 0.01m',
      'min-field-of-view': '1deg', 'max-field-of-view': '120deg', 'interpolation-decay': '0', 'shadow-intensity': '0',
    };
    // A white room: as near to the colours of the file as this viewer comes.
    if (options.flat) Object.assign(attributes, { 'environment-image': `${URL.createObjectURL(kWhite)}#.hdr`, 'tone-mapping': 'none' });
    for (const [name, value] of Object.entries(attributes)) this.element.setAttribute(name, value);
    canvas.replaceWith(this.element);
  }

  async load(source) {
    await new Promise((resolve, reject) => {
      this.element.addEventListener('load', resolve, { once: true });
      this.element.addEventListener('error', (event) => reject(new Error(String(event.detail?.sourceError ?? event.detail?.type))), { once: true });
      this.element.src = typeof source === 'string' ? source : URL.createObjectURL(new Blob([source], { type: 'model/gltf-binary' }));
    });
    this.duration_s = this.element.duration;
    this.element.animationName = this.element.availableAnimations[0] ?? null;
    await this.element.updateComplete;
    this.element.play({ repetitions: 1 });
    this.element.pause();
    this.duration_s = this.element.duration;
    return { duration_s: this.duration_s };
  }

  /// At the very end it begins again.
  seek(time_s) {
    this.element.currentTime = Math.min(Math.max(time_s, 0), this.duration_s * (1 - 1e-6));
  }

  setCamera({ eye_m, target_m, yfov_rad }) {
    const [x, y, z] = eye_m.map((value, axis) => value - target_m[axis]);
    const radius = Math.hypot(x, y, z);
    this.element.cameraTarget = target_m.map((value) => `${value}m`).join(' ');
    this.element.maxCameraOrbit = `auto 180deg ${2 * radius}m`;  // its clipping planes follow from this
    this.element.cameraOrbit = `${Math.atan2(x, z)}rad ${Math.acos(y / radius)}rad ${radius}m`;
    this.element.fieldOfView = `${degrees(yfov_rad)}deg`;
    this.element.jumpCameraToGoal();
  }

  async render() {
    await this.element.updateComplete;
    for (let i = 0; i < 3; i += 1) await new Promise(requestAnimationFrame);
  }

  async pixels() {
    await this.render();
    const blob = await this.element.toBlob({ mimeType: 'image/png' });
    const image = await createImageBitmap(blob, { premultiplyAlpha: 'none', colorSpaceConversion: 'none' });
    const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
    const [r, g, b] = this.options.background ?? [255, 255, 255];
    context.fillStyle = `rgb(${r},${g},${b})`;
    context.fillRect(0, 0, image.width, image.height);
    context.drawImage(image, 0, 0);
    return context.getImageData(0, 0, image.width, image.height);
  }

  dispose() {
    this.element.remove();
  }
}

export const create = (canvas, options = {}) => new ModelViewer(canvas, { ...kDefaults, ...options });
