#include "reference_fem/fluid_structure.hpp"

#include <deal.II/base/parallel.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace sprung::reference {

InvertedCell::InvertedCell(double x, double y, bool solid)
    : std::runtime_error(std::string(solid ? "a cell of a body" : "a cell of the fluid's mesh") +
                         " turned inside out near x = " + std::to_string(x) +
                         " m, y = " + std::to_string(y) + " m") {}

/// What one cell contributes. Everything is a small array of known size, so the compiler unrolls
/// it.
template <int degree>
struct FluidStructure::Kernel {
  static constexpr int na = (degree + 1) * (degree + 1);
  static constexpr int nq = na;
  static constexpr int np = degree * (degree + 1) / 2;
  static constexpr int nl = 2 * na;  ///< velocity unknowns of a cell, interleaved

  /// A fluid cell squeezed further than this answers with garbage before it turns inside out.
  static constexpr double least_volume_ratio = 0.02;

  const FluidStructure& system;
  const Fields& fields;
  const StageWeights& weights;
  Vec2 gravity{};  ///< m/s2

  struct Local {
    double vx[na], vy[na], ux[na], uy[na], gx[na], gy[na], ax[na], ay[na], p[np];
  };
  struct Point {
    double n[na], bx[na], by[na];  ///< values and undeformed gradients, copied for alignment
    double f[4], j, v[2], g[2], a[2], grad_v[4], p;
  };

  void gather(int cell, Local& l) const {
    const int* nodes = system.space_.cell_nodes(cell);
    for (int i = 0; i < na; ++i) {
      const auto n = 2 * static_cast<std::size_t>(nodes[i]);
      l.vx[i] = fields.velocity[n], l.vy[i] = fields.velocity[n + 1];
      l.ux[i] = fields.displacement[n], l.uy[i] = fields.displacement[n + 1];
      l.gx[i] = fields.mesh_velocity[n], l.gy[i] = fields.mesh_velocity[n + 1];
      l.ax[i] = fields.acceleration[n], l.ay[i] = fields.acceleration[n + 1];
    }
    for (int m = 0; m < np; ++m)
      l.p[m] = fields.pressure[static_cast<std::size_t>(cell) * np + static_cast<std::size_t>(m)];
  }

  /// Interpolates to quadrature point q. grad_v is d v_i / d X_K, row by row.
  void at_point(int cell, int q, const Local& l, Point& s) const {
    const double* n = system.space_.value(q);
    const double* bx = system.space_.grad_x(cell) + q * na;
    const double* by = system.space_.grad_y(cell) + q * na;
    const double* psi = system.space_.pressure_value(cell) + q * np;
    double f00 = 1, f01 = 0, f10 = 0, f11 = 1, v0 = 0, v1 = 0, g0 = 0, g1 = 0, a0 = 0, a1 = 0;
    double l00 = 0, l01 = 0, l10 = 0, l11 = 0;
    for (int i = 0; i < na; ++i) {
      s.n[i] = n[i], s.bx[i] = bx[i], s.by[i] = by[i];
      f00 += bx[i] * l.ux[i], f01 += by[i] * l.ux[i], f10 += bx[i] * l.uy[i],
          f11 += by[i] * l.uy[i];
      l00 += bx[i] * l.vx[i], l01 += by[i] * l.vx[i], l10 += bx[i] * l.vy[i],
          l11 += by[i] * l.vy[i];
      v0 += n[i] * l.vx[i], v1 += n[i] * l.vy[i], g0 += n[i] * l.gx[i], g1 += n[i] * l.gy[i];
      a0 += n[i] * l.ax[i], a1 += n[i] * l.ay[i];
    }
    s.f[0] = f00, s.f[1] = f01, s.f[2] = f10, s.f[3] = f11;
    s.j = f00 * f11 - f01 * f10;
    s.v[0] = v0, s.v[1] = v1, s.g[0] = g0, s.g[1] = g1, s.a[0] = a0, s.a[1] = a1;
    s.grad_v[0] = l00, s.grad_v[1] = l01, s.grad_v[2] = l10, s.grad_v[3] = l11;
    s.p = 0;
    for (int m = 0; m < np; ++m) s.p += psi[m] * l.p[m];
    if (!(s.j > (system.space_.body(cell) == 0 ? least_volume_ratio : 0.0))) {
      const Vec2& x = system.space_.position(system.space_.cell_nodes(cell)[na / 2]);
      throw InvertedCell(x[0], x[1], system.space_.body(cell) != 0);
    }
  }

