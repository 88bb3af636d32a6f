#pragma once
/// What the module sprung-gmsh does; see sph/on_demand.hpp.

#include <cstddef>
#include <string>
#include <vector>

namespace sprung::sph {

/// Triangles as a file has them.
struct FileTriangles {
  std::vector<std::size_t> tags;    ///< one per point
  std::vector<double> coordinates;  ///< three per point, m
  std::vector<std::size_t> nodes;   ///< tags, three per triangle
  std::string fault;                ///< why Gmsh could not read it; empty when it could
};

/// Reads STL or a Gmsh mesh; points at one place count as one. Throws nothing.
extern "C" void read_gmsh_triangles(const char* file, FileTriangles& triangles);

}  // namespace sprung::sph
