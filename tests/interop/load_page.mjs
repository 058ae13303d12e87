// The page in which optimize_load.mjs times how long three.js, as its users have it, takes to load a file and to show it.
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

let loaded = null;

/// Seconds until the loader is done.
window.time_load = async (url) => {
  const began = performance.now();
  loaded = await new GLTFLoader().loadAsync(url);
  return (performance.now() - began) / 1000;
};

/// Milliseconds of script of the frames after it: the first (which uploads everything), and the middle one of `frames` at times
/// all over the clip.
window.time_frames = (frames) => {
  const scene = new THREE.Scene();
  scene.add(loaded.scene);
  const renderer = new THREE.WebGLRenderer({ antialias: false });
  renderer.setSize(320, 240, false);
  const box = new THREE.Box3().setFromObject(loaded.scene);
  const camera = loaded.cameras[0] ?? new THREE.PerspectiveCamera(60, 4 / 3, 0.1, 10000);
  if (loaded.cameras.length === 0) camera.position.copy(box.max);
  const mixer = new THREE.AnimationMixer(loaded.scene);
  for (const clip of loaded.animations) mixer.clipAction(clip).play();
  const end_s = Math.max(0, ...loaded.animations.map((clip) => clip.duration));
  const times = [];
  for (let i = 0; i <= frames; ++i) {
    const start = performance.now();
    mixer.setTime((end_s * (frames - i)) / (frames + 1));
    renderer.render(scene, camera);
    times.push(performance.now() - start);
  }
  const [first_ms, ...rest] = times;
  return { first_ms, frame_ms: rest.sort((a, b) => a - b)[Math.floor(rest.length / 2)] };
};
window.ready = true;
