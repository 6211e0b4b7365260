#include "experiments/support/plugin.h"

#include <dlfcn.h>

#include <stdexcept>
#include <string>

namespace orthant {

void load_plugin(const std::filesystem::path& file) {
  if (file.extension() == ".py")
    throw std::invalid_argument(
        "--plugin '" + file.string() +
        "': is a Python file: must be given to the command of the Python package (python -m orthant)");
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    throw std::invalid_argument("--plugin '" + file.string() + "': must be a shared library that exists");
  void* library = dlopen(std::filesystem::absolute(file).c_str(), RTLD_NOW | RTLD_GLOBAL);
  if (library == nullptr) {
    const char* why = dlerror();
    throw std::invalid_argument("--plugin '" + file.string() + "': cannot be loaded: " + (why != nullptr ? why : "?"));
  }
  const auto begin = reinterpret_cast<void (*)()>(dlsym(library, "orthant_plugin"));
  if (begin == nullptr)
    throw std::invalid_argument("--plugin '" + file.string() +
                                "': must have a function extern \"C\" void orthant_plugin()");
  begin();
}

}  // namespace orthant
