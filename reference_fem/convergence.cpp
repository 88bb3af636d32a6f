#include "reference_fem/convergence.hpp"

#include "scene/progress.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>

namespace sprung::reference {
namespace {

namespace fs = std::filesystem;

constexpr double safety = 1.25;  // Roache's for three meshes

struct Scene {
  Document document;
  Problem problem;
  Settings settings;
};

Scene read_scene(const fs::path& file, const std::vector<std::string>& overrides) {
  Document document(file, overrides);
  Problem problem = read_problem(document);
  Settings settings = read_settings(document, problem);
  document.refuse_unread();
  return {std::move(document), std::move(problem), std::move(settings)};
}

/// Overrides that scale the mesh by a power of two (`finer` > 0: smaller cells from the same Gmsh
/// mesh) and the time step by `step`.
std::vector<std::string> scaled(const Settings& s, int finer, double step) {
  const double size = std::pow(2.0, -finer);
  return {fmt::format("reference_fem.cell_size={:.12g} m", size * s.sizes.bulk),
          fmt::format("reference_fem.clamp_corner_size={:.12g} m", size * s.sizes.clamp_corner),
          fmt::format("reference_fem.free_corner_size={:.12g} m", size * s.sizes.free_corner),
          fmt::format("reference_fem.face_size={:.12g} m", size * s.sizes.face),
          fmt::format("reference_fem.splittings={}", s.sizes.splittings + finer),
          fmt::format("reference_fem.time_step={:.12g} s", step * s.time_step),
          fmt::format("reference_fem.largest_time_step={:.12g} s", step * s.largest_time_step)};
}

/// The record of a scene in `options.out`: run now, or, when resuming, taken up where it stands.
RecordReader obtain(const Scene& scene, RunOptions options) {
  if (options.resume) {
    options.resume = false;
    if (fs::exists(options.out / "manifest.json")) {
      const RecordReader there(options.out);
      if (there.manifest_text("scene_toml") == scene.document.resolved_toml()) {
        if (there.manifest_text("outcome") == "finished") return there;
        options.resume = true;
      }
    }
    options.overwrite = !options.resume;
  }
  run(scene.document, scene.problem, scene.settings, options);
  return RecordReader(options.out);
}

/// Five records: base, and twice as coarse and as fine in space and in time.
struct Family {
  RecordReader base, mesh_coarse, mesh_fine, step_coarse, step_fine;
};

Family run_family(const fs::path& file, const std::vector<std::string>& overrides,
                  const RunOptions& options) {
  const Scene base = read_scene(file, overrides);
  if (base.settings.sizes.splittings < 1)
    base.document.table("reference_fem")
        .refuse("splittings",
                "must be at least 1 for --converge: the coarse mesh is the one before the last "
                "splitting");
  const auto variant = [&](const std::string& name, int finer, double step) {
    std::vector<std::string> all = overrides;
    for (const auto& o : scaled(base.settings, finer, step)) all.push_back(o);
    RunOptions mine = options;
    mine.out = options.out / "convergence" / name;
    mine.label = "reference, " + name;
    // A variant's folder holds nothing but what this program puts there.
    mine.overwrite = true;
    return obtain(read_scene(file, all), mine);
  };
  RecordReader base_record = obtain(base, options);
  return {std::move(base_record), variant("mesh_coarse", -1, 1.0), variant("mesh_fine", 1, 1.0),
          variant("step_coarse", 0, 2.0), variant("step_fine", 0, 0.5)};
}

/// Values of one column at one time: one number of a series, or a whole line of a table.
using Values = std::vector<double>;

Values series_value(const RecordReader& record, const std::string& series,
                    const std::string& column, double time) {
  const SeriesData& data = record.series(series);
  const auto times = data.column("time"), values = data.column(column);
  for (std::size_t i = 0; i < times.size(); ++i)
    if (std::abs(times[i] - time) < 1e-9 * (1.0 + time)) return {values[i]};
  throw std::runtime_error(
      fmt::format("{}: {} has no row at t = {} s", record.folder().string(), series, time));
}

struct Quantity {
  std::string name, unit;
  double time = 0.0;
  Values base, mesh_coarse, mesh_fine, step_coarse, step_fine;
};

template <typename Read>
Quantity collect(const Family& f, const std::string& name, const std::string& unit, double time,
                 const Read& read) {
  return {name,
          unit,
          time,
          read(f.base),
          read(f.mesh_coarse),
          read(f.mesh_fine),
          read(f.step_coarse),
          read(f.step_fine)};
}

std::vector<Quantity> quantities(const Family& family, const Problem& problem) {
  std::vector<Quantity> all;
  std::vector<double> times = problem.probes.all_times;
  if (times.empty() || times.back() < problem.end_time * (1 - 1e-9))
    times.push_back(problem.end_time);
  const auto from_series = [&](const std::string& series, const std::string& column,
                               const char* unit) {
    for (const double t : times)
      all.push_back(collect(family, series + "." + column, unit, t, [&](const RecordReader& r) {
        return series_value(r, series, column, t);
      }));
  };
  const auto from_table = [&](const std::string& table, const std::string& column, const char* unit,
                              const std::vector<double>& at) {
    for (const double t : at)
      all.push_back(collect(family, table + "." + column, unit, t, [&](const RecordReader& r) {
        return r.table(table, t).column(column);
      }));
  };
  for (const auto& probe : problem.probes.displacement) {
    from_series(probe.name, "displacement_x", "m");
    from_series(probe.name, "displacement_y", "m");
  }
  for (const auto& probe : problem.probes.force) {
    from_series(probe.name, "force_x", "N/m");
    from_series(probe.name, "force_y", "N/m");
  }
  for (const auto& probe : problem.probes.velocity_profile) {
    from_table(probe.name, "velocity_x", "m/s", probe.times);
    from_table(probe.name, "velocity_y", "m/s", probe.times);
  }
  for (const auto& probe : problem.probes.outline) {
    from_table(probe.name, "x", "m", probe.times);
    from_table(probe.name, "y", "m", probe.times);
  }
  return all;
}

/// What three discretisations say about a quantity, a line of values taken together: the order from
/// the norms of the differences, the errors the largest along the line.
struct Verdict {
  Extrapolation extrapolation;
  double largest_value = 0.0;
};

Verdict judge(const Values& coarse, const Values& middle, const Values& fine, double highest) {
  if (middle.size() == 1)
    return {extrapolate(coarse[0], middle[0], fine[0], highest), std::abs(middle[0])};
  double first = 0.0, second = 0.0, largest = 0.0, value = 0.0;
  for (std::size_t i = 0; i < middle.size(); ++i) {
    first += std::pow(middle[i] - coarse[i], 2);
    second += std::pow(fine[i] - middle[i], 2);
    largest = std::max(largest, std::abs(fine[i] - middle[i]));
    value = std::max(value, std::abs(middle[i]));
  }
  // Norms as if they were the differences of one number.
  Extrapolation e =
      extrapolate(0.0, std::sqrt(first), std::sqrt(first) + std::sqrt(second), highest);
  const double ratio = std::pow(2.0, e.order);
  e.error_of_middle = safety * largest * ratio / (ratio - 1.0);
  e.index_of_finest = safety * largest / (ratio - 1.0);
  return {e, value};
}

nlohmann::json number_or_null(const std::optional<double>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json(nullptr);
}

void write_whole(const fs::path& file, const std::string& text) {
  const fs::path part = file.string() + ".part";
  std::ofstream out(part);
  out << text;
  out.close();
  if (!out) throw std::runtime_error(part.string() + ": cannot be written");
  fs::rename(part, file);
}

/// What is reported of one quantity.
struct Line {
  const Quantity& quantity;
  Verdict mesh, step;
  double error = 0.0;
  std::optional<double> value, limit;  ///< none where the quantity is a line of values
};

Line line_of(const Quantity& q, const Settings& settings) {
  Line line{.quantity = q,
            .mesh = judge(q.mesh_coarse, q.base, q.mesh_fine, settings.degree + 1.0),
            .step = judge(q.step_coarse, q.base, q.step_fine, settings.scheme.order),
            .error = 0.0,
            .value = {},
            .limit = {}};
  line.error = line.mesh.extrapolation.error_of_middle + line.step.extrapolation.error_of_middle;
  if (q.base.size() == 1) {
    line.value = q.base[0];
    line.limit = line.mesh.extrapolation.limit + line.step.extrapolation.limit - q.base[0];
  }
  return line;
}

std::string text(const std::optional<double>& x, const char* format) {
  return x ? fmt::format(fmt::runtime(format), *x) : std::string("-");
}

void print(const Line& l) {
  const Extrapolation &mesh = l.mesh.extrapolation, &step = l.step.extrapolation;
  fmt::print("{:<22}{:>7.4g}{:>14}{:>14}{:>12.3e}{:>9.3f}{:>8}{:>8}{:>11.3e}\n", l.quantity.name,
             l.quantity.time, text(l.value, "{:.6e}"), text(l.limit, "{:.6e}"), l.error,
             100.0 * l.error / l.mesh.largest_value, text(mesh.observed_order, "{:.2f}"),
             text(step.observed_order, "{:.2f}"), mesh.index_of_finest);
}

std::string csv_row(const Line& l) {
  const Extrapolation &mesh = l.mesh.extrapolation, &step = l.step.extrapolation;
  return fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", l.quantity.name, l.quantity.unit,
                     l.quantity.time, text(l.value, "{:.12g}"), text(l.limit, "{:.12g}"), l.error,
                     mesh.error_of_middle, step.error_of_middle,
                     text(mesh.observed_order, "{:.4g}"), text(step.observed_order, "{:.4g}"),
                     mesh.index_of_finest);
}

nlohmann::json entry(const Line& l) {
  const Extrapolation &mesh = l.mesh.extrapolation, &step = l.step.extrapolation;
  return {{"name", l.quantity.name},
          {"unit", l.quantity.unit},
          {"time", l.quantity.time},
          {"error", l.error},
          {"value", number_or_null(l.value)},
          {"extrapolated", number_or_null(l.limit)},
          {"largest_value", l.mesh.largest_value},
          {"mesh_error", mesh.error_of_middle},
          {"step_error", step.error_of_middle},
          {"observed_order", number_or_null(mesh.observed_order)},
          {"observed_order_step", number_or_null(step.observed_order)},
          {"grid_convergence_index_finest", mesh.index_of_finest}};
}

/// What each run of the family was and cost, printed and returned.
nlohmann::json describe_runs(const Family& family) {
  nlohmann::json runs = nlohmann::json::array();
  const std::array<std::pair<const char*, const RecordReader*>, 5> all = {
      {{"this run", &family.base},
       {"mesh_coarse", &family.mesh_coarse},
       {"mesh_fine", &family.mesh_fine},
       {"step_coarse", &family.step_coarse},
       {"step_fine", &family.step_fine}}};
  for (const auto& [name, record] : all) {
    const double cells = record->manifest_number("cells"),
                 unknowns = record->manifest_number("unknowns");
    const double step = record->manifest_number("time_step");
    const double seconds = record->manifest_number("processor_seconds");
    fmt::print(
        "{:<12} {:>7.0f} cells {:>8.0f} unknowns  step {:.4g} s  {:>8.1f} s of processor time\n",
        name, cells, unknowns, step, seconds);
    runs.push_back({{"name", name},
                    {"cells", cells},
                    {"unknowns", unknowns},
                    {"time_step", step},
                    {"processor_seconds", seconds}});
  }
  return runs;
}

/// Table on standard output, error_bar.csv and error_bar.json in `folder`.
void report(const std::vector<Quantity>& all, const Settings& settings, const Family& family,
            const fs::path& folder) {
  nlohmann::json list = nlohmann::json::array();
  std::string csv =
      "name,unit,time [s],value,extrapolated,error,mesh_error,step_error,"
      "observed_order_mesh,observed_order_step,grid_convergence_index_finest\n";
  fmt::print("{:<22}{:>7}{:>14}{:>14}{:>12}{:>9}{:>8}{:>8}{:>11}\n", "quantity", "t [s]", "value",
             "extrapolated", "error", "error %", "p mesh", "p step", "GCI finest");
  for (const Quantity& quantity : all) {
    const Line line = line_of(quantity, settings);
    print(line);
    csv += csv_row(line);
    list.push_back(entry(line));
  }
  const nlohmann::json whole = {
      {"format", "sprung error bar 1"},
      {"method",
       "Richardson extrapolation from nested meshes 2h, h, h/2 and steps 2dt, dt, dt/2; error: "
       "1.25 times the distance of this run from the limit, mesh and step added; an order below "
       "one or without one sign counts as first"},
      {"runs", describe_runs(family)},
      {"quantities", list}};
  write_whole(folder / "error_bar.csv", csv);
  write_whole(folder / "error_bar.json", whole.dump(1) + "\n");
}

}  // namespace

