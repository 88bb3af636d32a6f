#pragma once
/// Gmsh keeps one global model; this opens it and closes it again whatever happens in between.

#include <gmsh.h>

namespace sprung {

class GmshSession {
 public:
  GmshSession() {
    gmsh::initialize();
    gmsh::option::setNumber("General.Terminal", 0);
  }
  ~GmshSession() { gmsh::finalize(); }
  GmshSession(const GmshSession&) = delete;
  GmshSession& operator=(const GmshSession&) = delete;
};

}  // namespace sprung