  /// d v_i / d x_j = d v_i / d X_K (F^-1)_Kj, row by row.
  static void spatial_gradient(const Point& s, double (&d)[4]) {
    const double r = 1.0 / s.j;
    for (int i = 0; i < 2; ++i) {
      d[2 * i] = r * (s.grad_v[2 * i] * s.f[3] - s.grad_v[2 * i + 1] * s.f[2]);
      d[2 * i + 1] = r * (-s.grad_v[2 * i] * s.f[1] + s.grad_v[2 * i + 1] * s.f[0]);
    }
  }

  /// r: 2 na momentum entries, then np of continuity.
  void residual(int cell, double* r) const {
    Local l;
    gather(cell, l);
    std::fill(r, r + nl + np, 0.0);
    const int body = system.space_.body(cell);
    Point s;
    for (int q = 0; q < nq; ++q) {
      at_point(cell, q, l, s);
      const double w = system.space_.weight(cell)[q];
      const double* psi = system.space_.pressure_value(cell) + q * np;
      double b[2], stress[4], constraint;
      body == 0 ? fluid_point(s, b, stress, constraint)
                : solid_point(s, system.material(body), b, stress, constraint);
      for (int i = 0; i < na; ++i) {
        r[2 * i] += w * (b[0] * s.n[i] + stress[0] * s.bx[i] + stress[1] * s.by[i]);
        r[2 * i + 1] += w * (b[1] * s.n[i] + stress[2] * s.bx[i] + stress[3] * s.by[i]);
      }
      for (int m = 0; m < np; ++m) r[nl + m] -= w * psi[m] * constraint;
    }
  }

  /// Force density and first Piola-Kirchhoff stress, per undeformed area.
  void fluid_point(const Point& s, double (&b)[2], double (&stress)[4], double& constraint) const {
    double d[4];
    spatial_gradient(s, d);
    const double c0 = s.v[0] - s.g[0], c1 = s.v[1] - s.g[1];
    const double rho_j = system.problem_.density * s.j, mu = system.viscosity_;
    b[0] = rho_j * (weights.inertia * s.a[0] - gravity[0] + c0 * d[0] + c1 * d[1]);
    b[1] = rho_j * (weights.inertia * s.a[1] - gravity[1] + c0 * d[2] + c1 * d[3]);
    const double s00 = 2 * mu * d[0] - s.p, s01 = mu * (d[1] + d[2]), s11 = 2 * mu * d[3] - s.p;
    const double cof[4] = {s.f[3], -s.f[2], -s.f[1], s.f[0]};
    stress[0] = s00 * cof[0] + s01 * cof[2], stress[1] = s00 * cof[1] + s01 * cof[3];
    stress[2] = s01 * cof[0] + s11 * cof[2], stress[3] = s01 * cof[1] + s11 * cof[3];
    constraint = s.j * (d[0] + d[3]);
  }

  void solid_point(const Point& s, const Material& m, double (&b)[2], double (&stress)[4],
                   double& constraint) const {
    const Matrix2 f = {s.f[0], s.f[1], s.f[2], s.f[3]};
    const Matrix2 shape = m.shape_stress(f), h = m.volume_gradient(f);
    b[0] = m.density * (weights.inertia * s.a[0] - gravity[0]);
    b[1] = m.density * (weights.inertia * s.a[1] - gravity[1]);
    for (std::size_t i = 0; i < 4; ++i) stress[i] = shape[i] - s.p * h[i];
    // Divided by c, it answers a change of velocity as the fluid's constraint does.
    constraint = (m.volume_strain(f) + s.p / m.lame) / weights.c;
  }

  /// Blocks of the linearisation: A, B1 = dR_v/dp, B2 = -dR_p/dv, C = -dR_p/dp.
  struct Blocks {
    double a[nl][nl], b1[nl][np], b2[np][nl], c[np][np];
  };

