#include "reference_fem/solid_block.hpp"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_dgp.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_system.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/grid/grid_generator.h>
#include <deal.II/grid/tria.h>
#include <deal.II/lac/affine_constraints.h>
#include <deal.II/lac/dynamic_sparsity_pattern.h>
#include <deal.II/lac/full_matrix.h>
#include <deal.II/lac/sparse_direct.h>
#include <deal.II/lac/sparse_matrix.h>
#include <deal.II/lac/vector.h>
#include <deal.II/numerics/vector_tools.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace sprung::reference {
namespace {

using dealii::Tensor;
using Matrix3 = Tensor<2, 3>;

/// u_0 = shear X_1.
class SimpleShear : public dealii::Function<3> {
 public:
  explicit SimpleShear(double shear) : Function(4), shear_(shear) {}
  double value(const dealii::Point<3>& x, unsigned component) const override {
    return component == 0 ? shear_ * x[1] : 0.0;
  }

 private:
  double shear_;
};

void check(const SolidBlock& b) {
  const auto positive = [](double x) { return std::isfinite(x) && x > 0.0; };
  for (std::size_t d = 0; d < 3; ++d) {
    if (!positive(b.size[d])) throw std::invalid_argument("a block's size must be positive");
    if (b.cells[d] < 1) throw std::invalid_argument("a block needs at least one cell a side");
    if (!std::isfinite(b.stress[d])) throw std::invalid_argument("a stress is not finite");
    if (b.shear != 0.0 && b.stress[d] != 0.0)
      throw std::invalid_argument("a shear is prescribed on all faces; leave the stresses out");
  }
  if (!positive(b.youngs_modulus)) throw std::invalid_argument("Young's modulus must be positive");
  if (!(b.poisson_ratio > -1.0 && b.poisson_ratio <= 0.5))
    throw std::invalid_argument("Poisson's ratio must lie above -1 and not beyond 0.5");
  if (b.increments < 1) throw std::invalid_argument("at least one load increment is needed");
}

class BlockSolver {
 public:
  explicit BlockSolver(const SolidBlock& block);
  std::vector<BlockState> solve();

 private:
  void constrain();
  void prescribe(double load);
  /// Residual of equilibrium at `x`, and the matrix if one is wanted; false if J <= 0 somewhere.
  bool assemble(const dealii::Vector<double>& x, double load, bool with_matrix);
  bool add_cell(const dealii::FEValues<3>& values, const dealii::Vector<double>& x,
                dealii::FullMatrix<double>* matrix, dealii::Vector<double>& residual) const;
  void add_face(const dealii::FEFaceValues<3>& values, const dealii::Vector<double>& x,
                double stress, dealii::FullMatrix<double>* matrix,
                dealii::Vector<double>& residual) const;
  int newton(double load);
  BlockState measure(double load, int iterations) const;

