/// Turek and Hron's benchmarks in their steady forms, from the scenes of validation/turek_hron:
/// flow, structure, and both. The unsteady ones are judged from their kept records
/// (records_test.py).

#include "reference_fem/convergence.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace sprung::reference {
namespace {

// Published values: Turek and Hron 2006, tables of CFD1, CFD2, CSM1, CSM2 and FSI1.
// Tolerance 0.5 %: issue 5's figure for these cases.
constexpr double allowed = 0.005;

struct Result {
  Vec2 force{}, tip{};
  int unknowns = 0;
};

/// Marches a scene to its steady state with strongly damped steps.
/// `level` halves the cells that often; below 0 it doubles them.
Result steady(const std::string& name, int level, const std::vector<std::string>& further = {}) {
  const double cell = 33.4 * std::pow(2.0, -level);
  const int splittings = std::max(0, level);
  std::vector<std::string> overrides = {"reference_fem.cell_size=" + std::to_string(cell) + " mm",
                                        "reference_fem.splittings=" + std::to_string(splittings),
                                        "reference_fem.newton_tolerance=1e-7"};
  overrides.insert(overrides.end(), further.begin(), further.end());
  Document document(SPRUNG_TUREK_HRON + ("/" + name + ".toml"), overrides);
  const Problem problem = read_problem(document);
  Simulation simulation(problem, read_settings(document, problem));
  for (const double event : simulation.events())
    while (simulation.state().time < event) simulation.advance(event);
  FluidStructure& system = simulation.system();
  const Fields& fields = simulation.state().now;
  const StageWeights& weights = simulation.integration().weights();
  Result result;
  for (std::size_t i = 0; i < problem.curved_walls.size(); ++i)
    for (std::size_t d = 0; d < 2; ++d)
      result.force[d] += system.force_on_wall(static_cast<int>(i), fields, weights)[d];
  if (!problem.solids.empty()) {
    for (std::size_t d = 0; d < 2; ++d) result.force[d] += system.force_on(1, fields, weights)[d];
    const std::vector<double> rest(fields.displacement.size(), 0.0);
    result.tip = evaluate(system.space(), fields.displacement,
                          Locator(system.space(), rest).find({0.6, 0.2}, 1));
  }
  result.unknowns = system.velocity_unknowns() + system.pressure_unknowns();
  return result;
}

double percent(double found, double published) {
  return 100.0 * (found / published - 1.0);
}

/// A value on meshes whose cells are twice, once and half as large.
void judge(const char* what, double published, double coarse, double middle, double fine) {
  const Extrapolation e = extrapolate(coarse, middle, fine, 4.0);
  std::printf(
      "%-10s published %12.6g found %12.6g (%+.3f %%), extrapolated %12.6g (%+.3f %%), "
      "order %.2f\n",
      what, published, fine, percent(fine, published), e.limit, percent(e.limit, published),
      e.observed_order.value_or(NAN));
  EXPECT_NEAR(fine, published, allowed * std::abs(published)) << what;
  EXPECT_NEAR(e.limit, published, allowed * std::abs(published)) << what << ", extrapolated";
}

TEST(TurekHron, CFD1) {
  const Result r[3] = {steady("cfd1", 0), steady("cfd1", 1), steady("cfd1", 2)};
  judge("drag", 14.2929, r[0].force[0], r[1].force[0], r[2].force[0]);
  judge("lift", 1.11905, r[0].force[1], r[1].force[1], r[2].force[1]);
}

TEST(TurekHron, CFD2) {
  const Result r[3] = {steady("cfd2", 0), steady("cfd2", 1), steady("cfd2", 2)};
  judge("drag", 136.700, r[0].force[0], r[1].force[0], r[2].force[0]);
  judge("lift", 10.5343, r[0].force[1], r[1].force[1], r[2].force[1]);
}

TEST(TurekHron, CSM1) {
  const Result r[3] = {steady("csm1", 0), steady("csm1", 1), steady("csm1", 2)};
  judge("ux", -7.1877e-3, r[0].tip[0], r[1].tip[0], r[2].tip[0]);
  judge("uy", -66.1023e-3, r[0].tip[1], r[1].tip[1], r[2].tip[1]);
}

TEST(TurekHron, CSM2) {
  const Result r[3] = {steady("csm2", 0), steady("csm2", 1), steady("csm2", 2)};
  judge("ux", -0.46900e-3, r[0].tip[0], r[1].tip[0], r[2].tip[0]);
  judge("uy", -16.9739e-3, r[0].tip[1], r[1].tip[1], r[2].tip[1]);
}

TEST(TurekHron, FSI1) {
  const Result r[3] = {steady("fsi1", -1), steady("fsi1", 0), steady("fsi1", 1)};
  judge("ux", 0.0227e-3, r[0].tip[0], r[1].tip[0], r[2].tip[0]);
  judge("uy", 0.8209e-3, r[0].tip[1], r[1].tip[1], r[2].tip[1]);
  judge("drag", 14.295, r[0].force[0], r[1].force[0], r[2].force[0]);
  judge("lift", 0.7638, r[0].force[1], r[1].force[1], r[2].force[1]);
}

TEST(TurekHron, FSI1WithoutBlocks) {
  // What bends the flag is a pressure difference of 1 Pa between its sides, of 40 Pa on either, so
  // the corners of its end, where pressure is singular, must be resolved better than on the blocks,
  // which are alike above and below and whose errors cancel: with cubic elements uy is 1.3 % too
  // small with corners of 1.7 mm.
  const Result r = steady("fsi1", 0,
                          {"reference_fem.mesh=unstructured", "reference_fem.degree=3",
                           "reference_fem.free_corner_size=0.1 mm"});
  std::printf("unstructured, %d unknowns: ux %.5e, uy %.5e, drag %.5f, lift %.5f\n", r.unknowns,
              r.tip[0], r.tip[1], r.force[0], r.force[1]);
  EXPECT_NEAR(r.tip[0], 0.0227e-3, allowed * 0.0227e-3);
  EXPECT_NEAR(r.tip[1], 0.8209e-3, allowed * 0.8209e-3);
  EXPECT_NEAR(r.force[0], 14.295, allowed * 14.295);
  EXPECT_NEAR(r.force[1], 0.7638, allowed * 0.7638);
}

}  // namespace
}  // namespace sprung::reference