  void blocks(int cell, Blocks& k) const {
    Local l;
    gather(cell, l);
    k = Blocks{};
    const int body = system.space_.body(cell);
    Point s;
    for (int q = 0; q < nq; ++q) {
      at_point(cell, q, l, s);
      const double w = system.space_.weight(cell)[q];
      const double* psi = system.space_.pressure_value(cell) + q * np;
      body == 0 ? fluid_blocks(s, w, psi, k) : solid_blocks(s, w, psi, system.material(body), k);
    }
  }

  void fluid_blocks(const Point& s, double w, const double* psi, Blocks& k) const {
    double d[4];
    spatial_gradient(s, d);
    const double c0 = s.v[0] - s.g[0], c1 = s.v[1] - s.g[1], r = 1.0 / s.j;
    const double mass = w * s.j * system.problem_.density, mu = w * s.j * system.viscosity_;
    double dx[na], dy[na], transport[na];
    for (int i = 0; i < na; ++i) {
      dx[i] = r * (s.f[3] * s.bx[i] - s.f[2] * s.by[i]);
      dy[i] = r * (-s.f[1] * s.bx[i] + s.f[0] * s.by[i]);
      transport[i] = mass * (weights.inertia / weights.c * s.n[i] + c0 * dx[i] + c1 * dy[i]);
    }
    for (int i = 0; i < na; ++i)
      for (int j = 0; j < na; ++j) {
        const double same = s.n[i] * transport[j] + mu * (dx[i] * dx[j] + dy[i] * dy[j]);
        const double nn = mass * s.n[i] * s.n[j];
        k.a[2 * i][2 * j] += same + nn * d[0] + mu * dx[i] * dx[j];
        k.a[2 * i][2 * j + 1] += nn * d[1] + mu * dy[i] * dx[j];
        k.a[2 * i + 1][2 * j] += nn * d[2] + mu * dx[i] * dy[j];
        k.a[2 * i + 1][2 * j + 1] += same + nn * d[3] + mu * dy[i] * dy[j];
      }
    for (int m = 0; m < np; ++m)
      for (int i = 0; i < na; ++i) {
        const double bx = w * s.j * psi[m] * dx[i], by = w * s.j * psi[m] * dy[i];
        k.b1[2 * i][m] -= bx, k.b1[2 * i + 1][m] -= by;
        k.b2[m][2 * i] += bx, k.b2[m][2 * i + 1] += by;
      }
    for (int m = 0; m < np; ++m)
      for (int n = 0; n < np; ++n) k.c[m][n] += w * s.j * psi[m] * psi[n] * artificial();
  }

  /// Compressibility of the matrix, 1/(Pa s): far below what any term of A answers.
  double artificial() const {
    constexpr double beta = 1e7;
    double scale = system.viscosity_;
    for (const Material& m : system.materials_)
      scale = std::max(scale, weights.c * m.shear_modulus);
    return 1.0 / (beta * scale);
  }

  void solid_blocks(const Point& s, double w, const double* psi, const Material& m,
                    Blocks& k) const {
    const Matrix2 f = {s.f[0], s.f[1], s.f[2], s.f[3]};
    const Matrix2 h = m.volume_gradient(f);
    const Tangent2 t = m.tangent(f, s.p);
    const double c = weights.c;
    const double mass = weights.inertia / c * m.density;
    double row[4][na][2];
    for (int j = 0; j < na; ++j)
      for (std::size_t ik = 0; ik < 4; ++ik)
        for (std::size_t d = 0; d < 2; ++d)
          row[ik][j][d] = c * (t[ik * 4 + 2 * d] * s.bx[j] + t[ik * 4 + 2 * d + 1] * s.by[j]);
    for (int i = 0; i < na; ++i)
      for (int j = 0; j < na; ++j) {
        const double nn = mass * s.n[i] * s.n[j];
        for (int a = 0; a < 2; ++a)
          for (int b = 0; b < 2; ++b)
            k.a[2 * i + a][2 * j + b] += w * ((a == b ? nn : 0.0) + s.bx[i] * row[2 * a][j][b] +
                                              s.by[i] * row[2 * a + 1][j][b]);
      }
    for (int p = 0; p < np; ++p)
      for (int i = 0; i < na; ++i)
        for (int a = 0; a < 2; ++a) {
          const auto ax = static_cast<std::size_t>(2 * a);
          const double b = w * psi[p] * (h[ax] * s.bx[i] + h[ax + 1] * s.by[i]);
          k.b1[2 * i + a][p] -= b;
          k.b2[p][2 * i + a] += b;
        }
    const double compliance = artificial() + 1.0 / (c * m.lame);
    for (int p = 0; p < np; ++p)
      for (int n = 0; n < np; ++n) k.c[p][n] += w * psi[p] * psi[n] * compliance;
  }

