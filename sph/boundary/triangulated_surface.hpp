#pragma once
/// A closed surface of triangles, read by Gmsh: its nearest point, smooth normal and curvature.

#include "sph/vector.hpp"

#include <filesystem>
#include <memory>
#include <optional>

namespace sprung::sph {

class TriangulatedSurface {
 public:
  struct Nearest {
    Vector<3> point;
    Vector<3> normal;            ///< out of the closed surface, interpolated between the corners
    double curvature_sum = 0.0;  ///< 1/m, positive where normals diverge
    double curvature_product = 0.0;  ///< 1/m2
  };

  /// STL or a Gmsh mesh, in metres. Throws std::runtime_error that names the file when it cannot be
  /// read, holds no triangle, or is not closed.
  static TriangulatedSurface read(const std::filesystem::path& file);
  /// `corners` of each triangle by index, in either sense as long as all agree.
  TriangulatedSurface(std::vector<Vector<3>> points, std::vector<std::array<int, 3>> triangles);
  TriangulatedSurface(TriangulatedSurface&&) noexcept;
  ~TriangulatedSurface();

  /// Nothing when the surface is not closer than `reach` (m).
  std::optional<Nearest> nearest(const Vector<3>& x, double reach) const;
  /// Diagonal of the bounding box, m.
  double size() const { return size_; }
  /// One over the largest principal curvature of the triangles that lie in a box, m.
  double smallest_radius(const Vector<3>& low, const Vector<3>& high) const;
  std::size_t triangles() const { return triangles_.size(); }
  /// Centre of triangle `t` and its area times the outward normal, m and m2.
  std::pair<Vector<3>, Vector<3>> triangle(std::size_t t) const;
  /// Volume enclosed, m3.
  double volume() const;

 private:
  struct Tree;
  std::vector<Vector<3>> points_;
  std::vector<Vector<3>> normals_;  ///< at the points
  std::vector<std::array<int, 3>> triangles_;
  std::vector<std::array<double, 2>> curvature_;  ///< sum and product, of each triangle
  double size_ = 0.0;
  std::unique_ptr<Tree> tree_;
};

}  // namespace sprung::sph
