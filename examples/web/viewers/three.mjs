// three.js. Plain it plays core glTF and instancing; with `pointer` (the default) also KHR_animation_pointer, through
// Needle's plug-in. See viewer.mjs for the interface.
import * as THREE from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { RoomEnvironment } from 'three/examples/jsm/environments/RoomEnvironment.js';
import { DRACOLoader } from 'three/examples/jsm/loaders/DRACOLoader.js';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';
import { GLTFAnimationPointerExtension } from '@needle-tools/three-animation-pointer';
import { eyeAround, kDefaults, readPixels } from './viewer.mjs';

const kYfovRad = 0.6;

function addLights(scene, renderer, { flat, shadows, plainLight }) {
  if (flat) {  // a surface then has exactly its base colour
    scene.add(new THREE.AmbientLight(0xffffff, Math.PI));
    return null;
  }
  if (plainLight) {
    scene.add(new THREE.HemisphereLight(0xffffff, 0x736b66, 1.6));
  } else {
    const generator = new THREE.PMREMGenerator(renderer);
    scene.environment = generator.fromScene(new RoomEnvironment(), 0.04, 0.1, 100, { size: 64 }).texture;
    scene.environmentIntensity = 0.55;
    generator.dispose();
  }
  const sun = new THREE.DirectionalLight(0xfff3e0, 2.4);
  sun.castShadow = shadows;
  sun.shadow.mapSize.set(2048, 2048);
  sun.shadow.normalBias = 0.02;
  scene.add(sun, sun.target);
  return sun;
}

/// The light's box round the scene, so that the whole of the shadow map is used.
function placeSun(sun, ball) {
  const radius = Math.max(ball.radius, 1e-3);
  sun.target.position.copy(ball.center);
  sun.position.copy(ball.center).add(new THREE.Vector3(0.5, 1, 0.35).normalize().multiplyScalar(2 * radius));
  Object.assign(sun.shadow.camera, { left: -radius, right: radius, top: radius, bottom: -radius, near: 0, far: 4 * radius });
  sun.shadow.camera.updateProjectionMatrix();
}

/// World ball round everything that the file holds, hidden or not: a scene may be empty at the time shown.
function ballOf(root) {
  const box = new THREE.Box3(), one = new THREE.Box3(), matrix = new THREE.Matrix4();
  root.updateMatrixWorld(true);
  root.traverse((object) => {
    if (!object.isMesh) return;
    if (object.geometry.boundingBox === null) object.geometry.computeBoundingBox();
    for (let i = 0; i < (object.isInstancedMesh ? object.count : 1); i += 1) {
      if (object.isInstancedMesh) object.getMatrixAt(i, matrix);
      else matrix.identity();
      box.union(one.copy(object.geometry.boundingBox).applyMatrix4(matrix.premultiply(object.matrixWorld)));
    }
  });
  return box.isEmpty() ? new THREE.Sphere(new THREE.Vector3(), 1) : box.getBoundingSphere(new THREE.Sphere());
}

/// Geometry, materials and textures of what is thrown away; the GPU keeps them otherwise.
function disposeTree(root) {
  root.traverse((object) => {
    if (!object.isMesh) return;
    object.geometry.dispose();
    for (const material of [object.material].flat()) {
      for (const value of Object.values(material)) if (value?.isTexture) value.dispose();
      material.dispose();
    }
    if (object.isInstancedMesh) object.dispose();
  });
}

class ThreeViewer {
  name = 'three.js';
  version = THREE.REVISION;

