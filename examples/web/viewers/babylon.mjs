// Babylon.js: plays core glTF, instancing and KHR_animation_pointer. See viewer.mjs for the interface.
import { ArcRotateCamera } from '@babylonjs/core/Cameras/arcRotateCamera.js';
import { Engine } from '@babylonjs/core/Engines/engine.js';
import { DirectionalLight } from '@babylonjs/core/Lights/directionalLight.js';
import { HemisphericLight } from '@babylonjs/core/Lights/hemisphericLight.js';
import { ShadowGenerator } from '@babylonjs/core/Lights/Shadows/shadowGenerator.js';
import '@babylonjs/core/Lights/Shadows/shadowGeneratorSceneComponent.js';
import { LoadAssetContainerAsync } from '@babylonjs/core/Loading/sceneLoader.js';
import { Color3, Color4 } from '@babylonjs/core/Maths/math.color.js';
import { Vector3 } from '@babylonjs/core/Maths/math.vector.js';
import { DracoDecoder } from '@babylonjs/core/Meshes/Compression/dracoDecoder.js';
import '@babylonjs/core/Animations/animatable.js';
import '@babylonjs/core/Meshes/thinInstanceMesh.js';
import { Scene } from '@babylonjs/core/scene.js';
import '@babylonjs/loaders/glTF/2.0/index.js';
import { eyeAround, kDefaults, readPixels } from './viewer.mjs';

const kYfovRad = 0.6;
const kFramesPerSecond = 60;  // Babylon counts time in frames; keys and seeks are multiplied by the same number

class BabylonViewer {
  name = 'Babylon.js';
  version = Engine.Version;

  constructor(canvas, options) {
    this.options = options;
    this.engine = new Engine(canvas, options.antialias, { alpha: options.background === null, premultipliedAlpha: true, doNotHandleContextLost: true });
    this.engine.getCaps().parallelShaderCompile = undefined;  // a frame then is whole when it has been drawn
    const folder = new URL(`${options.decoders}babylon/`, document.baseURI).href;
    DracoDecoder.DefaultConfiguration = {
      wasmUrl: `${folder}draco_wasm_wrapper_gltf.js`,
      wasmBinaryUrl: `${folder}draco_decoder_gltf.wasm`,
      fallbackUrl: `${folder}draco_decoder_gltf.js`,
    };
    this.scene = new Scene(this.engine);
    this.scene.useRightHandedSystem = true;
    this.scene.skipPointerMovePicking = true;
    const [r, g, b] = options.background ?? [0, 0, 0];
    this.scene.clearColor = new Color4(r / 255, g / 255, b / 255, options.background === null ? 0 : 1);
    this.camera = new ArcRotateCamera('eye', 0, 1, 10, Vector3.Zero(), this.scene);
    this.camera.inertia = 0.6;
    this.camera.wheelDeltaPercentage = 0.02;
    if (options.controls) this.camera.attachControl(canvas, true);
    this.container = null;
    this.addLights();
  }

  addLights() {
    this.sun = null;
    if (this.options.flat) return;  // materials are drawn unlit
    const sky = new HemisphericLight('sky', Vector3.Up(), this.scene);
    sky.intensity = 1.1;
    sky.groundColor = new Color3(0.45, 0.42, 0.4);
    this.sun = new DirectionalLight('sun', new Vector3(-0.5, -1, -0.35), this.scene);
    this.sun.diffuse = new Color3(1, 0.95, 0.88);
    this.sun.intensity = 2.2;
    if (this.options.shadows) this.addShadows();
    this.scene.imageProcessingConfiguration.toneMappingEnabled = true;
    this.scene.imageProcessingConfiguration.toneMappingType = 2;  // Khronos PBR neutral, as in three.mjs
  }

  addShadows() {
    this.shadows = new ShadowGenerator(2048, this.sun);
    this.shadows.bias = 0.001;  // of the depth that the map covers: with less, surfaces shade themselves in stripes
    this.shadows.usePercentageCloserFiltering = true;
  }