  /// C^-1 by Gauss-Jordan; C is a scaled Gram matrix, so the pivots are positive.
  static void invert(double (&c)[np][np], double (&inverse)[np][np]) {
    for (int i = 0; i < np; ++i)
      for (int j = 0; j < np; ++j) inverse[i][j] = i == j ? 1.0 : 0.0;
    for (int i = 0; i < np; ++i) {
      const double r = 1.0 / c[i][i];
      for (int j = 0; j < np; ++j) c[i][j] *= r, inverse[i][j] *= r;
      for (int k = 0; k < np; ++k) {
        if (k == i) continue;
        const double factor = c[k][i];
        for (int j = 0; j < np; ++j)
          c[k][j] -= factor * c[i][j], inverse[k][j] -= factor * inverse[i][j];
      }
    }
  }

  /// Eliminates the pressure: `a` becomes A - B1 C^-1 B2.
  static void condense(Blocks& k, double* inverse_c_b2, double* b1, double* inverse_c) {
    double inverse[np][np], e[np][nl];
    invert(k.c, inverse);
    for (int m = 0; m < np; ++m)
      for (int j = 0; j < nl; ++j) {
        e[m][j] = 0;
        for (int n = 0; n < np; ++n) e[m][j] += inverse[m][n] * k.b2[n][j];
        inverse_c_b2[m * nl + j] = e[m][j];
      }
    for (int i = 0; i < nl; ++i)
      for (int m = 0; m < np; ++m) {
        b1[i * np + m] = k.b1[i][m];
        for (int j = 0; j < nl; ++j) k.a[i][j] -= k.b1[i][m] * e[m][j];
      }
    for (int m = 0; m < np; ++m)
      for (int n = 0; n < np; ++n) inverse_c[m * np + n] = inverse[m][n];
  }
};

namespace {

/// Runs `body(cell)` over all cells on the threads deal.II was given; an exception in one reaches
/// the caller.
template <typename Body>
void for_each_cell(int cells, const Body& body) {
  dealii::parallel::apply_to_subranges(
      0, cells,
      [&body](int begin, int end) {
        for (int c = begin; c < end; ++c) body(c);
      },
      64);
}

bool contains(const std::vector<Side>& sides, Side side) {
  return std::find(sides.begin(), sides.end(), side) != sides.end();
}

constexpr std::array<Side, 4> all_sides = {Side::left, Side::right, Side::bottom, Side::top};

}  // namespace

FluidStructure::FluidStructure(const Space& space, const Problem& problem,
                               std::vector<Material> materials)
    : space_(space), problem_(problem), materials_(std::move(materials)) {
  viscosity_ = problem.viscosity ? problem.viscosity->dynamic : 0.0;
  number_unknowns();
  build_pattern();
  wetted_nodes_.assign(materials_.size() + 1,
                       std::vector<char>(static_cast<std::size_t>(space.nodes()), 0));
  for (int n = 0; n < space.nodes(); ++n)
    if (space.in_solid(n) && space.in_fluid(n))
      wetted_nodes_[static_cast<std::size_t>(space.solid_of(n))][static_cast<std::size_t>(n)] = 1;
  wall_nodes_.assign(problem.curved_walls.size(),
                     std::vector<char>(static_cast<std::size_t>(space.nodes()), 0));
  // A node on two walls counts for the first.
  for (int n = 0; n < space.nodes(); ++n)
    for (std::size_t wall = 0; wall < wall_nodes_.size(); ++wall)
      if (space.in_fluid(n) && !space.in_solid(n) && space.on_obstacle(n, static_cast<int>(wall))) {
        wall_nodes_[wall][static_cast<std::size_t>(n)] = 1;
        break;
      }
}

