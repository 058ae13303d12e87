// What plays where: the matrix of docs/INTEROP.md as a function. The tests hold every viewer to it, in both directions.
export const kViewers = ['three', 'three+pointer', 'babylon', 'model-viewer'];
export const kLayouts = ['nodes', 'groups', 'instances', 'merged'];
export const kVisibilities = ['scale', 'pointer', 'both'];
export const kFeatures = {
  'visibility': 'objects appear and vanish',
  'motion': 'objects move, turn and grow (STEP, LINEAR, CUBICSPLINE)',
  'look': 'materials are swapped (`swap`)',
  'passing look': 'objects with swapped materials appear and vanish',
  'color': 'a material\'s base colour is animated (`pointer`)',
};

/// feature: of kFeatures, or 'all': everything that the file holds; then `bare`: it has pointers to the visibility of nodes without a mesh.
export function plays(viewer, { layout, visibility, color, bare }, feature) {
  const pointers = viewer === 'three+pointer' || viewer === 'babylon';
  switch (feature) {
    case 'visibility':
      // Babylon passes over pointers to the visibility of nodes without a mesh.
      return visibility !== 'pointer' || (pointers && !(viewer === 'babylon' && layout === 'groups'));
    case 'passing look':
      // … and an object with looks is a node without a mesh, but where objects with the same looks share nodes.
      return visibility !== 'pointer' || viewer === 'three+pointer' || (viewer === 'babylon' && (layout === 'instances' || layout === 'merged'));
    case 'color':
      return pointers;
    case 'all':
      return (visibility !== 'pointer' || (pointers && !(viewer === 'babylon' && bare))) && (color !== 'pointer' || pointers);
    default:
      return true;
  }
}
