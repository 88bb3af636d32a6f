#include "validation/acceptance.hpp"

#include "validation/measures.hpp"

#include <algorithm>

namespace sprung {

namespace {

std::vector<std::string> names_of_measures() {
  std::vector<std::string> names;
  for (const Measure& entry : measures()) names.emplace_back(entry.name);
  return names;
}

bool is_table(const Table& table, const std::string& key) {
  const auto names = table.table_names();
  return std::find(names.begin(), names.end(), key) != names.end();
}

/// The leaves of an overlay of the scene as overrides, "numerics.preset=paper".
void collect_overrides(const Table& table, const std::string& prefix,
                       std::vector<std::string>& overrides) {
  for (const std::string& key : table.keys()) {
    if (!is_table(table, key)) overrides.push_back(prefix + key + "=" + table.text(key));
  }
  for (const std::string& name : table.table_names()) {
    collect_overrides(table.table(name), prefix + name + ".", overrides);
  }
}

/// { KEY = 0.03, because = "..." } for each measure named in `table`.
std::map<std::string, StatedValue> read_stated(const Table& table, const std::string& key) {
  std::map<std::string, StatedValue> stated;
  const auto known = names_of_measures();
  for (const std::string& name : table.table_names()) {
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      std::string all;
      for (const std::string& word : known) all += (all.empty() ? "" : ", ") + word;
      table.refuse(name, "there is no such measure; write one of " + all);
    }
    const Table entry = table.table(name);
    const std::string unit = measure(name).unit;
    StatedValue value;
    if (unit == "s") {
      value.value = entry.quantity(key, dimension::time);
    } else if (unit == "m") {
      value.value = entry.quantity(key, dimension::length);
    } else {
      value.value = entry.number(key);
    }
    if (value.value < 0.0)
      entry.refuse(key, "a limit or an error is not negative; amounts are judged");
    value.because = entry.text("because");
    stated.emplace(name, value);
  }
  return stated;
}

PlannedRun read_run(const Table& table, const std::string& name) {
  PlannedRun run;
  run.name = name;
  if (table.has("scene")) collect_overrides(table.table("scene"), "", run.overrides);
  if (table.has("time_limit")) run.time_limit = table.quantity("time_limit", dimension::time);
  if (table.has("limits")) run.limits = read_stated(table.table("limits"), "at_most");
  return run;
}

}  // namespace

const PlannedRun* Acceptance::run(const std::string& name) const {
  for (const PlannedRun& entry : runs) {
    if (entry.name == name) return &entry;
  }
  return nullptr;
}

Acceptance read_acceptance(const Document& document, const std::string& level) {
  Acceptance acceptance;
  acceptance.title = document.root().text("title");
  const Table measured = document.table("measure");
  acceptance.judged_at = measured.quantities("judged_at", dimension::time);
  if (!std::is_sorted(acceptance.judged_at.begin(), acceptance.judged_at.end())) {
    measured.refuse("judged_at", "write the times in ascending order");
  }
  acceptance.force_window = measured.quantity("force_window", dimension::time);
  acceptance.lag_search = measured.quantity("lag_search", dimension::time);

  const Table chosen = document.table(level);
  if (chosen.has("reference")) {
    const Table reference = chosen.table("reference");
    acceptance.reference = read_run(reference, "reference");
    if (reference.flag_or("converge", false)) acceptance.reference.options = {"--converge"};
  }
  const Table runs = chosen.table("run");
  for (const std::string& name : runs.table_names()) {
    acceptance.runs.push_back(read_run(runs.table(name), name));
  }
  if (chosen.has("reference_error")) {
    acceptance.reference_error = read_stated(chosen.table("reference_error"), "is");
  }
  return acceptance;
}

Acceptance read_acceptance(const std::filesystem::path& file, const std::string& level) {
  Document document(file);
  const std::vector<std::string> levels{"full", "quick"};
  // Every level is read, whichever is wanted: a slip in the other one is found now, not by its
  // user.
  Acceptance wanted;
  for (const std::string& name : levels) {
    Acceptance acceptance = read_acceptance(document, name);
    if (name == level) wanted = std::move(acceptance);
  }
  if (std::find(levels.begin(), levels.end(), level) == levels.end()) {
    throw SceneError("there is no level '" + level + "'; write full or quick");
  }
  document.refuse_unread();
  return wanted;
}

}  // namespace sprung
