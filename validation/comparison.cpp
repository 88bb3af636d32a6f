#include "validation/comparison.hpp"

#include "validation/measures.hpp"
#include "validation/outline_distance.hpp"
#include "validation/same_physics.hpp"
#include "validation/signal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

namespace sprung {

namespace {

/// Two times closer than this are one: solvers land on a probe's times up to round-off.
constexpr double same_time = 1e-6;  // s
/// Two places closer than this are one.
constexpr double same_place = 1e-9;  // m

/// What every part of the comparison looks at.
struct Pair {
  const Answer& reference;
  const Answer& candidate;
  const ErrorBar& error_bar;
  const Acceptance& acceptance;
};

std::optional<double> nearest_time(const RecordReader& record, const std::string& table,
                                   double time) {
  std::vector<double> times;
  try {
    times = record.table_times(table);
  } catch (const std::runtime_error&) {
    return std::nullopt;  // a run that stopped before the first of them
  }
  for (const double t : times) {
    if (std::abs(t - time) < same_time) return t;
  }
  return std::nullopt;
}

/// The times to look at: those that are judged, and those at which the probe was written besides.
std::vector<double> times_of(const Acceptance& acceptance, const std::vector<double>& probe_times) {
  std::vector<double> times = acceptance.judged_at;
  times.insert(times.end(), probe_times.begin(), probe_times.end());
  std::sort(times.begin(), times.end());
  times.erase(
      std::unique(times.begin(), times.end(), [](double a, double b) { return b - a < same_time; }),
      times.end());
  return times;
}

bool is_judged_at(const Acceptance& acceptance, double time) {
  return std::any_of(acceptance.judged_at.begin(), acceptance.judged_at.end(),
                     [&](double t) { return std::abs(t - time) < same_time; });
}

Measurement missing(const std::string& name, const std::string& subject, std::optional<double> time,
                    const std::string& remark) {
  Measurement measurement;
  measurement.measure = name;
  measurement.subject = subject;
  measurement.time = time;
  measurement.remark = remark;
  return measurement;
}

/// The same absence for every measure that would have come of it: a limit on any of them must see
/// it.
void add_missing(std::vector<Measurement>& out, std::initializer_list<const char*> names,
                 const std::string& subject, std::optional<double> time,
                 const std::string& remark) {
  for (const char* name : names) out.push_back(missing(name, subject, time, remark));
}

Measurement taken(const std::string& name, const std::string& subject, std::optional<double> time,
                  double value, std::optional<double> reference_error = std::nullopt) {
  Measurement measurement = missing(name, subject, time, "");
  measurement.value = value;
  measurement.reference_error = reference_error;
  return measurement;
}

std::optional<double> scaled(std::optional<double> error, double scale) {
  return error ? std::optional<double>(*error / scale) : std::nullopt;
}

std::optional<double> root_of_squares(std::optional<double> a, std::optional<double> b) {
  if (!a || !b) return std::nullopt;
  return std::hypot(*a, *b);
}

/// The two tables of one probe at one time, or why there are not two.
struct TablePair {
  const SeriesData* reference = nullptr;
  const SeriesData* candidate = nullptr;
  std::string remark;
};

TablePair tables_at(const Pair& pair, const std::string& probe, double time) {
  const auto there = nearest_time(pair.reference.record, probe, time);
  const auto here = nearest_time(pair.candidate.record, probe, time);
  if (!there) return {nullptr, nullptr, "the reference has no such table at this time"};
  if (!here) return {nullptr, nullptr, "the run has no such table at this time"};
  return {&pair.reference.record.table(probe, *there), &pair.candidate.record.table(probe, *here),
          ""};
}

/// Why two tables cannot be compared row by row; empty if they can.
std::string differing_places(const SeriesData& a, const SeriesData& b, const char* x,
                             const char* y) {
  if (a.rows() != b.rows()) {
    return fmt::format("{} points against the reference's {}", b.rows(), a.rows());
  }
  for (const char* axis : {x, y}) {
    const auto p = a.column(axis), q = b.column(axis);
    for (std::size_t i = 0; i < p.size(); ++i) {
      if (std::abs(p[i] - q[i]) > same_place) return "the two were taken at different places";
    }
  }
  return "";
}

struct ColumnDifference {
  double largest = 0.0;
  double rms = 0.0;
};

ColumnDifference difference_of(const SeriesData& a, const SeriesData& b, const std::string& name) {
  const auto p = a.column(name), q = b.column(name);
  ColumnDifference result;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double d = std::abs(q[i] - p[i]);
    result.largest = std::max(result.largest, d);
    result.rms += d * d;
  }
  result.rms = std::sqrt(result.rms / static_cast<double>(std::max<std::size_t>(1, p.size())));
  return result;
}

/// Peak speed (m/s) of the inflow once its ramp is over, if there is one.
std::optional<double> peak_inlet_speed(const Problem& problem) {
  if (!problem.inflow) return std::nullopt;
  const Inflow& inflow = *problem.inflow;
  const bool vertical = inflow.side == Side::left || inflow.side == Side::right;
  const std::size_t along = vertical ? 1 : 0;
  const double height = problem.channel.to[along] - problem.channel.from[along];
  const double speed = inflow.speed(0.5 * height, height, std::max(inflow.ramp, problem.end_time));
  return speed > 0.0 ? std::optional<double>(speed) : std::nullopt;
}

void compare_profiles(const Pair& pair, std::vector<Measurement>& out) {
  const auto peak = peak_inlet_speed(pair.reference.problem);
  for (const VelocityProfileProbe& probe : pair.reference.problem.probes.velocity_profile) {
    for (const double time : times_of(pair.acceptance, probe.times)) {
      TablePair tables = tables_at(pair, probe.name, time);
      if (tables.remark.empty()) {
        tables.remark = differing_places(*tables.reference, *tables.candidate, "x", "y");
      }
      if (tables.remark.empty() && !peak) tables.remark = "no inflow, so no speed to relate it to";
      if (!tables.remark.empty()) {
        add_missing(
            out,
            {"velocity_difference", "velocity_difference_rms", "velocity_difference_transverse"},
            probe.name, time, tables.remark);
        continue;
      }
      const auto along = difference_of(*tables.reference, *tables.candidate, "velocity_x");
      const auto across = difference_of(*tables.reference, *tables.candidate, "velocity_y");
      const auto error_x = scaled(pair.error_bar.at(probe.name + ".velocity_x", time), *peak);
      const auto error_y = scaled(pair.error_bar.at(probe.name + ".velocity_y", time), *peak);
      out.push_back(taken("velocity_difference", probe.name, time, along.largest / *peak, error_x));
      out.push_back(taken("velocity_difference_rms", probe.name, time, along.rms / *peak, error_x));
      out.push_back(taken("velocity_difference_transverse", probe.name, time,
                          across.largest / *peak, error_y));
    }
  }
}

/// Two columns of a series as signals. Throws std::invalid_argument for one that is no signal.
std::vector<Signal> signals_of(const RecordReader& record, const std::string& series,
                               const std::vector<std::string>& columns) {
  if (!record.has_series(series)) {
    throw std::invalid_argument("a record has no series '" + series + "': it stopped before");
  }
  const SeriesData& data = record.series(series);
  std::vector<Signal> signals;
  for (const std::string& column : columns) {
    signals.emplace_back(data.column("time"), data.column(column));
  }
  return signals;
}

constexpr auto displacement_measures = {"displacement_difference", "displacement_difference_x",
                                        "displacement_difference_y"};
constexpr auto outline_measures = {"outline_distance", "outline_distance_rms",
                                   "outline_distance_relative", "outline_distance_material"};
constexpr auto force_measures = {"force_difference_x", "force_difference_y", "force_scatter"};

void compare_displacement_at(const Pair& pair, const std::string& probe, double time,
                             const std::vector<Signal>& reference,
                             const std::vector<Signal>& candidate, std::vector<Measurement>& out) {
  if (!reference[0].covers(time) || !candidate[0].covers(time)) {
    add_missing(out, displacement_measures, probe, time,
                candidate[0].covers(time) ? "the reference has not come so far"
                                          : "the run has not come so far");
    return;
  }
  const double rx = reference[0].at(time), ry = reference[1].at(time);
  const double cx = candidate[0].at(time), cy = candidate[1].at(time);
  const double length = std::hypot(rx, ry);
  if (!(length > 0.0)) {
    add_missing(out, displacement_measures, probe, time,
                "the reference has not moved: no relative difference");
    return;
  }
  const auto error_x = scaled(pair.error_bar.at(probe + ".displacement_x", time), length);
  const auto error_y = scaled(pair.error_bar.at(probe + ".displacement_y", time), length);
  Measurement whole =
      taken("displacement_difference", probe, time, std::hypot(cx - rx, cy - ry) / length,
            root_of_squares(error_x, error_y));
  whole.candidate = std::hypot(cx, cy);
  whole.reference = length;
  Measurement x = taken("displacement_difference_x", probe, time, (cx - rx) / length, error_x);
  x.candidate = cx;
  x.reference = rx;
  Measurement y = taken("displacement_difference_y", probe, time, (cy - ry) / length, error_y);
  y.candidate = cy;
  y.reference = ry;
  for (Measurement* measurement : {&whole, &x, &y}) {
    measurement->sides_unit = "m";
    out.push_back(*measurement);
  }
}

void compare_histories(const std::string& probe, const std::vector<Signal>& reference,
                       const std::vector<Signal>& candidate, double search,
                       std::vector<Measurement>& out) {
  try {
    out.push_back(taken("displacement_l2", probe, std::nullopt, relative_l2(reference, candidate)));
  } catch (const std::invalid_argument& error) {
    out.push_back(missing("displacement_l2", probe, std::nullopt, error.what()));
  }
  const auto largest = [](const Signal& signal) {
    double most = 0.0;
    for (const double value : signal.value()) most = std::max(most, std::abs(value));
    return most;
  };
  const std::size_t main = largest(reference[0]) >= largest(reference[1]) ? 0 : 1;
  const auto alignment = align(reference[main], candidate[main], search);
  if (!alignment) {
    const std::string remark =
        fmt::format("no best shift within {:.0f} ms of common history", 1e3 * search);
    add_missing(out, {"displacement_lag", "displacement_amplitude_ratio"}, probe, std::nullopt,
                remark);
    return;
  }
  out.push_back(taken("displacement_lag", probe, std::nullopt, alignment->lag));
  out.push_back(
      taken("displacement_amplitude_ratio", probe, std::nullopt, alignment->amplitude_ratio));
}

void compare_displacements(const Pair& pair, std::vector<Measurement>& out) {
  const std::vector<std::string> columns{"displacement_x", "displacement_y"};
  for (const DisplacementProbe& probe : pair.reference.problem.probes.displacement) {
    try {
      const auto reference = signals_of(pair.reference.record, probe.name, columns);
      const auto candidate = signals_of(pair.candidate.record, probe.name, columns);
      for (const double time : times_of(pair.acceptance, pair.reference.problem.probes.all_times)) {
        compare_displacement_at(pair, probe.name, time, reference, candidate, out);
      }
      compare_histories(probe.name, reference, candidate, pair.acceptance.lag_search, out);
    } catch (const std::exception& error) {
      for (const double time : pair.acceptance.judged_at) {
        add_missing(out, displacement_measures, probe.name, time, error.what());
      }
    }
  }
}

std::vector<PlanePoint> points_of(const SeriesData& table, const char* x, const char* y) {
  const auto px = table.column(x), py = table.column(y);
  std::vector<PlanePoint> points(px.size());
  for (std::size_t i = 0; i < px.size(); ++i) points[i] = {px[i], py[i]};
  return points;
}

void compare_outlines(const Pair& pair, std::vector<Measurement>& out) {
  for (const OutlineProbe& probe : pair.reference.problem.probes.outline) {
    for (const double time : times_of(pair.acceptance, probe.times)) {
      TablePair tables = tables_at(pair, probe.name, time);
      if (tables.remark.empty()) {
        tables.remark =
            differing_places(*tables.reference, *tables.candidate, "reference_x", "reference_y");
      }
      if (!tables.remark.empty()) {
        add_missing(out, outline_measures, probe.name, time, tables.remark);
        continue;
      }
      const auto start = points_of(*tables.reference, "reference_x", "reference_y");
      const auto there = points_of(*tables.reference, "x", "y");
      const auto here = points_of(*tables.candidate, "x", "y");
      const OutlineDistance distance = outline_distance(there, here);
      double moved = 0.0;
      for (std::size_t i = 0; i < start.size(); ++i) {
        moved = std::max(moved, std::hypot(there[i][0] - start[i][0], there[i][1] - start[i][1]));
      }
      const auto error = root_of_squares(pair.error_bar.at(probe.name + ".x", time),
                                         pair.error_bar.at(probe.name + ".y", time));
      out.push_back(taken("outline_distance", probe.name, time, distance.largest, error));
      out.push_back(taken("outline_distance_rms", probe.name, time, distance.rms, error));
      out.push_back(moved > 0.0 ? taken("outline_distance_relative", probe.name, time,
                                        distance.largest / moved, scaled(error, moved))
                                : missing("outline_distance_relative", probe.name, time,
                                          "the reference has not moved: no relative distance"));
      out.push_back(
          taken("outline_distance_material", probe.name, time, distance.largest_material, error));
    }
  }
}

void compare_force_at(const Pair& pair, const std::string& probe, double time,
                      const std::vector<Signal>& reference, const std::vector<Signal>& candidate,
                      std::vector<Measurement>& out) {
  const double half = 0.5 * pair.acceptance.force_window;
  const double from = std::max(time - half, reference[0].begin());
  const double to = std::min(time + half, pair.reference.problem.end_time);
  if (!reference[0].covers(to) || !candidate[0].covers(from) || !candidate[0].covers(to)) {
    add_missing(out, force_measures, probe, time, "the window is not within both histories");
    return;
  }
  const WindowMean rx = window_mean(reference[0], from, to),
                   ry = window_mean(reference[1], from, to);
  const WindowMean cx = window_mean(candidate[0], from, to),
                   cy = window_mean(candidate[1], from, to);
  const double length = std::hypot(rx.mean, ry.mean);
  if (!(length > 0.0)) {
    add_missing(out, {"force_difference_x", "force_difference_y"}, probe, time,
                "the reference's mean force vanishes: no relative difference");
  } else {
    Measurement x = taken("force_difference_x", probe, time, (cx.mean - rx.mean) / length,
                          scaled(pair.error_bar.at(probe + ".force_x", time), length));
    x.candidate = cx.mean;
    x.reference = rx.mean;
    Measurement y = taken("force_difference_y", probe, time, (cy.mean - ry.mean) / length,
                          scaled(pair.error_bar.at(probe + ".force_y", time), length));
    y.candidate = cy.mean;
    y.reference = ry.mean;
    for (Measurement* measurement : {&x, &y}) {
      measurement->sides_unit = "N/m";
      out.push_back(*measurement);
    }
  }
  Measurement scatter = taken("force_scatter", probe, time, cx.deviation);
  scatter.candidate = cx.deviation;
  scatter.reference = rx.deviation;
  scatter.sides_unit = "N/m";
  out.push_back(scatter);
}

void compare_forces(const Pair& pair, std::vector<Measurement>& out) {
  for (const ForceProbe& probe : pair.reference.problem.probes.force) {
    try {
      const auto reference = signals_of(pair.reference.record, probe.name, {"force_x", "force_y"});
      const auto candidate = signals_of(pair.candidate.record, probe.name, {"force_x", "force_y"});
      for (const double time : pair.acceptance.judged_at) {
        compare_force_at(pair, probe.name, time, reference, candidate, out);
      }
    } catch (const std::exception& error) {
      for (const double time : pair.acceptance.judged_at) {
        add_missing(out, force_measures, probe.name, time, error.what());
      }
    }
  }
}

double largest_amount(const std::vector<double>& values, double from = 0.0) {
  double most = 0.0;
  for (const double value : values) most = std::max(most, std::abs(value - from));
  return most;
}

/// A column of a ledger, reduced to one number, for either side; what is not there stays empty.
template <typename Reduce>
std::optional<double> reduced(const RecordReader& record, const std::string& ledger,
                              const std::string& column, Reduce reduce) {
  if (!record.has_series(ledger)) return std::nullopt;
  const SeriesData& data = record.series(ledger);
  const bool there = std::any_of(data.columns.begin(), data.columns.end(),
                                 [&](const Column& c) { return c.name == column; });
  if (!there || data.rows() == 0) return std::nullopt;
  return reduce(data.column(column));
}

Measurement from_ledgers(const std::string& name, const std::string& subject,
                         std::optional<double> candidate, std::optional<double> reference) {
  Measurement measurement =
      missing(name, subject, std::nullopt, candidate ? "" : "not in this run's record");
  measurement.value = candidate;
  measurement.candidate = candidate;
  measurement.reference = reference;
  measurement.sides_unit = measure(name).unit;
  return measurement;
}

void compare_balances(const Pair& pair, std::vector<Measurement>& out) {
  const Box& channel = pair.reference.problem.channel;
  const double area = (channel.to[0] - channel.from[0]) * (channel.to[1] - channel.from[1]);
  const auto both = [&](const std::string& name, const std::string& ledger,
                        const std::string& column, auto reduce) {
    out.push_back(from_ledgers(name, ledger, reduced(pair.candidate.record, ledger, column, reduce),
                               reduced(pair.reference.record, ledger, column, reduce)));
  };
  both("excess_outflow", "ledger_mass", "excess_outflow",
       [&](const std::vector<double>& v) { return largest_amount(v) / area; });
  both("divergence_rms", "ledger_divergence", "rms_divergence", [](const std::vector<double>& v) {
    double sum = 0.0;
    for (const double value : v) sum += value;
    return sum / static_cast<double>(v.size());
  });
  if (!pair.reference.problem.solids.empty()) {
    both("solid_area_change", "ledger_solid", "area_ratio",
         [](const std::vector<double>& v) { return largest_amount(v, 1.0); });
    both("solid_max_stretch", "ledger_solid", "max_stretch",
         [](const std::vector<double>& v) { return largest_amount(v); });
  }

  const RecordReader& record = pair.candidate.record;
  out.push_back(from_ledgers("particle_drift", "ledger_mass",
                             reduced(record, "ledger_mass", "particles",
                                     [](const std::vector<double>& v) {
                                       return largest_amount(v, v.front()) / v.front();
                                     }),
                             std::nullopt));
  const auto gain = [](const std::vector<double>& v) { return v.back() - v.front(); };
  const auto grown = reduced(record, "ledger_mass", "particles", gain);
  const auto created = reduced(record, "ledger_mass", "created", gain);
  const auto removed = reduced(record, "ledger_mass", "removed", gain);
  const auto counted =
      reduced(record, "ledger_mass", "lost", [](const std::vector<double>& v) { return v.back(); });
  std::optional<double> lost;
  if (grown && created && removed && counted) {
    lost = *counted + std::abs(*created - *removed - *grown);
  }
  out.push_back(from_ledgers("lost_particles", "ledger_mass", lost, std::nullopt));
}

void compare_costs(const Pair& pair, std::vector<Measurement>& out) {
  const auto seconds = [](const RecordReader& record, const char* name) -> std::optional<double> {
    try {
      return record.manifest_number(name);
    } catch (const std::runtime_error&) {
      return std::nullopt;
    }
  };
  for (const auto& [name, entry] :
       {std::pair{"processor_time", "processor_seconds"}, std::pair{"wall_time", "wall_seconds"}}) {
    out.push_back(from_ledgers(name, "manifest", seconds(pair.candidate.record, entry),
                               seconds(pair.reference.record, entry)));
  }
}

/// A limit that met no measurement must not pass unseen.
void add_unmet_limits(const PlannedRun& plan, std::vector<Measurement>& out) {
  for (const auto& [name, limit] : plan.limits) {
    const std::string& wanted = name;
    if (std::any_of(out.begin(), out.end(),
                    [&wanted](const Measurement& m) { return m.limit && m.measure == wanted; })) {
      continue;
    }
    Measurement unmet = missing(name, "", std::nullopt, "nothing in this scene measures it");
    unmet.limit = limit.value;
    unmet.because = limit.because;
    unmet.verdict = Verdict::not_judged;
    out.push_back(unmet);
  }
}

/// What was measured over part of the run only cannot pass for the whole of it.
void withdraw_passes_of_the_whole(double reached, double end, std::vector<Measurement>& out) {
  for (Measurement& measurement : out) {
    if (measurement.time || measurement.verdict != Verdict::pass) continue;
    measurement.verdict = Verdict::not_judged;
    measurement.remark = fmt::format("the run came to {:.4g} s of {:.4g} s only", reached, end);
  }
}

double time_reached(const RecordReader& record) {
  for (const char* ledger : {"ledger_mass", "ledger_energy"}) {
    if (record.has_series(ledger) && record.series(ledger).rows() > 0) {
      return record.series(ledger).column("time").back();
    }
  }
  return 0.0;
}

}  // namespace

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::pass:
      return "pass";
    case Verdict::fail:
      return "fail";
    case Verdict::not_judged:
      return "not judged";
    case Verdict::reported:
      return "reported";
  }
  return "";
}

