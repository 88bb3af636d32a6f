#pragma once
/// Libraries that few scenes call for. Gmsh brings ninety others with it and hypre brings MPI;
/// linked in, every run would load 45 MB and 0.15 s of them. Each stands behind a module of its
/// own, beside the program, which is loaded when a scene first asks.

#include <string>

namespace sprung::sph {

/// The function `name` of the module `module`, loaded if it was not. Throws std::runtime_error that
/// says what is missing.
void* function_on_demand(const std::string& module, const char* name);

/// The same with its type, the type of a declaration: on_demand<decltype(f)>("module", "f").
template <typename Function>
Function* on_demand(const std::string& module, const char* name) {
  return reinterpret_cast<Function*>(function_on_demand(module, name));
}

}  // namespace sprung::sph