  SolidBlock block_;
  double shear_modulus_, compliance_;  ///< G (Pa), 1/lambda (1/Pa)
  dealii::Triangulation<3> mesh_;
  dealii::FESystem<3> fe_;
  dealii::DoFHandler<3> dofs_;
  dealii::AffineConstraints<double> constraints_;
  dealii::SparsityPattern pattern_;
  dealii::SparseMatrix<double> matrix_;
  dealii::Vector<double> x_, residual_;
};

const dealii::FEValuesExtractors::Vector displacement(0);
const dealii::FEValuesExtractors::Scalar pressure(3);

BlockSolver::BlockSolver(const SolidBlock& block)
    : block_(block),
      shear_modulus_(block.youngs_modulus / (2.0 * (1.0 + block.poisson_ratio))),
      compliance_((1.0 - 2.0 * block.poisson_ratio) / (2.0 * shear_modulus_ * block.poisson_ratio)),
      fe_(dealii::FE_Q<3>(2), 3, dealii::FE_DGP<3>(1), 1),
      dofs_(mesh_) {
  dealii::Point<3> end;
  std::vector<unsigned> cells;
  for (std::size_t d = 0; d < 3; ++d) {
    end[static_cast<unsigned>(d)] = block.size[d];
    cells.push_back(static_cast<unsigned>(block.cells[d]));
  }
  // Coloured: face `side` of axis d has the id 2 d + side.
  dealii::GridGenerator::subdivided_hyper_rectangle(mesh_, cells, dealii::Point<3>(), end, true);
  dofs_.distribute_dofs(fe_);
  constrain();
  dealii::DynamicSparsityPattern dynamic(dofs_.n_dofs());
  dealii::DoFTools::make_sparsity_pattern(dofs_, dynamic, constraints_, false);
  // Condensed rows keep their diagonal; the zero block of the pressures needs one too.
  for (unsigned i = 0; i < dofs_.n_dofs(); ++i) dynamic.add(i, i);
  pattern_.copy_from(dynamic);
  matrix_.reinit(pattern_);
  x_.reinit(dofs_.n_dofs());
  residual_.reinit(dofs_.n_dofs());
}

void BlockSolver::constrain() {
  const auto hold = [&](unsigned face, unsigned component) {
    dealii::ComponentMask mask(4, false);
    mask.set(component, true);
    dealii::DoFTools::make_zero_boundary_constraints(dofs_, face, constraints_, mask);
  };
  for (unsigned d = 0; d < 3; ++d) {
    if (block_.shear != 0.0)
      for (unsigned face = 0; face < 4; ++face) hold(face, d);
    if (block_.shear == 0.0 || d == 2) hold(2 * d, d);
    if (block_.glued && d > 0) hold(0, d), hold(1, d);
  }
  constraints_.close();
}

/// Boundary values of the shear; corrections leave them alone.
void BlockSolver::prescribe(double load) {
  if (block_.shear == 0.0) return;
  std::map<dealii::types::global_dof_index, double> values;
  dealii::ComponentMask mask(4, true);
  mask.set(3, false);
  for (unsigned face = 0; face < 4; ++face)
    dealii::VectorTools::interpolate_boundary_values(dofs_, face, SimpleShear(load * block_.shear),
                                                     values, mask);
  for (const auto& [dof, value] : values) x_[dof] = value;
}

/// d(J F^-T) = J ((F^-T : dF) F^-T - F^-T dF^T F^-T).
Matrix3 cofactor_change(const Matrix3& inverse_t, double j, const Matrix3& df) {
  return j * (dealii::scalar_product(inverse_t, df) * inverse_t -
              inverse_t * dealii::transpose(df) * inverse_t);
}

bool BlockSolver::add_cell(const dealii::FEValues<3>& values, const dealii::Vector<double>& x,
                           dealii::FullMatrix<double>* matrix,
                           dealii::Vector<double>& residual) const {
  std::vector<Matrix3> grad(values.n_quadrature_points);
  std::vector<double> p(values.n_quadrature_points);
  values[displacement].get_function_gradients(x, grad);
  values[pressure].get_function_values(x, p);
  const unsigned n = values.dofs_per_cell;
  const Matrix3 identity = dealii::unit_symmetric_tensor<3>();
  for (const unsigned q : values.quadrature_point_indices()) {
    const Matrix3 f = identity + grad[q];
    const double j = dealii::determinant(f), w = values.JxW(q);
    if (!(j > 0.0)) return false;
    const Matrix3 inverse_t = dealii::transpose(dealii::invert(f));
    const Matrix3 stress = shear_modulus_ * (f - inverse_t) - p[q] * j * inverse_t;
    for (unsigned a = 0; a < n; ++a)
      residual[a] += w * (dealii::scalar_product(stress, values[displacement].gradient(a, q)) -
                          values[pressure].value(a, q) * (j - 1.0 + compliance_ * p[q]));
    if (matrix == nullptr) continue;
    for (unsigned b = 0; b < n; ++b) {
      // What stress and constraint answer to the unknown b, once for all rows.
      const Matrix3 db = values[displacement].gradient(b, q);
      const double qb = values[pressure].value(b, q);
      const Matrix3 change = shear_modulus_ * (db + inverse_t * dealii::transpose(db) * inverse_t) -
                             p[q] * cofactor_change(inverse_t, j, db) - qb * j * inverse_t;
      const double constraint = j * dealii::scalar_product(inverse_t, db) + compliance_ * qb;
      for (unsigned a = 0; a < n; ++a)
        (*matrix)(a, b) +=
            w * (dealii::scalar_product(change, values[displacement].gradient(a, q)) -
                 values[pressure].value(a, q) * constraint);
    }
  }
  return true;
}

void BlockSolver::add_face(const dealii::FEFaceValues<3>& values, const dealii::Vector<double>& x,
                           double stress, dealii::FullMatrix<double>* matrix,
                           dealii::Vector<double>& residual) const {
  std::vector<Matrix3> grad(values.n_quadrature_points);
  values[displacement].get_function_gradients(x, grad);
  const Matrix3 identity = dealii::unit_symmetric_tensor<3>();
  const unsigned n = values.dofs_per_cell;
  for (const unsigned q : values.quadrature_point_indices()) {
    const Tensor<1, 3> normal = values.normal_vector(q);
    const Matrix3 f = identity + grad[q];
    const double j = dealii::determinant(f);
    const Matrix3 inverse_t = dealii::transpose(dealii::invert(f));
    const Tensor<1, 3> traction = stress * (block_.follows ? j * (inverse_t * normal) : normal);
    for (unsigned a = 0; a < n; ++a) {
      const Tensor<1, 3> phi = values[displacement].value(a, q);
      residual[a] -= values.JxW(q) * (traction * phi);
      if (matrix == nullptr || !block_.follows) continue;
      for (unsigned b = 0; b < n; ++b)
        (*matrix)(a, b) -=
            values.JxW(q) * stress *
            ((cofactor_change(inverse_t, j, values[displacement].gradient(b, q)) * normal) * phi);
    }
  }
}

bool BlockSolver::assemble(const dealii::Vector<double>& x, double load, bool with_matrix) {
  const dealii::QGauss<3> inside(3);
  const dealii::QGauss<2> on_face(3);
  dealii::FEValues<3> values(
      fe_, inside, dealii::update_values | dealii::update_gradients | dealii::update_JxW_values);
  dealii::FEFaceValues<3> face_values(fe_, on_face,
                                      dealii::update_values | dealii::update_gradients |
                                          dealii::update_JxW_values |
                                          dealii::update_normal_vectors);
  const unsigned n = fe_.n_dofs_per_cell();
  dealii::FullMatrix<double> local(n, n);
  dealii::Vector<double> right(n);
  std::vector<dealii::types::global_dof_index> numbers(n);
  residual_ = 0.0;
  if (with_matrix) matrix_ = 0.0;
  for (const auto& cell : dofs_.active_cell_iterators()) {
    values.reinit(cell);
    local = 0.0;
    right = 0.0;
    if (!add_cell(values, x, with_matrix ? &local : nullptr, right)) return false;
    for (const auto& face : cell->face_iterators()) {
      if (!face->at_boundary() || face->boundary_id() % 2 == 0) continue;
      const double stress = load * block_.stress[face->boundary_id() / 2];
      if (stress == 0.0) continue;
      face_values.reinit(cell, face);
      add_face(face_values, x, stress, with_matrix ? &local : nullptr, right);
    }
    cell->get_dof_indices(numbers);
    if (with_matrix)
      constraints_.distribute_local_to_global(local, right, numbers, matrix_, residual_);
    else
      constraints_.distribute_local_to_global(right, numbers, residual_);
  }
  return true;
}

int BlockSolver::newton(double load) {
  constexpr int most = 50, halvings = 12;
  constexpr double tolerance = 1e-12, round_off = 1e-10;
  double first = 0.0;
  for (int iteration = 1; iteration <= most; ++iteration) {
    if (!assemble(x_, load, true)) break;
    const double merit = residual_.l2_norm();
    first = std::max(first, merit);
    dealii::SparseDirectUMFPACK lu;
    lu.initialize(matrix_);
    dealii::Vector<double> step = residual_;
    lu.solve(step);
    constraints_.distribute(step);
    const double change = step.linfty_norm();
    // Line search: the step is halved until the residual falls. Near the solution round-off decides
    // whether it does, and the whole step is right.
    dealii::Vector<double> tried = x_;
    tried -= step;
    bool found = merit <= round_off * first;
    double length = 1.0;
    for (int k = 0; k < halvings && !found; ++k, length *= found ? 1.0 : 0.5) {
      tried = x_;
      tried.add(-length, step);
      found = assemble(tried, load, false) && residual_.l2_norm() < (1.0 - 0.1 * length) * merit;
    }
    if (!found) break;
    x_ = tried;
    if (change <= tolerance * x_.linfty_norm() || merit <= round_off * first) return iteration;
  }
  throw std::runtime_error("the block found no equilibrium at " + std::to_string(100.0 * load) +
                           " % of the load; use more increments or a smaller stress");
}

BlockState BlockSolver::measure(double load, int iterations) const {
  const dealii::QGauss<3> inside(3);
  const dealii::QGauss<2> on_face(3);
  dealii::FEValues<3> values(
      fe_, inside, dealii::update_values | dealii::update_gradients | dealii::update_JxW_values);
  dealii::FEFaceValues<3> face_values(fe_, on_face,
                                      dealii::update_values | dealii::update_JxW_values);
  std::vector<Matrix3> grad(inside.size());
  std::vector<double> p(inside.size());
  std::vector<Tensor<1, 3>> u(on_face.size());
  BlockState s;
  s.load = load;
  s.iterations = iterations;
  double volume = 0.0, deformed = 0.0;
  std::array<double, 3> area{}, moved{}, least{}, most{};
  least.fill(std::numeric_limits<double>::max());
  most.fill(std::numeric_limits<double>::lowest());
  const Matrix3 identity = dealii::unit_symmetric_tensor<3>();
  for (const auto& cell : dofs_.active_cell_iterators()) {
    values.reinit(cell);
    values[displacement].get_function_gradients(x_, grad);
    values[pressure].get_function_values(x_, p);
    for (const unsigned q : values.quadrature_point_indices()) {
      const Matrix3 f = identity + grad[q];
      const double j = dealii::determinant(f), w = values.JxW(q);
      const Matrix3 inverse_t = dealii::transpose(dealii::invert(f));
      const Matrix3 stress = shear_modulus_ * (f - inverse_t) - p[q] * j * inverse_t;
      volume += w, deformed += w * j, s.mean_pressure += w * p[q];
      s.shear_stress += w * stress[0][1];
      for (unsigned d = 0; d < 3; ++d) s.nominal[d] += w * stress[d][d];
      s.energy +=
          w * (0.5 * shear_modulus_ * (dealii::scalar_product(f, f) - 3.0 - 2.0 * std::log(j)) +
               0.5 * compliance_ * p[q] * p[q]);
    }
    for (const auto& face : cell->face_iterators()) {
      if (!face->at_boundary() || face->boundary_id() % 2 == 0) continue;
      const unsigned d = face->boundary_id() / 2;
      face_values.reinit(cell, face);
      face_values[displacement].get_function_values(x_, u);
      for (const unsigned q : face_values.quadrature_point_indices()) {
        area[d] += face_values.JxW(q);
        moved[d] += face_values.JxW(q) * u[q][d];
        least[d] = std::min(least[d], u[q][d]);
        most[d] = std::max(most[d], u[q][d]);
      }
    }
  }
  s.mean_pressure /= volume, s.shear_stress /= volume, s.volume_ratio = deformed / volume;
  for (std::size_t d = 0; d < 3; ++d) {
    s.nominal[d] /= volume;
    s.stretch[d] = 1.0 + moved[d] / area[d] / block_.size[d];
    s.spread[d] = (most[d] - least[d]) / block_.size[d];
  }
  return s;
}

std::vector<BlockState> BlockSolver::solve() {
  std::vector<BlockState> states;
  for (int i = 1; i <= block_.increments; ++i) {
    const double load = static_cast<double>(i) / block_.increments;
    prescribe(load);
    states.push_back(measure(load, newton(load)));
  }
  return states;
}

}  // namespace

std::vector<BlockState> solve_block(const SolidBlock& block) {
  check(block);
  return BlockSolver(block).solve();
}

double uniaxial_stress(double youngs_modulus, double stretch) {
  return youngs_modulus / 3.0 * (stretch - 1.0 / (stretch * stretch));
}

}  // namespace sprung::reference