  constructor(canvas, options) {
    this.options = options;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: options.antialias, alpha: options.background === null });
    this.renderer.toneMapping = options.flat ? THREE.NoToneMapping : THREE.NeutralToneMapping;
    this.renderer.shadowMap.enabled = !options.flat && options.shadows;
    this.scene = new THREE.Scene();
    if (options.background !== null) this.scene.background = new THREE.Color(`rgb(${options.background.join(',')})`);
    this.sun = addLights(this.scene, this.renderer, options);
    this.camera = new THREE.PerspectiveCamera(THREE.MathUtils.radToDeg(kYfovRad), canvas.width / canvas.height, 0.1, 1000);
    this.controls = options.controls ? new OrbitControls(this.camera, canvas) : null;
    this.draco = new DRACOLoader().setDecoderPath(`${options.decoders}three/`);
    this.loader = new GLTFLoader().setDRACOLoader(this.draco);
    if (options.pointer) this.loader.register((parser) => new GLTFAnimationPointerExtension(parser));
    this.root = null;
    this.resize(canvas.width, canvas.height);
  }

  async load(source) {
    const gltf = typeof source === 'string' ? await this.loader.loadAsync(source) : await this.loader.parseAsync(source, '');
    this.unload();
    this.root = gltf.scene;
    this.ball = null;
    this.scene.add(this.root);
    this.mixer = new THREE.AnimationMixer(this.root);
    const clip = gltf.animations[0];  // ours comes first
    // The plug-in hands over 0 and 1 where three.js switches on booleans.
    for (const track of clip?.tracks ?? []) {
      if (track.ValueTypeName === 'bool') track.values = Array.from(track.values, Boolean);
    }
    this.action = clip === undefined ? null : this.mixer.clipAction(clip).setLoop(THREE.LoopOnce).play();
    this.duration_s = clip?.duration ?? 0;
    this.ball = this.measure();
    if (this.sun !== null) {
      placeSun(this.sun, this.ball);
      if (this.options.shadows) this.root.traverse((object) => { object.castShadow = object.receiveShadow = object.isMesh === true; });
    }
    this.seek(0);
    return { duration_s: this.duration_s };
  }

  /// At rest the nodes have the scales that they are shown with.
  measure() {
    this.mixer.stopAllAction();
    const ball = ballOf(this.root);
    this.action?.play();
    return ball;
  }

  seek(time_s) {
    this.time_s = Math.min(Math.max(time_s, 0), this.duration_s);
    if (this.action === null) return;
    this.action.paused = false;
    this.action.enabled = true;
    this.action.time = this.time_s;  // not mixer.setTime(): that one wraps at the end
    this.mixer.update(0);
  }

  frame() {
    const center = this.ball.center.toArray();
    this.setCamera({ eye_m: eyeAround(center, this.ball.radius, kYfovRad, this.camera.aspect), target_m: center, yfov_rad: kYfovRad });
  }

  setCamera({ eye_m, target_m, yfov_rad }) {
    this.camera.fov = THREE.MathUtils.radToDeg(yfov_rad);
    this.camera.position.fromArray(eye_m);
    this.camera.lookAt(...target_m);
    const reach = this.camera.position.distanceTo(this.ball.center) + this.ball.radius;
    this.camera.near = reach / 5000;
    this.camera.far = 4 * reach;
    this.camera.updateProjectionMatrix();
    if (this.controls !== null) {
      this.controls.target.fromArray(target_m);
      this.controls.maxDistance = 3 * reach;
      this.controls.update();
    }
  }

  getCamera() {
    const target_m = this.controls?.target.toArray() ?? this.ball.center.toArray();
    return { eye_m: this.camera.position.toArray(), target_m, yfov_rad: THREE.MathUtils.degToRad(this.camera.fov) };
  }

  resize(width, height) {
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
  }

  async render() {
    this.draw();
  }

  draw() {
    this.renderer.render(this.scene, this.camera);
  }

  async pixels() {
    this.draw();
    return readPixels(this.renderer.getContext());
  }

  unload() {
    if (this.root === null) return;
    this.mixer.stopAllAction();
    this.scene.remove(this.root);
    disposeTree(this.root);
    this.root = null;
  }

  dispose() {
    this.unload();
    this.controls?.dispose();
    this.draco.dispose();
    this.scene.environment?.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }
}

export const create = (canvas, options = {}) => new ThreeViewer(canvas, { ...kDefaults, pointer: true, ...options });