void judge(Measurement& measurement, const Acceptance& acceptance, const PlannedRun* plan) {
  const Measure& kind = measure(measurement.measure);
  if (kind.against_reference && !measurement.reference_error) {
    const auto stated = acceptance.reference_error.find(measurement.measure);
    if (stated != acceptance.reference_error.end()) {
      measurement.reference_error = stated->second.value;
    }
  }
  measurement.verdict = Verdict::reported;
  if (measurement.time && !is_judged_at(acceptance, *measurement.time)) return;
  if (plan == nullptr || !plan->limits.contains(measurement.measure)) return;
  const StatedValue& limit = plan->limits.at(measurement.measure);
  measurement.limit = limit.value;
  measurement.because = limit.because;
  measurement.verdict = Verdict::not_judged;
  if (!measurement.value) return;  // the remark already says why
  if (kind.against_reference && !measurement.reference_error) {
    measurement.remark = "the reference's own error is not known here";
    return;
  }
  const double amount = std::abs(*measurement.value);
  const double error = kind.against_reference ? *measurement.reference_error : 0.0;
  if (amount + error <= limit.value) {
    measurement.verdict = Verdict::pass;
  } else if (amount - error > limit.value) {
    measurement.verdict = Verdict::fail;
  } else {
    measurement.remark = "the limit lies within the reference's error bar";
  }
}