void FluidStructure::number_unknowns() {
  unknown_.assign(2 * static_cast<std::size_t>(space_.nodes()), 0);
  for (int n = 0; n < space_.nodes(); ++n) {
    bool fixed[2] = {space_.on_obstacle(n), space_.on_obstacle(n)};
    for (const Side side : all_sides) {
      if (!space_.on_side(n, side)) continue;
      const std::size_t normal = (side == Side::left || side == Side::right) ? 0 : 1;
      if (problem_.walls && contains(problem_.walls->no_slip, side)) fixed[0] = fixed[1] = true;
      if (problem_.walls && contains(problem_.walls->free_slip, side)) fixed[normal] = true;
      if (problem_.inflow && problem_.inflow->side == side) fixed[0] = fixed[1] = true;
      for (std::size_t s = 0; s < problem_.solids.size(); ++s)
        if (problem_.solids[s].clamped == side && space_.solid_of(n) == static_cast<int>(s) + 1)
          fixed[0] = fixed[1] = true;
    }
    for (std::size_t d = 0; d < 2; ++d)
      unknown_[2 * static_cast<std::size_t>(n) + d] = fixed[d] ? -1 : matrix_.size++;
  }
}

void FluidStructure::build_pattern() {
  const int na = space_.nodes_per_cell(), nl = 2 * na;
  std::vector<std::vector<int>> columns(static_cast<std::size_t>(matrix_.size));
  std::vector<int> numbers(static_cast<std::size_t>(nl));
  const auto number_cell = [&](int c) {
    for (int i = 0; i < nl; ++i)
      numbers[static_cast<std::size_t>(i)] = unknown(space_.cell_nodes(c)[i / 2], i % 2);
  };
  for (int c = 0; c < space_.cells(); ++c) {
    number_cell(c);
    for (const int j : numbers)
      for (const int i : numbers)
        if (i >= 0 && j >= 0) columns[static_cast<std::size_t>(j)].push_back(i);
  }
  matrix_.start = {0};
  for (auto& column : columns) {
    std::sort(column.begin(), column.end());
    column.erase(std::unique(column.begin(), column.end()), column.end());
    matrix_.row.insert(matrix_.row.end(), column.begin(), column.end());
    matrix_.start.push_back(static_cast<int>(matrix_.row.size()));
  }
  matrix_.value.assign(matrix_.row.size(), 0.0);
  entry_.reserve(static_cast<std::size_t>(space_.cells() * nl * nl));
  for (int c = 0; c < space_.cells(); ++c) {
    number_cell(c);
    for (const int i : numbers)
      for (const int j : numbers) {
        if (i < 0 || j < 0) {
          entry_.push_back(-1);
          continue;
        }
        const auto begin = matrix_.row.begin() + matrix_.start[static_cast<std::size_t>(j)];
        const auto end = matrix_.row.begin() + matrix_.start[static_cast<std::size_t>(j) + 1];
        entry_.push_back(static_cast<int>(std::lower_bound(begin, end, i) - matrix_.row.begin()));
      }
  }
}

void FluidStructure::impose(double time, std::vector<double>& velocity) const {
  for (int n = 0; n < space_.nodes(); ++n)
    for (int d = 0; d < 2; ++d)
      if (unknown(n, d) < 0)
        velocity[2 * static_cast<std::size_t>(n) + static_cast<std::size_t>(d)] = 0.0;
  for (const WallMotion& motion : problem_.wall_motion)
    for (int n = 0; n < space_.nodes(); ++n)
      if (space_.on_side(n, motion.side) && !space_.in_solid(n))
        for (std::size_t d = 0; d < 2; ++d)
          velocity[2 * static_cast<std::size_t>(n) + d] =
              motion.velocity[d] * motion.waveform.value(time);
  if (!problem_.inflow) return;
  const Inflow& inflow = *problem_.inflow;
  const std::size_t normal = (inflow.side == Side::left || inflow.side == Side::right) ? 0 : 1;
  const double inward = (inflow.side == Side::left || inflow.side == Side::bottom) ? 1.0 : -1.0;
  const double from = problem_.channel.from[1 - normal];
  const double height = problem_.channel.to[1 - normal] - from;
  for (int n = 0; n < space_.nodes(); ++n) {
    if (!space_.on_side(n, inflow.side) || space_.in_solid(n)) continue;
    bool wall = false;
    for (const Side side : all_sides)
      if (problem_.walls && contains(problem_.walls->no_slip, side) && space_.on_side(n, side))
        wall = true;
    if (!wall)
      velocity[2 * static_cast<std::size_t>(n) + normal] =
          inward * inflow.speed(space_.position(n)[1 - normal] - from, height, time);
  }
}

