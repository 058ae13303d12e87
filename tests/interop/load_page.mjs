// The page in which load_bench.mjs times how long three.js, as its users have it, takes to load a file and to show it.
import * as THREE from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

/// Seconds until the loader is done, and milliseconds of script of the frames after: the first (which uploads everything),
/// and the middle one of `frames` at times all over the clip.
window.time_load = async (url, frames) => {
  const began = performance.now();
  const gltf = await new GLTFLoader().loadAsync(url);
  const load_s = (performance.now() - began) / 1000;
  const scene = new THREE.Scene();
  scene.add(gltf.scene);
  const renderer = new THREE.WebGLRenderer({ antialias: false });
  renderer.setSize(320, 240, false);
  const box = new THREE.Box3().setFromObject(gltf.scene);
  const camera = gltf.cameras[0] ?? new THREE.PerspectiveCamera(60, 4 / 3, 0.1, 10000);
  if (gltf.cameras.length === 0) camera.position.copy(box.max);
  const mixer = new THREE.AnimationMixer(gltf.scene);
  for (const clip of gltf.animations) mixer.clipAction(clip).play();
  const end_s = Math.max(0, ...gltf.animations.map((clip) => clip.duration));
  const times = [];
  for (let i = 0; i <= frames; ++i) {
    const start = performance.now();
    mixer.setTime((end_s * (frames - i)) / (frames + 1));
    renderer.render(scene, camera);
    times.push(performance.now() - start);
  }
  const [first_ms, ...rest] = times;
  return { load_s, first_ms, frame_ms: rest.sort((a, b) => a - b)[Math.floor(rest.length / 2)], draws: renderer.info.render.calls };
};
window.ready = true;
