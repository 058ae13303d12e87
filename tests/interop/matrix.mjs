// The tables of docs/INTEROP.md, between its two marks: from what was measured, or from what is expected.
import { readFileSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { kFeatures, kLayouts, kViewers, kVisibilities } from './expectations.mjs';

const kBegin = '<!-- tables: tests/interop writes them (docs/INTEROP.md, section 5) -->', kEnd = '<!-- end of tables -->';
const kHeads = { 'three': 'three.js', 'three+pointer': 'three.js + plug-in', 'babylon': 'Babylon.js', 'model-viewer': 'model-viewer' };
const kPackages = { 'three': 'three', 'three+pointer': '@needle-tools/three-animation-pointer', 'babylon': '@babylonjs/core', 'model-viewer': '@google/model-viewer' };

const row = (cells) => `| ${cells.join(' | ')} |\n`;

/// does(viewer, form, feature): true where it plays.
export function tables(does, modules) {
  const version = (viewer) => JSON.parse(readFileSync(path.join(modules, kPackages[viewer], 'package.json'))).version;
  const head = (first) => row([...first, ...kViewers.map((viewer) => `${kHeads[viewer]} ${version(viewer)}`)]) + row([...first, ...kViewers].map(() => '---'));
  const visible = (viewer, form) => {
    if (!does(viewer, form, 'visibility')) return '–';
    return does(viewer, form, 'passing look') ? '✓' : '✓ but looks ¹';
  };
  let text = head(['`--layout`', '`--visibility`']);
  for (const layout of kLayouts) {
    for (const visibility of kVisibilities) text += row([`\`${layout}\``, `\`${visibility}\``, ...kViewers.map((viewer) => visible(viewer, { layout, visibility }))]);
  }
  text += `\n${head(['in every layout'])}`;
  const everywhere = (viewer, feature) => kLayouts.every((layout) => kVisibilities.every((visibility) => does(viewer, { layout, visibility }, feature)));
  for (const feature of ['motion', 'look', 'color']) text += row([kFeatures[feature], ...kViewers.map((viewer) => (everywhere(viewer, feature) ? '✓' : '–'))]);
  return text;
}

function parts(file) {
  const text = readFileSync(file, 'utf8'), from = text.indexOf(kBegin), to = text.indexOf(kEnd);
  if (from < 0 || to < from) throw new Error(`${file}: the marks of the tables are missing`);
  return { before: text.slice(0, from + kBegin.length), tables: text.slice(from + kBegin.length, to).trim(), after: text.slice(to) };
}

export const tablesIn = (file) => parts(file).tables;
export function writeTables(file, text) {
  const { before, after } = parts(file);
  writeFileSync(file, `${before}\n\n${text.trim()}\n\n${after}`);
}
