// Documents of other programs, for tests of patch().
#pragma once

#include <string>

namespace scenegen::testing {

/// `path` (.gltf, pretty-printed), with model.bin or in.bin (its stem) and picture.png beside it: hierarchy,
/// two animations, a skin, morph targets, a camera and a light below meshes, matrices with and without shear,
/// names twice and none, extras of every kind, extensions nobody knows. Objects: Crate, Arm, Hand, Skewed,
/// Placed, Lamp, Eye, Skinned, Bone, Morphed, Cube, Cube_2, nothing, node_… .
void write_everything_document(const std::string& path);

/// Three instances of one node.
void write_instanced_document(const std::string& path);

}  // namespace scenegen::testing
