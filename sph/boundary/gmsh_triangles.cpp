#include "sph/boundary/gmsh_triangles.hpp"

#include "scene/gmsh_session.hpp"

namespace sprung::sph {

void read_gmsh_triangles(const char* file, FileTriangles& triangles) {
  try {
    const GmshSession session;
    gmsh::merge(file);
    gmsh::model::mesh::removeDuplicateNodes();
    std::vector<double> parametric;
    std::vector<std::size_t> elements;
    gmsh::model::mesh::getNodes(triangles.tags, triangles.coordinates, parametric);
    gmsh::model::mesh::getElementsByType(2, elements, triangles.nodes);
  } catch (const std::exception& error) {
    triangles.fault = std::string("Gmsh cannot read it: ") + error.what();
  } catch (...) {  // Gmsh throws numbers and texts as well
    triangles.fault = "Gmsh cannot read it";
  }
}

}  // namespace sprung::sph
