// node animate_peer.mjs IN.glb OUT.glb: the short way to do what `scenegen animate` does to a .glb of plain nodes, as a script that
// somebody would write: parse the JSON, append a STEP scale channel for every node with a mesh (4096 moments by node number, one
// sampler each), write it again. Peer of the benchmark; it does not look at where nodes are.
import { readFileSync, writeFileSync } from 'node:fs';

const [input, output] = process.argv.slice(2);
const bytes = readFileSync(input);
const jsonBytes = bytes.readUInt32LE(12);
const document = JSON.parse(bytes.subarray(20, 20 + jsonBytes).toString());
const chunk = bytes.subarray(28 + jsonBytes);

const moments = 4096;
const times = new Float32Array(2 * moments);
for (let i = 0; i < moments; i += 1) times[2 * i + 1] = (i + 1) * 0.01;
const scales = new Float32Array([0, 0, 0, 1, 1, 1]);
const view = (offset, length) => document.bufferViews.push({ buffer: 0, byteOffset: offset, byteLength: length }) - 1;
const timeView = view(chunk.length, times.byteLength);
const scaleView = view(chunk.length + times.byteLength, scales.byteLength);
const scale = document.accessors.push({ bufferView: scaleView, componentType: 5126, count: 2, type: 'VEC3' }) - 1;
const samplers = [];
for (let i = 0; i < moments; i += 1) {
  const accessor = { bufferView: timeView, byteOffset: 8 * i, componentType: 5126, count: 2, type: 'SCALAR', min: [0], max: [times[2 * i + 1]] };
  samplers.push({ input: document.accessors.push(accessor) - 1, output: scale, interpolation: 'STEP' });
}
const channels = [];
document.nodes.forEach((node, i) => {
  if (node.mesh !== undefined) channels.push({ sampler: i % moments, target: { node: i, path: 'scale' } });
});
(document.animations ??= []).unshift({ samplers, channels });
document.buffers[0].byteLength = chunk.length + times.byteLength + scales.byteLength;

let json = Buffer.from(JSON.stringify(document));
json = Buffer.concat([json, Buffer.alloc((4 - (json.length % 4)) % 4, ' ')]);
const binary = Buffer.concat([chunk, Buffer.from(times.buffer), Buffer.from(scales.buffer)]);
const head = Buffer.alloc(20);
head.write('glTF');
head.writeUInt32LE(2, 4);
head.writeUInt32LE(28 + json.length + binary.length, 8);
head.writeUInt32LE(json.length, 12);
head.write('JSON', 16);
const middle = Buffer.alloc(8);
middle.writeUInt32LE(binary.length, 0);
middle.write('BIN\0', 4);
writeFileSync(output, Buffer.concat([head, json, middle, binary]));