bool FluidStructure::is_open(unsigned boundary) const {
  if (boundary >= free_id) return false;
  const Side side = static_cast<Side>(boundary);
  if (problem_.inflow && problem_.inflow->side == side) return false;
  return !(problem_.walls &&
           (contains(problem_.walls->no_slip, side) || contains(problem_.walls->free_slip, side)));
}

double FluidStructure::open_pressure(unsigned boundary, double time) const {
  for (const auto& side : {problem_.outflow, problem_.pressure_inflow})
    if (side && static_cast<unsigned>(side->side) == boundary) return side->pressure_at(time);
  return 0.0;
}

Vec2 FluidStructure::gravity(double time) const {
  if (!problem_.gravity) return {};
  const double factor = problem_.gravity->waveform.value(time);
  return {factor * problem_.gravity->acceleration[0], factor * problem_.gravity->acceleration[1]};
}

namespace {

/// Deformation gradient and spatial velocity gradient at point q of a boundary face.
struct FacePoint {
  double f[4] = {1, 0, 0, 1};
  double grad[4] = {0, 0, 0, 0};
  double inverse_j = 1;
};

FacePoint face_point(const Space& space, const BoundaryFace& face, std::size_t q,
                     const Fields& fields) {
  const auto na = static_cast<std::size_t>(space.nodes_per_cell());
  FacePoint s;
  double l[4] = {0, 0, 0, 0};
  for (std::size_t a = 0; a < na; ++a) {
    const auto n = 2 * static_cast<std::size_t>(space.cell_nodes(face.cell)[a]);
    const double bx = face.grad_x[q * na + a], by = face.grad_y[q * na + a];
    for (std::size_t i = 0; i < 2; ++i) {
      s.f[2 * i] += bx * fields.displacement[n + i];
      s.f[2 * i + 1] += by * fields.displacement[n + i];
      l[2 * i] += bx * fields.velocity[n + i];
      l[2 * i + 1] += by * fields.velocity[n + i];
    }
  }
  s.inverse_j = 1.0 / (s.f[0] * s.f[3] - s.f[1] * s.f[2]);
  for (std::size_t i = 0; i < 2; ++i) {
    s.grad[2 * i] = s.inverse_j * (l[2 * i] * s.f[3] - l[2 * i + 1] * s.f[2]);
    s.grad[2 * i + 1] = s.inverse_j * (-l[2 * i] * s.f[1] + l[2 * i + 1] * s.f[0]);
  }
  return s;
}

}  // namespace

void FluidStructure::add_open_boundary(const Fields& fields, double time, Residual& result) const {
  const auto na = static_cast<std::size_t>(space_.nodes_per_cell());
  for (const BoundaryFace& face : space_.boundary()) {
    if (space_.body(face.cell) != 0 || !is_open(face.boundary)) continue;
    const double pressure = open_pressure(face.boundary, time);
    for (std::size_t q = 0; q < face.normal_weight.size(); ++q) {
      const FacePoint s = face_point(space_, face, q, fields);
      const Vec2& n = face.normal_weight[q];
      for (std::size_t i = 0; i < 2; ++i) {
        const double traction =
            -pressure * n[i] + viscosity_ * (s.grad[i] * n[0] + s.grad[2 + i] * n[1]);
        for (std::size_t a = 0; a < na; ++a)
          result.momentum[2 * static_cast<std::size_t>(space_.cell_nodes(face.cell)[a]) + i] -=
              traction * face.value[q * na + a];
      }
    }
  }
}