Extrapolation extrapolate(double coarse, double middle, double fine, double highest) {
  const double first = middle - coarse, second = fine - middle;
  Extrapolation e;
  if (first * second > 0.0 && std::abs(first) > std::abs(second))
    e.observed_order = std::log2(first / second);
  e.order = std::clamp(e.observed_order.value_or(1.0), 1.0, highest);
  const double ratio = std::pow(2.0, e.order);
  // Differences that change sign: the limit lies among them, the bar spans what first order would.
  const bool one_sign = first * second >= 0.0;
  e.limit = one_sign ? fine + second / (ratio - 1.0) : fine;
  e.error_of_middle = safety * std::abs(second) * ratio / (ratio - 1.0);
  e.index_of_finest = safety * std::abs(second) / (ratio - 1.0);
  return e;
}

void run_convergence(const fs::path& file, const std::vector<std::string>& overrides,
                     const RunOptions& options) {
  if (options.until > 0.0)
    throw std::runtime_error("--converge runs to the scene's end: leave --until away");
  const Scene base = read_scene(file, overrides);
  std::error_code ignored;
  // An old bar must not stand beside a new record.
  fs::remove(options.out / "error_bar.json", ignored);
  fs::remove(options.out / "error_bar.csv", ignored);
  const Family family = run_family(file, overrides, options);
  report(quantities(family, base.problem), base.settings, family, options.out);
}

}  // namespace sprung::reference