Answer Answer::read(const std::filesystem::path& folder) {
  RecordReader record(folder);
  const std::string scene = record.manifest_text("scene_toml");
  const std::string name = (folder / "manifest.json").string() + " (scene_toml)";
  return {std::move(record), read_problem(Document::from_text(scene, name))};
}

bool RunComparison::accepted() const {
  return std::all_of(measurements.begin(), measurements.end(), [](const Measurement& m) {
    return m.verdict == Verdict::pass || m.verdict == Verdict::reported;
  });
}

RunComparison compare(const Answer& reference, const Answer& candidate, const ErrorBar& error_bar,
                      const Acceptance& acceptance, const std::string& run) {
  const std::string outcome = reference.record.manifest_text("outcome");
  if (outcome != "finished") {
    throw std::runtime_error(reference.record.folder().string() +
                             ": the reference did not finish (" + outcome + "); run it to its end");
  }
  if (const auto difference = first_difference(reference.problem, candidate.problem)) {
    throw std::runtime_error(candidate.record.folder().string() +
                             ": not the reference's problem; it differs in " + *difference);
  }
  RunComparison result;
  result.run = run;
  result.folder = candidate.record.folder();
  result.outcome = candidate.record.manifest_text("outcome");
  result.reached = time_reached(candidate.record);

  const Pair pair{reference, candidate, error_bar, acceptance};
  compare_profiles(pair, result.measurements);
  compare_displacements(pair, result.measurements);
  compare_outlines(pair, result.measurements);
  compare_forces(pair, result.measurements);
  compare_balances(pair, result.measurements);
  compare_costs(pair, result.measurements);
  const PlannedRun* plan = acceptance.run(run);
  for (Measurement& measurement : result.measurements) judge(measurement, acceptance, plan);
  if (plan != nullptr) add_unmet_limits(*plan, result.measurements);
  if (result.outcome != "finished") {
    withdraw_passes_of_the_whole(result.reached, reference.problem.end_time, result.measurements);
  }
  return result;
}

}  // namespace sprung