void FluidStructure::add_open_boundary_matrix(const Fields& fields) {
  const auto na = static_cast<std::size_t>(space_.nodes_per_cell()), nl = 2 * na;
  for (const BoundaryFace& face : space_.boundary()) {
    if (space_.body(face.cell) != 0 || !is_open(face.boundary)) continue;
    const int* entry = &entry_[static_cast<std::size_t>(face.cell) * nl * nl];
    for (std::size_t q = 0; q < face.normal_weight.size(); ++q) {
      const FacePoint s = face_point(space_, face, q, fields);
      const Vec2& n = face.normal_weight[q];
      for (std::size_t b = 0; b < na; ++b) {
        const double bx = face.grad_x[q * na + b], by = face.grad_y[q * na + b];
        const double d[2] = {s.inverse_j * (s.f[3] * bx - s.f[2] * by),
                             s.inverse_j * (-s.f[1] * bx + s.f[0] * by)};
        for (std::size_t a = 0; a < na; ++a)
          for (std::size_t i = 0; i < 2; ++i)
            for (std::size_t j = 0; j < 2; ++j)
              if (const int e = entry[(2 * a + i) * nl + 2 * b + j]; e >= 0)
                matrix_.value[static_cast<std::size_t>(e)] -=
                    viscosity_ * face.value[q * na + a] * d[i] * n[j];
      }
    }
  }
}

void FluidStructure::residual(const Fields& fields, const StageWeights& weights,
                              Residual& result) const {
  const auto np = static_cast<std::size_t>(space_.pressures_per_cell());
  const auto na = static_cast<std::size_t>(space_.nodes_per_cell()), n_local = 2 * na + np;
  const auto cells = static_cast<std::size_t>(space_.cells());
  local_.resize(cells * n_local);
  const auto run = [&](const auto& kernel) {
    for_each_cell(space_.cells(), [&](int c) {
      kernel.residual(c, &local_[static_cast<std::size_t>(c) * n_local]);
    });
  };
  if (space_.degree() == 2)
    run(Kernel<2>{*this, fields, weights, gravity(weights.time)});
  else
    run(Kernel<3>{*this, fields, weights, gravity(weights.time)});
  result.momentum.assign(2 * static_cast<std::size_t>(space_.nodes()), 0.0);
  result.continuity.resize(cells * np);
  for (std::size_t c = 0; c < cells; ++c) {
    const double* r = &local_[c * n_local];
    for (std::size_t a = 0; a < na; ++a) {
      const auto n = 2 * static_cast<std::size_t>(space_.cell_nodes(static_cast<int>(c))[a]);
      result.momentum[n] += r[2 * a];
      result.momentum[n + 1] += r[2 * a + 1];
    }
    for (std::size_t m = 0; m < np; ++m) result.continuity[c * np + m] = r[2 * na + m];
  }
  add_open_boundary(fields, weights.time, result);
  for (std::size_t i = 0; i < load_.size(); ++i) result.momentum[i] -= load_[i];
}

void FluidStructure::linearize(const Fields& fields, const StageWeights& weights) {
  const auto cells = static_cast<std::size_t>(space_.cells());
  const auto np = static_cast<std::size_t>(space_.pressures_per_cell());
  const auto nl = 2 * static_cast<std::size_t>(space_.nodes_per_cell());
  inverse_c_b2_.resize(cells * np * nl);
  b1_.resize(cells * np * nl);
  inverse_c_.resize(cells * np * np);
  std::vector<double> condensed(cells * nl * nl);
  const auto run = [&]<int degree>(const Kernel<degree>& kernel) {
    for_each_cell(space_.cells(), [&](int cell) {
      typename Kernel<degree>::Blocks k;
      const auto c = static_cast<std::size_t>(cell);
      kernel.blocks(cell, k);
      Kernel<degree>::condense(k, &inverse_c_b2_[c * np * nl], &b1_[c * np * nl],
                               &inverse_c_[c * np * np]);
      std::copy(&k.a[0][0], &k.a[0][0] + nl * nl, &condensed[c * nl * nl]);
    });
  };
  if (space_.degree() == 2)
    run(Kernel<2>{*this, fields, weights, gravity(weights.time)});
  else
    run(Kernel<3>{*this, fields, weights, gravity(weights.time)});
  std::fill(matrix_.value.begin(), matrix_.value.end(), 0.0);
  for (std::size_t e = 0; e < entry_.size(); ++e)
    if (entry_[e] >= 0) matrix_.value[static_cast<std::size_t>(entry_[e])] += condensed[e];
  add_open_boundary_matrix(fields);
  lu_.factorize(matrix_);
}