  async load(source) {
    const container = await LoadAssetContainerAsync(typeof source === 'string' ? source : new Uint8Array(source), this.scene, {
      pluginExtension: typeof source === 'string' ? undefined : '.glb',
      pluginOptions: { gltf: { animationStartMode: 0, targetFps: kFramesPerSecond, loadAllMaterials: true } },
    });
    this.unload();
    this.container = container;
    container.addAllToScene();
    for (const material of container.materials) if (this.options.flat) material.unlit = true;
    this.measure();
    this.group = container.animationGroups[0] ?? null;  // ours comes first
    this.duration_s = this.group === null ? 0 : this.group.to / kFramesPerSecond;
    if (this.group !== null) {
      this.group.start(false);
      this.group.pause();
    }
    if (this.sun !== null) this.placeSun();
    this.seek(0);
    await this.scene.whenReadyAsync();
    return { duration_s: this.duration_s };
  }

  /// Before the animation has been touched, the nodes have the scales that they are shown with.
  measure() {
    let low = new Vector3(Infinity, Infinity, Infinity), high = low.negate();
    for (const mesh of this.container.meshes) {
      if (mesh.getTotalVertices() === 0) continue;
      mesh.computeWorldMatrix(true);
      if (mesh.hasThinInstances) mesh.thinInstanceRefreshBoundingInfo();
      const box = mesh.getBoundingInfo().boundingBox;
      low = Vector3.Minimize(low, box.minimumWorld);
      high = Vector3.Maximize(high, box.maximumWorld);
    }
    if (low.x > high.x) [low, high] = [Vector3.Zero(), Vector3.One()];
    this.center = low.add(high).scale(0.5);
    this.radius = Math.max(high.subtract(low).length() / 2, 1e-3);
  }

  placeSun() {
    this.sun.position = this.center.subtract(this.sun.direction.normalizeToNew().scale(2 * this.radius));
    if (!this.options.shadows) return;
    this.shadows.getShadowMap().renderList = this.container.meshes;
    for (const mesh of this.container.meshes) mesh.receiveShadows = true;
  }

  seek(time_s) {
    this.time_s = Math.min(Math.max(time_s, 0), this.duration_s);
    this.group?.goToFrame(this.time_s * kFramesPerSecond);
  }

  frame() {
    const center = this.center.asArray();
    const aspect = this.engine.getRenderWidth() / this.engine.getRenderHeight();
    this.setCamera({ eye_m: eyeAround(center, this.radius, kYfovRad, aspect), target_m: center, yfov_rad: kYfovRad });
  }

  setCamera({ eye_m, target_m, yfov_rad }) {
    this.camera.fov = yfov_rad;
    this.camera.setTarget(Vector3.FromArray(target_m));
    this.camera.setPosition(Vector3.FromArray(eye_m));
    const reach = this.camera.position.subtract(this.center).length() + this.radius;
    this.camera.minZ = reach / 5000;
    this.camera.maxZ = 4 * reach;
    this.camera.lowerRadiusLimit = reach / 1000;
    this.camera.upperRadiusLimit = 3 * reach;
    this.camera.panningSensibility = 2000 / reach;
  }

  getCamera() {
    return { eye_m: this.camera.position.asArray(), target_m: this.camera.target.asArray(), yfov_rad: this.camera.fov };
  }

  resize(width, height) {
    this.engine.setSize(width, height);
  }

  async render() {
    await this.scene.whenReadyAsync();
    this.draw();
  }

  draw() {
    this.scene.render();
  }

  async pixels() {
    await this.render();
    return readPixels(this.engine._gl);
  }

  unload() {
    this.container?.dispose();
    this.container = null;
  }

  dispose() {
    this.unload();
    this.scene.dispose();
    this.engine.dispose();
  }
}

export const create = (canvas, options = {}) => new BabylonViewer(canvas, { ...kDefaults, ...options });
