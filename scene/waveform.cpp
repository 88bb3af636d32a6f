#include "scene/waveform.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace sprung {

Waveform Waveform::from_formula(const std::string& text) {
  Waveform waveform;
  waveform.formula_.emplace(text, std::vector<std::string>{"t"});
  if (!std::isfinite(waveform.formula_->value(std::array{0.0})))
    throw FormulaError("the formula has no finite value at t = 0; write one that has");
  return waveform;
}

Waveform Waveform::from_file(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file.string() + ": cannot be opened");
  Waveform waveform;
  std::string line;
  const auto refuse = [&](int number, const std::string& reason) {
    throw std::runtime_error(file.string() + ":" + std::to_string(number) + ": \"" + line +
                             "\": " + reason);
  };
  std::getline(in, line);
  double sample = 0.0;
  if (std::istringstream(line) >> sample)
    refuse(1, "a number in the place of the header; write a header line above the samples");
  for (int number = 2; std::getline(in, line); ++number) {
    std::string cells = line;
    std::replace(cells.begin(), cells.end(), ',', ' ');
    if (cells.find_first_not_of(" \t\r") == std::string::npos) continue;
    std::istringstream text(cells);
    double time = 0.0, factor = 0.0;
    std::string more;
    if (!(text >> time >> factor) || (text >> more) || !std::isfinite(time * factor))
      refuse(number, "not a time in s and a factor; write two numbers");
    if (!waveform.times_.empty() && !(time > waveform.times_.back()))
      refuse(number, "times must ascend");
    waveform.times_.push_back(time);
    waveform.factors_.push_back(factor);
  }
  if (waveform.times_.empty())
    throw std::runtime_error(file.string() +
                             ": holds no sample; write a header line, then a time in s and a "
                             "factor on each line");
  return waveform;
}

double Waveform::value(double time) const {
  if (formula_) {
    const double value = formula_->value(std::array{time});
    if (!std::isfinite(value))
      throw std::runtime_error("the waveform \"" + formula_->text() +
                               "\" has no finite value at t = " + std::to_string(time) + " s");
    return value;
  }
  if (times_.empty()) return 1.0;
  const auto next = std::upper_bound(times_.begin(), times_.end(), time);
  if (next == times_.begin()) return factors_.front();
  if (next == times_.end()) return factors_.back();
  const auto k = next - times_.begin();
  const double part = (time - times_[k - 1]) / (times_[k] - times_[k - 1]);
  return factors_[k - 1] + part * (factors_[k] - factors_[k - 1]);
}

}  // namespace sprung
