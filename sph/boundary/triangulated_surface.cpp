#include "sph/boundary/triangulated_surface.hpp"

#include "sph/boundary/gmsh_triangles.hpp"
#include "sph/on_demand.hpp"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <unsupported/Eigen/BVH>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

namespace sprung::sph {

namespace {

/// Barycentric coordinates of the point of triangle abc nearest to x (Ericson, Real-Time Collision
/// Detection, section 5.1.5: by the Voronoi regions of corners, edges and face).
Vector<3> nearest_in_triangle(const Vector<3>& x, const Vector<3>& a, const Vector<3>& b,
                              const Vector<3>& c) {
  const Vector<3> ab = b - a, ac = c - a;
  const double d1 = ab.dot(x - a), d2 = ac.dot(x - a);
  if (d1 <= 0.0 && d2 <= 0.0) return {1, 0, 0};
  const double d3 = ab.dot(x - b), d4 = ac.dot(x - b);
  if (d3 >= 0.0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
  const double d5 = ab.dot(x - c), d6 = ac.dot(x - c);
  if (d6 >= 0.0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 >= d3 && d5 >= d6) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - w, w};
  }
  const double sum = va + vb + vc;
  return {va / sum, vb / sum, vc / sum};
}

}  // namespace

struct TriangulatedSurface::Tree {
  using Box3 = Eigen::AlignedBox3d;
  Eigen::KdBVH<double, 3, int> bvh;
  /// Nearest triangle to a place, for Eigen's branch and bound.
  struct Search {
    using Scalar = double;
    const TriangulatedSurface& surface;
    Vector<3> x;
    double reach2;  ///< what is not nearer does not count
    int triangle = -1;
    Vector<3> barycentric = Vector<3>::Zero();
    double best = std::numeric_limits<double>::infinity();
    /// Infinity makes the search pass a volume over.
    double minimumOnVolume(const Box3& box) const {
      const double d2 = box.squaredExteriorDistance(x);
      return d2 < reach2 ? d2 : std::numeric_limits<double>::infinity();
    }
    double minimumOnObject(int t) {
      const auto& [a, b, c] = surface.triangles_[t];
      const auto& p = surface.points_;
      const Vector<3> weights = nearest_in_triangle(x, p[a], p[b], p[c]);
      const double d2 =
          (x - (weights[0] * p[a] + weights[1] * p[b] + weights[2] * p[c])).squaredNorm();
      if (d2 < best && d2 < reach2) {
        best = d2;
        triangle = t;
        barycentric = weights;
      }
      return d2;
    }
  };
};

TriangulatedSurface::TriangulatedSurface(TriangulatedSurface&&) noexcept = default;
TriangulatedSurface::~TriangulatedSurface() = default;

TriangulatedSurface::TriangulatedSurface(std::vector<Vector<3>> points,
                                         std::vector<std::array<int, 3>> triangles)
    : points_(std::move(points)),
      triangles_(std::move(triangles)),
      tree_(std::make_unique<Tree>()) {
  if (volume() < 0.0)
    for (auto& t : triangles_) std::swap(t[1], t[2]);
  normals_.assign(points_.size(), Vector<3>::Zero());
  std::vector<Tree::Box3> boxes;
  Tree::Box3 all;
  for (const auto& t : triangles_) {
    Tree::Box3 box;
    for (int k = 0; k < 3; ++k) {
      const Vector<3>& at = points_[t[k]];
      const Vector<3> u = (points_[t[(k + 1) % 3]] - at).normalized();
      const Vector<3> v = (points_[t[(k + 2) % 3]] - at).normalized();
      // Weighted by the corner's angle, so that the cutting into triangles does not matter
      // (Baerentzen & Aanaes 2005).
      const double angle = std::acos(std::clamp(u.dot(v), -1.0, 1.0));
      normals_[t[k]] += angle * u.cross(v).normalized();
      box.extend(at);
    }
    all.extend(box);
    boxes.push_back(box);
  }
  for (auto& n : normals_) n.normalize();
  size_ = all.diagonal().norm();
  std::vector<int> numbers(triangles_.size());
  for (std::size_t t = 0; t < numbers.size(); ++t) numbers[t] = static_cast<int>(t);
  tree_->bvh.init(numbers.begin(), numbers.end(), boxes.begin(), boxes.end());

  for (const auto& t : triangles_) {
    const Vector<3> e1 = points_[t[1]] - points_[t[0]], e2 = points_[t[2]] - points_[t[0]];
    Eigen::Matrix<double, 3, 2> edges;
    edges << e1, e2;
    Eigen::Matrix<double, 3, 2> turn;
    turn << normals_[t[1]] - normals_[t[0]], normals_[t[2]] - normals_[t[0]];
    // The normal's derivative along the triangle (shape operator) in the basis of its edges.
    const Eigen::Matrix2d shape =
        (edges.transpose() * edges).ldlt().solve(edges.transpose() * turn);
    curvature_.push_back({shape.trace(), shape.determinant()});
  }
}