void FluidStructure::correct(const Residual& residual, std::vector<double>& velocity_step,
                             std::vector<double>& pressure_step) const {
  const auto cells = static_cast<std::size_t>(space_.cells());
  const auto np = static_cast<std::size_t>(space_.pressures_per_cell());
  const auto nl = 2 * static_cast<std::size_t>(space_.nodes_per_cell());
  std::vector<double> right(static_cast<std::size_t>(matrix_.size), 0.0), step;
  for (std::size_t i = 0; i < unknown_.size(); ++i)
    if (unknown_[i] >= 0) right[static_cast<std::size_t>(unknown_[i])] = -residual.momentum[i];
  pressure_step.assign(cells * np, 0.0);
  for (std::size_t c = 0; c < cells; ++c) {
    double* y = &pressure_step[c * np];
    for (std::size_t m = 0; m < np; ++m)
      for (std::size_t n = 0; n < np; ++n)
        y[m] += inverse_c_[(c * np + m) * np + n] * residual.continuity[c * np + n];
    for (std::size_t i = 0; i < nl; ++i) {
      const int row =
          unknown(space_.cell_nodes(static_cast<int>(c))[i / 2], static_cast<int>(i % 2));
      if (row < 0) continue;
      for (std::size_t m = 0; m < np; ++m)
        right[static_cast<std::size_t>(row)] -= b1_[(c * nl + i) * np + m] * y[m];
    }
  }
  lu_.solve(right, step);
  velocity_step.assign(unknown_.size(), 0.0);
  for (std::size_t i = 0; i < unknown_.size(); ++i)
    if (unknown_[i] >= 0) velocity_step[i] = step[static_cast<std::size_t>(unknown_[i])];
  for (std::size_t c = 0; c < cells; ++c)
    for (std::size_t i = 0; i < nl; ++i) {
      const auto n =
          2 * static_cast<std::size_t>(space_.cell_nodes(static_cast<int>(c))[i / 2]) + i % 2;
      for (std::size_t m = 0; m < np; ++m)
        pressure_step[c * np + m] -= inverse_c_b2_[(c * np + m) * nl + i] * velocity_step[n];
    }
}

Vec2 FluidStructure::force_on(const std::vector<char>& nodes, const Fields& fields,
                              const StageWeights& weights) const {
  const int na = space_.nodes_per_cell();
  const auto counts = [&](int node, int d) {
    if (nodes[static_cast<std::size_t>(node)] == 0) return false;
    // At a foot of the body the wall's pressure acts on the node too: it must not count as the
    // body's.
    for (const Side side : all_sides)
      if (space_.on_side(node, side) && (side == Side::left || side == Side::right) == (d == 0))
        return false;
    return true;
  };
  std::vector<double> r(static_cast<std::size_t>(2 * na + space_.pressures_per_cell()));
  Vec2 force{};
  for (int c = 0; c < space_.cells(); ++c) {
    const int* cell = space_.cell_nodes(c);
    if (space_.body(c) != 0 || std::none_of(cell, cell + na, [&](int node) {
          return nodes[static_cast<std::size_t>(node)] != 0;
        }))
      continue;
    if (space_.degree() == 2)
      Kernel<2>{*this, fields, weights, gravity(weights.time)}.residual(c, r.data());
    else
      Kernel<3>{*this, fields, weights, gravity(weights.time)}.residual(c, r.data());
    for (int a = 0; a < na; ++a)
      for (int d = 0; d < 2; ++d)
        if (counts(cell[a], d))
          force[static_cast<std::size_t>(d)] -= r[static_cast<std::size_t>(2 * a + d)];
  }
  return force;
}

double FluidStructure::boundary_power(const Fields& fields, const StageWeights& weights) const {
  Residual reaction;
  residual(fields, weights, reaction);
  double power = 0.0;
  for (std::size_t i = 0; i < unknown_.size(); ++i)
    if (unknown_[i] < 0) power += reaction.momentum[i] * fields.velocity[i];
  // The open sides' tractions stand in the residual with a minus sign.
  Residual open;
  open.momentum.assign(unknown_.size(), 0.0);
  add_open_boundary(fields, weights.time, open);
  for (std::size_t i = 0; i < unknown_.size(); ++i) power -= open.momentum[i] * fields.velocity[i];
  return power;
}

double largest(const std::vector<double>& x) {
  double m = 0.0, sum = 0.0;
  for (const double value : x) {
    m = std::max(m, std::abs(value));
    sum += 0.0 * value;
  }
  return m + sum;
}

}  // namespace sprung::reference
