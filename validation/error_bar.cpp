#include "validation/error_bar.hpp"

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace sprung {

namespace {

std::optional<double> number_at(const nlohmann::json& entry, const char* key) {
  const auto found = entry.find(key);
  if (found == entry.end() || !found->is_number()) return std::nullopt;
  return found->get<double>();
}

}  // namespace

ErrorBar::ErrorBar(const std::filesystem::path& file) {
  const std::string name = file.string();
  std::ifstream in(file);
  if (!in) throw std::runtime_error(name + ": cannot be read");
  nlohmann::json content;
  try {
    content = nlohmann::json::parse(in);
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(name + ": not valid JSON: " + error.what());
  }
  const auto quantities = content.find("quantities");
  if (quantities == content.end() || !quantities->is_array()) {
    throw std::runtime_error(name + ": has no list \"quantities\"");
  }
  for (const auto& entry : *quantities) {
    const auto time = number_at(entry, "time"), error = number_at(entry, "error");
    const auto label = entry.find("name");
    if (label == entry.end() || !label->is_string() || !time || !error) {
      throw std::runtime_error(name + ": an entry lacks name, time or error: " + entry.dump());
    }
    if (!std::isfinite(*error) || *error < 0.0) {
      throw std::runtime_error(name + ": an error bar is negative or not finite: " + entry.dump());
    }
    entries_.push_back({label->get<std::string>(), *time, *error, number_at(entry, "extrapolated"),
                        number_at(entry, "observed_order")});
  }
}

std::optional<double> ErrorBar::at(const std::string& quantity, double time) const {
  for (const ReferenceError& entry : entries_) {
    if (entry.quantity == quantity && std::abs(entry.time - time) < 1e-6) return entry.error;
  }
  return std::nullopt;
}

}  // namespace sprung
