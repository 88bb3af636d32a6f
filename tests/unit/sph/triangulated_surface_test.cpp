/// Triangulated surfaces: an octahedron by hand, spheres and a cylinder meshed by Gmsh and written
/// as STL and as Gmsh's own format.

#include "sph/boundary/triangulated_surface.hpp"

#include "sph/boundary/wall_shape.hpp"
#include "tests/unit/scene/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <gmsh.h>

namespace sprung::sph {
namespace {

using sprung::test::error_of;
using sprung::test::TemporaryFolder;

constexpr double pi = std::numbers::pi;
constexpr double far = std::numeric_limits<double>::infinity();

/// A model that `build` makes, its surface meshed with triangles of about `size`, written to
/// `file`.
template <typename Build>
void write_surface(const std::filesystem::path& file, double size, Build&& build) {
  gmsh::initialize();
  gmsh::option::setNumber("General.Terminal", 0);
  gmsh::option::setNumber("Mesh.MeshSizeMin", size);
  gmsh::option::setNumber("Mesh.MeshSizeMax", size);
  gmsh::model::add("surface");
  build();
  gmsh::model::occ::synchronize();
  gmsh::model::mesh::generate(2);
  gmsh::write(file.string());
  gmsh::finalize();
}

const Vector<3> centre(0.5, -1.0, 2.0);

void write_sphere(const std::filesystem::path& file, double size) {
  write_surface(file, size, [] { gmsh::model::occ::addSphere(0.5, -1.0, 2.0, 1.0); });
}

TriangulatedSurface octahedron(bool reversed) {
  const std::vector<Vector<3>> points{{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                      {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
  std::vector<std::array<int, 3>> triangles;
  for (const int z : {4, 5})
    for (const auto& [a, b] : {std::pair{0, 2}, {2, 1}, {1, 3}, {3, 0}})
      triangles.push_back((z == 4) != reversed ? std::array{a, b, z} : std::array{b, a, z});
  return {points, triangles};
}

// |x| + |y| + |z| = 1: volume 4/3, the planes 1/sqrt(3) from the centre.
TEST(TriangulatedSurface, Octahedron) {
  for (const bool reversed : {false, true}) {
    const auto surface = octahedron(reversed);
    EXPECT_EQ(surface.triangles(), 8u);
    EXPECT_NEAR(surface.volume(), 4.0 / 3.0, 1e-15);
    EXPECT_NEAR(surface.size(), std::sqrt(12.0), 1e-15);
    const Vector<3> diagonal = Vector<3>(1, -1, 1).normalized();
    auto near = surface.nearest(3.0 * diagonal, far).value();
    EXPECT_NEAR((near.point - diagonal / std::sqrt(3.0)).norm(), 0.0, 1e-15);
    EXPECT_NEAR((near.normal - diagonal).norm(), 0.0, 1e-15);
    near = surface.nearest({0.1, 0.01, -7.0}, far).value();  // off the lower corner
    EXPECT_NEAR((near.point - Vector<3>(0, 0, -1)).norm(), 0.0, 1e-15);
    EXPECT_NEAR((near.normal - Vector<3>(0, 0, -1)).norm(), 0.0, 1e-15);
    near = surface.nearest({2.0, 2.0, 0.0}, far).value();  // off the middle of an edge
    EXPECT_NEAR((near.point - Vector<3>(0.5, 0.5, 0)).norm(), 0.0, 1e-15);
    EXPECT_NEAR((near.normal - Vector<3>(1, 1, 0).normalized()).norm(), 0.0, 1e-15);
    Vector<3> sum = Vector<3>::Zero();
    double area = 0.0;
    for (std::size_t t = 0; t < surface.triangles(); ++t) {
      const auto [middle, vector] = surface.triangle(t);
      EXPECT_GT(middle.dot(vector), 0.0);  // outwards
      sum += vector;
      area += vector.norm();
    }
    EXPECT_NEAR(sum.norm(), 0.0, 1e-15);
    EXPECT_NEAR(area, 8.0 * std::sqrt(3.0) / 2.0, 1e-14);
  }
}

TEST(TriangulatedSurface, NothingIsNearerThanTheReach) {
  const auto surface = octahedron(false);
  const Vector<3> x(0.0, 0.0, 1.25);
  EXPECT_FALSE(surface.nearest(x, 0.2));
  ASSERT_TRUE(surface.nearest(x, 0.3));
  EXPECT_NEAR((surface.nearest(x, 0.3)->point - Vector<3>(0, 0, 1)).norm(), 0.0, 1e-15);
  EXPECT_FALSE(surface.nearest(Vector<3>::Zero(), 0.57));  // 1/sqrt(3) = 0.577 from all faces
  EXPECT_TRUE(surface.nearest(Vector<3>::Zero(), 0.58));
}

/// Largest errors over places up to 0.3 on either side of the unit sphere.
struct SphereErrors {
  double volume, distance, normal, curvature_sum, curvature_product;
};

SphereErrors sphere_errors(const TriangulatedSurface& surface) {
  SphereErrors errors{std::abs(surface.volume() - 4.0 / 3.0 * pi), 0, 0, 0, 0};
  std::mt19937 generator(5);
  std::normal_distribution<double> draw;
  std::uniform_real_distribution<double> radius(0.7, 1.3);
  double sum = 0.0, product = 0.0;
  constexpr int places = 400;
  for (int k = 0; k < places; ++k) {
    const Vector<3> outward =
        Vector<3>(draw(generator), draw(generator), draw(generator)).normalized();
    const double r = radius(generator);
    const auto near = surface.nearest(centre + r * outward, far).value();
    const double distance = (centre + r * outward - near.point).norm();
    errors.distance = std::max(errors.distance, std::abs(distance - std::abs(r - 1.0)));
    errors.normal = std::max(errors.normal, (near.normal - outward).norm());
    sum += near.curvature_sum / places;
    product += near.curvature_product / places;
  }
  errors.curvature_sum = std::abs(sum - 2.0);
  errors.curvature_product = std::abs(product - 1.0);
  return errors;
}

// Chords lie inside the sphere by at most the sagitta c^2/2 of the triangles' circumradius c, which
// for equilateral ones of side s is s/sqrt(3): s^2/6, and volume and area lack parts of that order.
TEST(TriangulatedSurface, SphereConvergesAtSecondOrder) {
  const TemporaryFolder folder;
  std::array<SphereErrors, 2> errors;
  for (const int k : {0, 1}) {
    const double size = k == 0 ? 0.2 : 0.1;
    const auto file = folder.path() / ("sphere" + std::to_string(k) + ".stl");
    write_sphere(file, size);
    const auto surface = TriangulatedSurface::read(file);
    errors[k] = sphere_errors(surface);
    // Gmsh's worst triangles: circumradius up to twice that of an equilateral one.
    EXPECT_LT(errors[k].distance, 2.0 * 2.0 * size * size / 6.0);
    // That of the worst triangle, never above the sphere's; where there is none it is flat.
    const Vector<3> all = Vector<3>::Constant(1.5);
    EXPECT_LT(surface.smallest_radius(centre - all, centre + all), 1.05);
    EXPECT_GT(surface.smallest_radius(centre - 0.2 * all, centre + 0.2 * all), 1e100);
  }
  EXPECT_NEAR(std::log2(errors[0].volume / errors[1].volume), 2.0, 0.15);
  EXPECT_LT(errors[1].volume, 0.02);
  EXPECT_LT(errors[1].normal, 0.03);
  EXPECT_LT(errors[1].normal, 0.7 * errors[0].normal);
  EXPECT_LT(errors[1].curvature_sum, 0.02 * 2.0);
  EXPECT_LT(errors[1].curvature_product, 0.04);
}

TEST(TriangulatedSurface, GmshsFormatAndBothSTLsGiveTheSameSurface) {
  const TemporaryFolder folder;
  std::vector<double> volume;
  std::vector<std::size_t> triangles;
  for (const std::string name : {"s.msh", "s.stl", "b.stl"}) {
    const auto file = folder.path() / name;
    write_surface(file, 0.2, [&] {
      gmsh::option::setNumber("Mesh.Binary", name == "b.stl");
      gmsh::model::occ::addSphere(0.5, -1.0, 2.0, 1.0);
    });
    const auto surface = TriangulatedSurface::read(file);
    volume.push_back(surface.volume());
    triangles.push_back(surface.triangles());
  }
  EXPECT_EQ(triangles[0], triangles[1]);
  EXPECT_EQ(triangles[0], triangles[2]);
  // STL holds single precision or as many digits.
  EXPECT_NEAR(volume[0], volume[1], 1e-5);
  EXPECT_NEAR(volume[0], volume[2], 1e-5);
}

TEST(TriangulatedSurface, CylinderHasOneCurvature) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "cylinder.msh";
  const double radius = 0.5, length = 2.0, size = 0.08;
  write_surface(file, size, [&] { gmsh::model::occ::addCylinder(0, 0, 0, 0, 0, length, radius); });
  const auto surface = TriangulatedSurface::read(file);
  const double sagitta = size * size / 6.0 / radius;
  // The chords take about 2/3 of the sagitta from the radius on average, at most all of it.
  EXPECT_LT(surface.volume(), pi * radius * radius * length);
  EXPECT_GT(surface.volume(), pi * std::pow(radius - sagitta, 2) * length);
  double sum = 0.0, product = 0.0;
  constexpr int places = 200;
  for (int k = 0; k < places; ++k) {
    // Far from the caps, whose edges the normals blend across.
    const double angle = 2.0 * pi * k / places, z = 0.7 + 0.6 * k / places;
    const Vector<3> outward(std::cos(angle), std::sin(angle), 0.0);
    const double r = k % 2 ? 0.4 : 0.65;
    const auto near = surface.nearest(r * outward + z * Vector<3>::UnitZ(), far).value();
    EXPECT_NEAR((near.normal - outward).norm(), 0.0, 0.05);
    EXPECT_NEAR((r * outward + z * Vector<3>::UnitZ() - near.point).norm(), std::abs(r - radius),
                2.0 * sagitta);
    sum += near.curvature_sum / places;
    product += near.curvature_product / places;
  }
  EXPECT_NEAR(sum, 1.0 / radius, 0.03 / radius);
  EXPECT_NEAR(product, 0.0, 0.03 / (radius * radius));
}

TEST(TriangulatedSurface, IsAWallFromEitherSide) {
  const TemporaryFolder folder;
  CurvedWall wall;
  wall.shape = CurvedWall::Shape::surface;
  wall.file = folder.path() / "sphere.stl";
  write_sphere(wall.file, 0.1);
  for (const bool inside : {true, false}) {
    wall.fluid_inside = inside;
    const auto shape = wall_shape<3>(wall);
    const double sign = inside ? -1.0 : 1.0;
    for (const double r : {0.8, 1.2}) {
      const Vector<3> outward = Vector<3>(1, 2, -2) / 3.0;
      const auto view = shape->view(centre + r * outward);
      EXPECT_NEAR(view.distance, sign * (r - 1.0), 0.003);
      EXPECT_NEAR((view.normal - sign * outward).norm(), 0.0, 0.05);
      EXPECT_NEAR(view.curvature_sum, sign * 2.0, 0.2);
      EXPECT_NEAR(view.curvature_product, 1.0, 0.2);
      EXPECT_NEAR(view.distance * view.normal.dot(outward), r - 1.0, 0.003);
    }
    double area = 0.0, flux = 0.0;
    for (const auto& patch : shape->patches(1.0)) {
      area += patch.area;
      flux += patch.area * patch.normal.dot(patch.centre);
    }
    EXPECT_NEAR(area, 4.0 * pi, 0.05);
    EXPECT_NEAR(flux, sign * 3.0 * 4.0 / 3.0 * pi, 0.05);  // Gauss: div x = 3
  }
}

// --- refusals
// ---------------------------------------------------------------------------------------

void expect_refusal(const std::filesystem::path& file, const std::string& says) {
  const auto message = error_of([&] { TriangulatedSurface::read(file); });
  EXPECT_TRUE(message.starts_with(file.string() + ": ")) << message;
  EXPECT_NE(message.find(says), std::string::npos) << message;
}

TEST(TriangulatedSurface, RefusesAnOpenSurface) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "open.stl";
  write_surface(file, 0.3, [] { gmsh::model::occ::addDisk(0, 0, 0, 1, 1); });
  expect_refusal(file, "not closed");
}

TEST(TriangulatedSurface, RefusesTrianglesThatFaceBothWays) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "mixed.stl";
  std::ofstream out(file);
  const std::array<std::array<int, 3>, 4> corners{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  // A tetrahedron whose last face is turned round.
  const std::array<std::array<int, 3>, 4> faces{{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 3, 2}}};
  out << "solid t\n";
  for (const auto& face : faces) {
    out << "facet normal 0 0 0\nouter loop\n";
    for (const int k : face)
      out << "vertex " << corners[k][0] << ' ' << corners[k][1] << ' ' << corners[k][2] << '\n';
    out << "endloop\nendfacet\n";
  }
  out << "endsolid t\n";
  out.close();
  expect_refusal(file, "face the same way");
}

TEST(TriangulatedSurface, RefusesFilesThatHoldNone) {
  const TemporaryFolder folder;
  expect_refusal(folder.path() / "nowhere.stl", "Gmsh cannot read it");
  const auto line = folder.path() / "line.msh";
  write_surface(line, 0.3, [] {
    const int a = gmsh::model::occ::addPoint(0, 0, 0), b = gmsh::model::occ::addPoint(1, 0, 0);
    gmsh::model::occ::addLine(a, b);
  });
  expect_refusal(line, "holds no triangle");
  const auto words = folder.path() / "words.stl";
  std::ofstream(words) << "these are words\n";
  EXPECT_NE(error_of([&] { TriangulatedSurface::read(words); }), "");
}

TEST(TriangulatedSurface, TheNextFileStartsAnew) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "sphere.stl";
  write_sphere(file, 0.3);
  const auto once = TriangulatedSurface::read(file);
  error_of([&] { TriangulatedSurface::read(folder.path() / "nowhere.stl"); });
  EXPECT_EQ(TriangulatedSurface::read(file).triangles(), once.triangles());
}

}  // namespace
}  // namespace sprung::sph
