// What the page itself wants to know of a file, before a viewer gets it: what scenegen says in its extras, and when
// something happens. docs/FORMAT.md describes both.

const kMagic = 0x46546c67, kJson = 0x4e4f534a, kBinary = 0x004e4942;

/// {json, binary: DataView or null} of a .glb; throws what is wrong with it.
function parseGlb(buffer) {
  const view = new DataView(buffer);
  if (buffer.byteLength < 20 || view.getUint32(0, true) !== kMagic) throw new Error('not a .glb file');
  let json = null, binary = null;
  for (let at = 12; at + 8 <= buffer.byteLength;) {
    const length = view.getUint32(at, true), kind = view.getUint32(at + 4, true);
    if (at + 8 + length > buffer.byteLength) throw new Error('the file is cut off');
    if (kind === kJson) json = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, at + 8, length)));
    if (kind === kBinary) binary = new DataView(buffer, at + 8, length);
    at += 8 + length;
  }
  if (json === null) throw new Error('the file has no JSON');
  return { json, binary };
}

/// Times of the keys of one input accessor, without those that only say where the timeline begins and ends.
function keyTimes(json, binary, index) {
  const accessor = json.accessors?.[index], view = json.bufferViews?.[accessor?.bufferView];
  if (binary === null || view === undefined || accessor.componentType !== 5126 || (view.buffer ?? 0) !== 0) return [];
  const first = (view.byteOffset ?? 0) + (accessor.byteOffset ?? 0), stride = view.byteStride ?? 4;
  const times = [];
  for (let i = 0; i < accessor.count && first + stride * i + 4 <= binary.byteLength; i += 1) times.push(binary.getFloat32(first + stride * i, true));
  return times.slice(1, -1);
}

/// How much happens over time: key times of the first animation with the number of channels that have them.
function eventsOf(json, binary) {
  const animation = json.animations?.[0];
  if (animation === undefined) return [];
  const channels = new Map();
  for (const { sampler } of animation.channels ?? []) {
    const input = animation.samplers?.[sampler]?.input;
    channels.set(input, (channels.get(input) ?? 0) + 1);
  }
  return [...channels].flatMap(([input, count]) => keyTimes(json, binary, input).map((time_s) => ({ time_s, count })));
}

/// {json, events, source}: `source` is what a viewer's load() takes. From a URL (.glb or .gltf) or a File.
export async function openFile(from) {
  let name, buffer;
  if (typeof from === 'string') {
    const response = await fetch(from);
    if (!response.ok) throw new Error(`${from}: ${response.status === 404 ? 'there is no such file' : response.statusText}`);
    name = decodeURIComponent(new URL(from, document.baseURI).pathname.split('/').pop());
    if (/\.gltf$/i.test(name)) return { name, json: await response.json(), events: [], source: new URL(from, document.baseURI).href };
    buffer = await response.arrayBuffer();
  } else {
    name = from.name;
    if (/\.gltf$/i.test(name)) throw new Error('a .gltf needs the files beside it: drop a .glb');
    buffer = await from.arrayBuffer();
  }
  const { json, binary } = parseGlb(buffer);
  return { name, json, events: eventsOf(json, binary), source: buffer };
}
