#include "sph/effects/elastic_network.hpp"
#include "sph/effects/elastic_solid.hpp"

#include "tests/unit/sph/particle_blocks.hpp"

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include <numbers>

namespace sprung::sph {
namespace {

constexpr double dx = 0.02;
constexpr double k_e = 3.0e4;

template <int dim>
Particles<dim> block(const std::array<int, dim>& count) {
  return test::particles_at<dim>(test::lattice<dim>(count, dx), dx, Role::solid);
}

Numerics bonds_only(Bonds bonds) {
  Numerics numerics = test::preset("paper");
  numerics.bonds = bonds;
  return numerics;
}

template <int dim>
std::vector<Vector<dim>> disturbed(const Particles<dim>& particles, double amount) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> offset(-amount * dx, amount * dx);
  auto position = particles.position;
  for (auto& x : position)
    for (int d = 0; d < dim; ++d) x[d] += offset(generator);
  return position;
}

/// Forces against -dE/dx by central differences of 1e-6 dx.
template <int dim>
void expect_forces_from_energy(const ElasticNetwork<dim>& network,
                               std::vector<Vector<dim>> position) {
  std::vector<Vector<dim>> force;
  elastic_forces<dim>(network, position, force);
  double largest = 0.0;
  for (std::size_t i = 0; i < network.movable; ++i) largest = std::max(largest, force[i].norm());
  ASSERT_GT(largest, 0.0);
  const double e = 1e-6 * dx;
  for (std::size_t i = 0; i < network.movable; ++i)
    for (int d = 0; d < dim; ++d) {
      const double here = position[i][d];
      position[i][d] = here + e;
      const double after = elastic_energy<dim>(network, position);
      position[i][d] = here - e;
      const double before = elastic_energy<dim>(network, position);
      position[i][d] = here;
      // Round-off of the energy, some 1e-16 E/e, and e^2 of the difference: both below 1e-6 here.
      EXPECT_NEAR(force[i][d], -(after - before) / (2.0 * e), 1e-6 * largest) << i << ", " << d;
    }
}

TEST(ElasticNetwork, ForcesAreTheEnergysGradientInThePlane) {
  const auto particles = block<2>({4, 6});
  for (const bool clamped : {false, true}) {
    const std::optional<Side> side = clamped ? std::optional(Side::bottom) : std::nullopt;
    const auto network =
        test::network_of<2>(particles, {4, 6}, test::preset("recommended"), k_e, side);
    ASSERT_EQ(network.cells.size(), clamped ? 18u : 15u);
    expect_forces_from_energy<2>(network, disturbed(particles, 0.1));
    const auto printed = test::network_of<2>(particles, {4, 6}, test::preset("paper"), k_e, side);
    ASSERT_TRUE(printed.cells.empty());
    expect_forces_from_energy<2>(printed, disturbed(particles, 0.1));
  }
}

TEST(ElasticNetwork, ForcesAreTheEnergysGradientInSpace) {
  const auto particles = block<3>({3, 4, 3});
  for (const auto bonds : {Bonds::equal, Bonds::isotropic})
    expect_forces_from_energy<3>(
        test::network_of<3>(particles, {3, 4, 3}, bonds_only(bonds), k_e, Side::bottom),
        disturbed(particles, 0.1));
  const auto corrected =
      test::network_of<3>(particles, {3, 4, 3}, test::preset("recommended"), k_e, Side::bottom);
  ASSERT_EQ(corrected.cells.size(), 2u * 4 * 2);  // 3 layers between particles, one to the ghosts
  ASSERT_FALSE(corrected.ties.empty());
  expect_forces_from_energy<3>(corrected, disturbed(particles, 0.1));
}

// Fig. 2: 8 neighbours in the plane; 26 in space, 18 for the isotropic lattice (method.md section
// 1). A block of a x b (x c) has (a-1) b bonds along x, and so on; each pair once.
TEST(ElasticNetwork, BondsOfEachShell) {
  const auto plane = block<2>({5, 7});
  const auto network = test::network_of<2>(plane, {5, 7}, bonds_only(Bonds::equal), k_e);
  EXPECT_EQ(network.bonds.size(), 4u * 7 + 5u * 6 + 2u * 4 * 6);
  for (const Bond& bond : network.bonds) EXPECT_DOUBLE_EQ(bond.stiffness, k_e);

  const auto cube = block<3>({5, 5, 5});
  for (const auto bonds : {Bonds::equal, Bonds::isotropic}) {
    const auto springs = test::network_of<3>(cube, {5, 5, 5}, bonds_only(bonds), k_e);
    std::vector<int> degree(125, 0);
    for (const Bond& bond : springs.bonds) {
      ++degree[bond.a];
      ++degree[bond.b];
      EXPECT_DOUBLE_EQ(bond.stiffness, k_e * dx);  // Eq. 5
      EXPECT_LT(bond.rest_length, 1.8 * dx);
    }
    EXPECT_EQ(degree[62], bonds == Bonds::equal ? 26 : 18);  // the centre of the cube
  }
}

// method.md section 1, table of lattice constants; half the bonds' weight on the diagonals halves
// C44.
TEST(ElasticNetwork, ShearStiffnessAlongTheAxes) {
  EXPECT_NEAR(shear_stiffness<2>(k_e, Bonds::equal), k_e, 1e-9);
  EXPECT_NEAR(shear_stiffness<2>(k_e, Bonds::isotropic), 0.5 * k_e, 1e-9);
  EXPECT_NEAR(shear_stiffness<3>(k_e, Bonds::equal), 7.0 / 3.0 * k_e, 1e-9);
  EXPECT_NEAR(shear_stiffness<3>(k_e, Bonds::isotropic), k_e, 1e-9);
}

TEST(ElasticNetwork, GhostsStandOneRowBeyondTheClamp) {
  const auto particles = block<2>({4, 6});
  const auto network =
      test::network_of<2>(particles, {4, 6}, bonds_only(Bonds::equal), k_e, Side::bottom);
  ASSERT_EQ(network.movable, 24u);
  ASSERT_EQ(network.reference.size(), 28u);
  for (std::size_t g = 24; g < 28; ++g) EXPECT_NEAR(network.reference[g][1], -0.5 * dx, 1e-15);
  int to_ghosts = 0;
  for (const Bond& bond : network.bonds) {
    EXPECT_TRUE(bond.a < 24 || bond.b < 24);
    to_ghosts += bond.a >= 24 || bond.b >= 24;
  }
  EXPECT_EQ(to_ghosts, 4 + 2 * 3);  // straight and oblique
}

/// Energy of ten spacings in the middle of a plate of `layers` under `displacement`(x, y from the
/// middle): the difference of two plates, which leaves the ends out.
template <typename Displacement>
double energy_of_ten_spacings(int layers, const Numerics& numerics, Displacement displacement) {
  std::array<double, 2> energy{};
  for (const int k : {0, 1}) {
    const std::array<int, 2> count{k == 0 ? 16 : 26, layers};
    const auto particles = block<2>(count);
    const auto network = test::network_of<2>(particles, count, numerics, k_e);
    auto position = particles.position;
    for (auto& x : position)
      x += displacement(x[0] - 0.5 * count[0] * dx, x[1] - 0.5 * layers * dx);
    energy[k] = elastic_energy<2>(network, position);
  }
  return energy[1] - energy[0];
}

// Isochoric strains of the isotropic lattice: the bonds along the axes store (strain_xx -
// strain_yy)^2 k_e/4 per area, the diagonals strain_xy^2 k_e, in all 2 G strain:strain/2 with G =
// k_e/2. The surface correction makes the bonds a quadrature rule over the true body, so a plate
// has exactly the continuum's energy; without it bonds are missing at the faces (1/(2n) of those
// along x: half a row of n).
TEST(ElasticNetwork, SurfaceCorrectionStretchesAndShearsAPlateAsTheContinuum) {
  Numerics numerics = test::preset("recommended");
  numerics.area_stiffness = 0.0;
  const double small = 1e-6;
  for (const int layers : {2, 3, 4, 6})
    for (const auto& [xx, xy] : {std::pair{1.0, 0.0}, {0.0, 1.0}, {1.0, 0.5}}) {
      const auto strain = [&](double x, double y) {
        return Vector<2>(small * (xx * x + xy * y), small * (xy * x - xx * y));
      };
      const double continuum = k_e * small * small * (xx * xx + xy * xy) * layers * 10 * dx * dx;
      numerics.surface_correction = true;
      // Strains of 1e-6 leave terms of relative size 1e-6; the weights meet their sum to better
      // than 1e-6.
      EXPECT_NEAR(energy_of_ten_spacings(layers, numerics, strain) / continuum, 1.0, 1e-5)
          << layers << " layers " << xx << ' ' << xy;
      numerics.surface_correction = false;
      EXPECT_LT(energy_of_ten_spacings(layers, numerics, strain) / continuum, 0.95);
    }
}

// Pure bending with the section free to narrow, u = -c x y, v = c (x^2 + y^2)/2: strain_xx = -c y,
// strain_yy = c y, no shear, so that the bonds along the axes alone store energy, k_e c^2 y^2 per
// area.
TEST(ElasticNetwork, SurfaceCorrectionBendsAPlateAsTheContinuum) {
  Numerics numerics = test::preset("recommended");
  numerics.area_stiffness = 0.0;
  const double c = 1e-7 / dx;
  for (const int layers : {2, 3, 4, 6}) {
    const auto bending = [&](double x, double y) {
      return Vector<2>(-c * x * y, 0.5 * c * (x * x + y * y));
    };
    const double continuum = k_e * c * c * std::pow(layers * dx, 3) / 12.0 * 10 * dx;
    // "exactly the continuum's": the least-squares weights meet the second moments to about 1e-3.
    EXPECT_NEAR(energy_of_ten_spacings(layers, numerics, bending) / continuum, 1.0, 5e-3)
        << layers << " layers";
  }
}

/// Energy of 4 x 4 cells in the middle of a plate in space of `layers` under `displacement` (x, y
/// in the plate, z from its middle): the second difference of plates leaves sides and corners out.
template <typename Displacement>
double energy_of_sixteen_columns(int layers, Displacement displacement) {
  const Numerics numerics = test::preset("recommended");
  double energy = 0.0;
  for (const int i : {0, 4})
    for (const int j : {0, 4}) {
      const std::array<int, 3> count{6 + i, 6 + j, layers};
      const auto particles = block<3>(count);
      auto network = test::network_of<3>(particles, count, numerics, k_e);
      network.cells.clear();
      auto position = particles.position;
      for (auto& x : position)
        x += displacement(x - 0.5 * dx * Vector<3>(count[0], count[1], count[2]));
      energy += (i == j ? 1.0 : -1.0) * elastic_energy<3>(network, position);
    }
  return energy;
}

// Isochoric fields of a plate with free faces, z across; G = k_e, energy G strain:strain per
// volume.
TEST(ElasticNetwork, SurfaceCorrectionInSpaceStretchesBendsAndTwistsAPlateAsTheContinuum) {
  const double c = 1e-6;  // strains of 1e-6 leave terms of relative size 1e-6
  for (const int layers : {2, 3, 5}) {
    const double h = layers * dx, area = 16 * dx * dx;
    const auto expect = [&](const char* field, double per_area, auto displacement) {
      EXPECT_NEAR(energy_of_sixteen_columns(layers, displacement) / (k_e * per_area * area), 1.0,
                  1e-5)
          << field << ", " << layers << " layers";
    };
    // strain diag(1, -1/2, -1/2): 3/2
    expect("stretched", 1.5 * c * c * h, [&](const Vector<3>& x) -> Vector<3> {
      return c * Vector<3>(x[0], -0.5 * x[1], -0.5 * x[2]);
    });
    expect("sheared in its plane", 2.0 * c * c * h,
           [&](const Vector<3>& x) -> Vector<3> { return c * Vector<3>(x[1], x[0], 0.0); });
    expect("sheared across", 2.0 * c * c * h,
           [&](const Vector<3>& x) -> Vector<3> { return c * Vector<3>(x[2], 0.0, x[0]); });
    const double k = c / dx, third = h * h * h / 12.0;
    // cylinder: strain k z diag(-1, 0, 1)
    expect("bent to a cylinder", 2.0 * k * k * third, [&](const Vector<3>& x) -> Vector<3> {
      return k * Vector<3>(-x[0] * x[2], 0.0, 0.5 * (x[0] * x[0] + x[2] * x[2]));
    });
    // bar: strain k z diag(-1, 1/2, 1/2)
    expect("bent as a bar", 1.5 * k * k * third, [&](const Vector<3>& x) -> Vector<3> {
      return k * Vector<3>(-x[0] * x[2], 0.5 * x[1] * x[2],
                           0.5 * x[0] * x[0] + 0.25 * (x[2] * x[2] - x[1] * x[1]));
    });
    // dome: strain k z diag(-1, -1, 2)
    expect("bent to a dome", 6.0 * k * k * third, [&](const Vector<3>& x) -> Vector<3> {
      return k *
             Vector<3>(-x[0] * x[2], -x[1] * x[2], 0.5 * (x[0] * x[0] + x[1] * x[1]) + x[2] * x[2]);
    });
    // twist: strain_xy = -k z
    expect("twisted", 2.0 * k * k * third, [&](const Vector<3>& x) -> Vector<3> {
      return k * Vector<3>(-x[1] * x[2], -x[0] * x[2], x[0] * x[1]);
    });
  }
}

// A zero eigenvalue for each rigid motion and for nothing else: no motion of the surface has lost
// its stiffness to the line through its strains.
template <int dim>
void expect_only_rigid_motions_free(const std::array<int, dim>& count) {
  const auto particles = block<dim>(count);
  const auto network = test::network_of<dim>(particles, count, test::preset("recommended"), k_e);
  const auto n = static_cast<Eigen::Index>(particles.size()) * dim;
  Eigen::MatrixXd stiffness(n, n);
  const double e = 1e-6 * dx;
  for (Eigen::Index j = 0; j < n; ++j) {
    auto position = particles.position;
    std::vector<Vector<dim>> after, before;
    position[j / dim][j % dim] += e;
    elastic_forces<dim>(network, position, after);
    position[j / dim][j % dim] -= 2.0 * e;
    elastic_forces<dim>(network, position, before);
    for (Eigen::Index i = 0; i < n; ++i)
      stiffness(i, j) = -(after[i / dim][i % dim] - before[i / dim][i % dim]) / (2.0 * e);
  }
  const Eigen::VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(0.5 * (stiffness + stiffness.transpose()))
          .eigenvalues() /
      (k_e * std::pow(dx, dim - 2));
  const Eigen::Index rigid = dim == 2 ? 3 : 6;
  // Differences of forces of 300 k_e leave 1e-7 or so; the softest bending of 6 rows is some 1e-2.
  EXPECT_LT(eigenvalues[rigid - 1], 1e-5);
  EXPECT_GT(eigenvalues[rigid], 1e-3);
}

TEST(ElasticNetwork, SurfaceCorrectionLeavesOnlyRigidMotionsFree) {
  expect_only_rigid_motions_free<2>({2, 6});
  expect_only_rigid_motions_free<2>({5, 6});
  expect_only_rigid_motions_free<3>({2, 4, 4});
  expect_only_rigid_motions_free<3>({4, 4, 4});
}

template <int dim>
void expect_no_force(const ElasticNetwork<dim>& network,
                     const Eigen::Matrix<double, dim, dim>& rotation, const Vector<dim>& shift) {
  std::vector<Vector<dim>> position;
  for (const auto& x : network.reference) position.push_back(rotation * x + shift);
  std::vector<Vector<dim>> force;
  elastic_forces<dim>(network, position, force);
  // Round-off of a length, 1e-16 x |shift|, times the stiffness, 300 k_e for the cells.
  for (const auto& f : force) EXPECT_NEAR(f.norm(), 0.0, 1e-10 * k_e * dx);
  EXPECT_NEAR(elastic_energy<dim>(network, position), 0.0, 1e-20 * k_e);
}

TEST(ElasticNetwork, RigidMotionGivesNoForce) {
  const auto plane = block<2>({4, 5});
  const Eigen::Rotation2Dd turn(0.7);
  expect_no_force<2>(test::network_of<2>(plane, {4, 5}, test::preset("recommended"), k_e),
                     turn.toRotationMatrix(), {0.3, -0.2});
  const auto cube = block<3>({3, 4, 3});
  const Eigen::AngleAxisd spin(1.1, Vector<3>(1.0, 2.0, -0.5).normalized());
  expect_no_force<3>(test::network_of<3>(cube, {3, 4, 3}, bonds_only(Bonds::equal), k_e),
                     spin.toRotationMatrix(), {0.3, -0.2, 0.1});
}

TEST(ElasticNetwork, InternalForcesHaveNeitherSumNorMoment) {
  const auto particles = block<2>({5, 6});
  const auto network = test::network_of<2>(particles, {5, 6}, test::preset("recommended"), k_e);
  const auto position = disturbed(particles, 0.15);
  std::vector<Vector<2>> force;
  elastic_forces<2>(network, position, force);
  Vector<2> sum = Vector<2>::Zero();
  double moment = 0.0, size = 0.0;
  for (std::size_t i = 0; i < position.size(); ++i) {
    sum += force[i];
    moment += position[i][0] * force[i][1] - position[i][1] * force[i][0];
    size += force[i].norm();
  }
  EXPECT_NEAR(sum.norm(), 0.0, 1e-13 * size);
  EXPECT_NEAR(moment, 0.0, 1e-13 * size * 6 * dx);
}

TEST(ElasticNetwork, QuadrilateralAreaAndItsGradient) {
  std::array<Vector<2>, 4> corner{Vector<2>(0, 0), Vector<2>(2, 0.5), Vector<2>(1.8, 1.5),
                                  Vector<2>(-0.3, 1.2)};
  std::array<Vector<2>, 4> gradient, unused;
  // Two triangles: 1/2 |(x1-x0) x (x2-x0)| + 1/2 |(x2-x0) x (x3-x0)| = 1/2 (2.1) + 1/2 (2.61).
  EXPECT_NEAR(cell_volume(corner, gradient), 2.355, 1e-14);
  for (int c = 0; c < 4; ++c)
    for (int d = 0; d < 2; ++d) {
      auto moved = corner;
      moved[c][d] += 0.5;
      const double more = cell_volume(moved, unused);
      moved[c][d] -= 1.0;
      // Bilinear: the central difference is exact for any step.
      EXPECT_NEAR(gradient[c][d], more - cell_volume(moved, unused), 1e-14);
    }
}

TEST(ElasticNetwork, HexahedronVolumeAndItsGradient) {
  std::array<Vector<3>, 8> corner{Vector<3>(0, 0, 0), Vector<3>(1, 0, 0), Vector<3>(1, 1, 0),
                                  Vector<3>(0, 1, 0), Vector<3>(0, 0, 2), Vector<3>(1, 0, 2),
                                  Vector<3>(1, 1, 2), Vector<3>(0, 1, 2)};
  std::array<Vector<3>, 8> gradient, unused;
  // A linear map multiplies the box's 2 by its determinant, 1.2.
  Eigen::Matrix3d map;
  map << 1.0, 0.2, 0.0, 0.0, 1.2, 0.5, 0.0, 0.0, 1.0;
  for (auto& x : corner) x = (map * x).eval() + Vector<3>(0.3, -7.0, 2.0);
  EXPECT_NEAR(cell_volume(corner, gradient), 2.4, 1e-13);
  // A box whose top is 1 + x y high: 1 + 1/4.
  std::array<Vector<3>, 8> hill{Vector<3>(0, 0, 0), Vector<3>(1, 0, 0), Vector<3>(1, 1, 0),
                                Vector<3>(0, 1, 0), Vector<3>(0, 0, 1), Vector<3>(1, 0, 1),
                                Vector<3>(1, 1, 2), Vector<3>(0, 1, 1)};
  EXPECT_NEAR(cell_volume(hill, gradient), 1.25, 1e-14);
  for (int c = 0; c < 8; ++c)
    for (int d = 0; d < 3; ++d) {
      auto moved = hill;
      moved[c][d] += 0.5;
      const double more = cell_volume(moved, unused);
      moved[c][d] -= 1.0;
      // Linear in each coordinate: the central difference is exact for any step.
      EXPECT_NEAR(gradient[c][d], more - cell_volume(moved, unused), 1e-14);
    }
}

TEST(ElasticNetwork, StretchRangeFindsTheExtremes) {
  const auto particles = block<2>({3, 3});
  const auto network = test::network_of<2>(particles, {3, 3}, bonds_only(Bonds::equal), k_e);
  auto position = particles.position;
  for (auto& x : position) x = {1.25 * x[0], 0.8 * x[1]};
  const auto [least, most] = stretch_range<2>(network, position);
  EXPECT_NEAR(least, 0.8, 1e-12);
  EXPECT_NEAR(most, 1.25, 1e-12);
}

TEST(ElasticNetwork, RefusesASingleParticle) {
  const auto particles = block<2>({1, 1});
  EXPECT_THROW(test::network_of<2>(particles, {1, 1}, bonds_only(Bonds::equal), k_e),
               std::invalid_argument);
}

// Highest lattice frequency, at the wave vector (pi/dx, 0[, 0]), from bonds k (e . e_x)^2 4
// sin^2(..):
//   plane, equal:      4 (1 + 1/2 + 1/2) k_e = 8       -> 2/omega = 0.7071 dx sqrt(rho/k_e)
//   space, equal:      4 (1 + 4/2 + 4/3) k_e = 52/3    -> omega = 4.163 sqrt(k_e/rho)/dx
//   space, isotropic:  4 (1 + 4/2) k_e = 12            -> omega = 3.464 sqrt(k_e/rho)/dx
//   plane, isotropic with area springs: 4 (3 + kappa) G, G = k_e/2 (method.md section 1)
// A free block of n layers lies below it by about (pi/2n)^2/2: its highest mode has room for half a
// wave less. Lanczos' method, too, comes from below.
double unit(const Particles<2>& p) {
  return std::sqrt(k_e / p.density) / dx;
}
double unit(const Particles<3>& p) {
  return std::sqrt(k_e / p.density) / dx;
}

TEST(HighestFrequency, OfTheLatticesInThePlane) {
  const auto particles = block<2>({30, 30});
  const auto printed = test::network_of<2>(particles, {30, 30}, bonds_only(Bonds::equal), k_e);
  const double omega = highest_frequency(printed, particles.density) / unit(particles);
  EXPECT_LT(omega, std::sqrt(8.0) * (1.0 + 1e-12));
  EXPECT_GT(omega, 0.99 * std::sqrt(8.0));
  EXPECT_NEAR(2.0 / omega, 0.7071, 0.01);

  Numerics numerics = bonds_only(Bonds::isotropic);
  numerics.area_stiffness = 30.0;
  const auto cells = test::network_of<2>(particles, {30, 30}, numerics, k_e);
  const double with_cells = highest_frequency(cells, particles.density) / unit(particles);
  const double expected = std::sqrt(4.0 * (3.0 + 30.0) / 2.0);
  EXPECT_LT(with_cells, expected * (1.0 + 1e-12));
  EXPECT_GT(with_cells, 0.985 * expected);
}

TEST(HighestFrequency, OfTheLatticesInSpace) {
  const auto particles = block<3>({14, 14, 14});
  for (const auto& [bonds, expected] :
       {std::pair{Bonds::equal, std::sqrt(52.0 / 3.0)}, {Bonds::isotropic, std::sqrt(12.0)}}) {
    const auto network = test::network_of<3>(particles, {14, 14, 14}, bonds_only(bonds), k_e);
    const double omega = highest_frequency(network, particles.density) / unit(particles);
    EXPECT_LT(omega, expected * (1.0 + 1e-12));
    EXPECT_GT(omega, 0.98 * expected);
  }
  EXPECT_NEAR(std::sqrt(52.0 / 3.0), 4.163, 5e-4);  // method.md
}

TEST(HighestFrequency, IsTheEigenvalueOfASmallClampedBlock) {
  // Against the dense eigenvalues of a stiffness matrix made from differences of the forces.
  const auto particles = block<2>({3, 4});
  const auto network =
      test::network_of<2>(particles, {3, 4}, test::preset("recommended"), k_e, Side::bottom);
  const double e = 1e-6 * dx;
  Eigen::MatrixXd stiffness(24, 24);
  for (int j = 0; j < 24; ++j) {
    auto position = particles.position;
    std::vector<Vector<2>> after, before;
    position[j / 2][j % 2] += e;
    elastic_forces<2>(network, position, after);
    position[j / 2][j % 2] -= 2.0 * e;
    elastic_forces<2>(network, position, before);
    for (int i = 0; i < 24; ++i)
      stiffness(i, j) = -(after[i / 2][i % 2] - before[i / 2][i % 2]) / (2.0 * e);
  }
  const Eigen::MatrixXd symmetric = 0.5 * (stiffness + stiffness.transpose());
  const double largest =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric).eigenvalues().maxCoeff();
  EXPECT_NEAR(highest_frequency(network, particles.density) / std::sqrt(largest / particles.mass()),
              1.0, 1e-4);
}

}  // namespace
}  // namespace sprung::sph
