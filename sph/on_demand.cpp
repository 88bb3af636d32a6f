#include "sph/on_demand.hpp"

#include <dlfcn.h>

#include <filesystem>
#include <stdexcept>

namespace sprung::sph {

void* function_on_demand(const std::string& module, const char* name) {
  const auto program = std::filesystem::read_symlink("/proc/self/exe");
  const auto file = program.parent_path() / (module + ".so");
  // Never unloaded: these libraries keep handlers that run when the program ends.
  void* handle = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* function = handle ? dlsym(handle, name) : nullptr;
  if (!function)
    throw std::runtime_error("cannot load " + module +
                             ", which this scene calls for: " + dlerror());
  return function;
}

}  // namespace sprung::sph