std::pair<Vector<3>, Vector<3>> TriangulatedSurface::triangle(std::size_t t) const {
  const auto& [a, b, c] = triangles_[t];
  const auto& p = points_;
  return {(p[a] + p[b] + p[c]) / 3.0, 0.5 * (p[b] - p[a]).cross(p[c] - p[a])};
}

double TriangulatedSurface::volume() const {
  double six = 0.0;
  for (const auto& [a, b, c] : triangles_) six += points_[a].dot(points_[b].cross(points_[c]));
  return six / 6.0;
}

double TriangulatedSurface::smallest_radius(const Vector<3>& low, const Vector<3>& high) const {
  double largest = 0.0;
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const Vector<3> x = triangle(t).first;
    if ((x.array() < low.array()).any() || (x.array() > high.array()).any()) continue;
    const double mean = 0.5 * curvature_[t][0];
    const double root = std::sqrt(std::max(0.0, mean * mean - curvature_[t][1]));
    largest = std::max(largest, std::abs(mean) + root);
  }
  return 1.0 / std::max(largest, 1e-300);
}

std::optional<TriangulatedSurface::Nearest> TriangulatedSurface::nearest(const Vector<3>& x,
                                                                         double reach) const {
  Tree::Search search{*this, x, reach * reach};
  Eigen::BVMinimize(tree_->bvh, search);
  if (search.triangle < 0) return std::nullopt;
  const auto& t = triangles_[search.triangle];
  Nearest near;
  near.point = near.normal = Vector<3>::Zero();
  for (int k = 0; k < 3; ++k) {
    near.point += search.barycentric[k] * points_[t[k]];
    near.normal += search.barycentric[k] * normals_[t[k]];
  }
  near.normal.normalize();
  near.curvature_sum = curvature_[search.triangle][0];
  near.curvature_product = curvature_[search.triangle][1];
  return near;
}

TriangulatedSurface TriangulatedSurface::read(const std::filesystem::path& file) {
  FileTriangles found;
  on_demand<decltype(read_gmsh_triangles)>("sprung-gmsh", "read_gmsh_triangles")(file.c_str(),
                                                                                 found);
  if (!found.fault.empty()) throw std::runtime_error(file.string() + ": " + found.fault);
  const auto& [tags, coordinates, nodes, fault] = found;
  if (nodes.empty()) throw std::runtime_error(file.string() + ": holds no triangle");
  std::map<std::size_t, int> index;
  std::vector<Vector<3>> points;
  std::vector<std::array<int, 3>> triangles(nodes.size() / 3);
  std::map<std::size_t, std::size_t> place;
  for (std::size_t k = 0; k < tags.size(); ++k) place[tags[k]] = k;
  std::map<std::pair<int, int>, int> edges;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const auto [at, is_new] = index.emplace(nodes[k], static_cast<int>(points.size()));
    if (is_new) points.emplace_back(&coordinates[3 * place.at(nodes[k])]);
    triangles[k / 3][k % 3] = at->second;
  }
  for (const auto& t : triangles)
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      edges[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  for (const auto& [edge, balance] : edges)
    if (balance != 0)
      throw std::runtime_error(
          file.string() +
          ": the surface is not closed, or its triangles do not all face the same "
          "way; close it and orient it (Gmsh: Mesh > Reverse)");
  return {std::move(points), std::move(triangles)};
}

}  // namespace sprung::sph
