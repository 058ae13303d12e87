#include "gen/model.h"

namespace scenegen::gen {

// Until the reader of glTF is in the tree, a model file is refused.
Result<Scene> read_model(const std::string& path, const char* option, std::vector<std::string>& /*notes*/) {
  return fail(ErrorKind::usage, option, "'" + path + "': model files are not read by this version");
}

}  // namespace scenegen::gen
