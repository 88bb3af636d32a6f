#include "validation/signal.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace sprung {

namespace {

/// Times that differ by less than this part of the signal's length are the same time: room for the
/// round-off of some 1e5 added steps.
constexpr double same_time = 1e-9;

double parabola_slope(std::span<const double> t, std::span<const double> v, std::size_t i) {
  const std::size_t last = t.size() - 1;
  if (last == 1) return (v[1] - v[0]) / (t[1] - t[0]);
  const std::size_t m = std::clamp<std::size_t>(i, 1, last - 1);
  const double h0 = t[m] - t[m - 1], h1 = t[m + 1] - t[m];
  const double s0 = (v[m] - v[m - 1]) / h0, s1 = (v[m + 1] - v[m]) / h1;
  const double curvature = (s1 - s0) / (h0 + h1);  // half the second derivative
  return s0 + curvature * h0 + 2.0 * curvature * (t[i] - t[m]);
}

/// Pearson's correlation of two samples of equal length, and the least-squares factor y = factor x.
struct Correlation {
  double pearson = 0.0;
  double factor = 0.0;
};

Correlation correlate(std::span<const double> x, std::span<const double> y) {
  const auto n = static_cast<double>(x.size());
  double sum_x = 0.0, sum_y = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sum_x += x[i];
    sum_y += y[i];
  }
  double xx = 0.0, yy = 0.0, xy = 0.0, raw_xx = 0.0, raw_xy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double a = x[i] - sum_x / n, b = y[i] - sum_y / n;
    xx += a * a;
    yy += b * b;
    xy += a * b;
    raw_xx += x[i] * x[i];
    raw_xy += x[i] * y[i];
  }
  Correlation result;
  // Variations at round-off of the level itself say nothing about a lag.
  const double least = 1e-20 * raw_xx;
  if (xx > least && yy > 0.0) result.pearson = xy / std::sqrt(xx * yy);
  if (raw_xx > 0.0) result.factor = raw_xy / raw_xx;
  return result;
}

}  // namespace

Signal::Signal(std::vector<double> time, std::vector<double> value)
    : time_(std::move(time)), value_(std::move(value)) {
  if (time_.size() != value_.size() || time_.size() < 2) {
    throw std::invalid_argument("a signal needs two samples or more, got " +
                                std::to_string(time_.size()) + " times and " +
                                std::to_string(value_.size()) + " values");
  }
  for (std::size_t i = 0; i < time_.size(); ++i) {
    if (!std::isfinite(time_[i]) || !std::isfinite(value_[i])) {
      throw std::invalid_argument("a signal holds a number that is not finite, at sample " +
                                  std::to_string(i));
    }
    if (i > 0 && time_[i] <= time_[i - 1]) {
      throw std::invalid_argument(
          "a signal's times do not ascend at t = " + std::to_string(time_[i]) + " s");
    }
  }
  slope_.resize(time_.size());
  for (std::size_t i = 0; i < time_.size(); ++i) slope_[i] = parabola_slope(time_, value_, i);
}

double Signal::shortest_step() const {
  double shortest = time_[1] - time_[0];
  for (std::size_t i = 2; i < time_.size(); ++i) {
    shortest = std::min(shortest, time_[i] - time_[i - 1]);
  }
  return shortest;
}

bool Signal::covers(double t) const {
  const double room = same_time * (end() - begin());
  return t >= begin() - room && t <= end() + room;
}

std::size_t Signal::interval_of(double t) const {
  const auto after = std::upper_bound(time_.begin(), time_.end(), t);
  const auto index = static_cast<std::size_t>(after - time_.begin());
  return std::clamp<std::size_t>(index, 1, time_.size() - 1) - 1;
}

double Signal::at(double t) const {
  if (!covers(t)) {
    throw std::out_of_range("t = " + std::to_string(t) +
                            " s is outside the signal, which runs from " + std::to_string(begin()) +
                            " s to " + std::to_string(end()) + " s");
  }
  t = std::clamp(t, begin(), end());
  const std::size_t i = interval_of(t);
  const double h = time_[i + 1] - time_[i];
  const double s = (t - time_[i]) / h, r = 1.0 - s;
  return r * r * (1.0 + 2.0 * s) * value_[i] + s * s * (3.0 - 2.0 * s) * value_[i + 1] +
         h * s * r * (r * slope_[i] - s * slope_[i + 1]);
}

WindowMean window_mean(const Signal& signal, double from, double to) {
  if (!(to > from)) throw std::invalid_argument("a window of time must end after it begins");
  if (!signal.covers(from) || !signal.covers(to)) {
    throw std::out_of_range("the window from " + std::to_string(from) + " s to " +
                            std::to_string(to) + " s is not within the signal");
  }
  const auto time = signal.time();
  const auto value = signal.value();
  double integral = 0.0, integral_of_square = 0.0, length = 0.0;
  for (std::size_t i = 0; i + 1 < time.size(); ++i) {
    const double left = std::max(from, time[i]), right = std::min(to, time[i + 1]);
    if (right <= left) continue;
    const double slope = (value[i + 1] - value[i]) / (time[i + 1] - time[i]);
    const double a = value[i] + slope * (left - time[i]), b = value[i] + slope * (right - time[i]);
    integral += 0.5 * (a + b) * (right - left);
    integral_of_square += (a * a + a * b + b * b) / 3.0 * (right - left);
    length += right - left;
  }
  const double mean = integral / length;
  return {mean, std::sqrt(std::max(0.0, integral_of_square / length - mean * mean))};
}

double relative_l2(std::span<const Signal> reference, std::span<const Signal> candidate) {
  if (reference.empty() || reference.size() != candidate.size()) {
    throw std::invalid_argument("an error norm needs as many components on either side");
  }
  const auto time = reference[0].time();
  double difference = 0.0, norm = 0.0;
  double before_difference = 0.0, before_norm = 0.0, before = 0.0;
  bool first = true;
  for (const double t : time) {
    if (!candidate[0].covers(t)) continue;
    double square_difference = 0.0, square = 0.0;
    for (std::size_t c = 0; c < reference.size(); ++c) {
      const double a = reference[c].at(t), d = candidate[c].at(t) - a;
      square += a * a;
      square_difference += d * d;
    }
    if (!first) {
      difference += 0.5 * (square_difference + before_difference) * (t - before);
      norm += 0.5 * (square + before_norm) * (t - before);
    }
    first = false;
    before = t;
    before_difference = square_difference;
    before_norm = square;
  }
  if (!(norm > 0.0)) {
    throw std::invalid_argument("the reference vanishes over the common time: no relative error");
  }
  return std::sqrt(difference / norm);
}

std::optional<Alignment> align(const Signal& reference, const Signal& candidate, double search) {
  const double from = std::max(reference.begin(), candidate.begin()) + search;
  const double to = std::min(reference.end(), candidate.end()) - search;
  // Less than one search length of common time can be matched by chance.
  if (!(search > 0.0) || to - from < search) return std::nullopt;

  const double step = std::max(std::min(reference.shortest_step(), candidate.shortest_step()),
                               (to - from) / 4000.0);
  const auto samples = static_cast<std::size_t>(std::floor((to - from) / step)) + 1;
  std::vector<double> x(samples), y(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    x[i] = reference.at(from + static_cast<double>(i) * step);
  }
  const auto correlation_at = [&](double lag) {
    for (std::size_t i = 0; i < samples; ++i) {
      y[i] = candidate.at(from + static_cast<double>(i) * step + lag);
    }
    return correlate(x, y);
  };

  const int half = std::max(4, static_cast<int>(std::ceil(search / step)));
  const double stride = search / half;
  int best = 0;
  double highest = -2.0;
  for (int k = -half; k <= half; ++k) {
    const double pearson = correlation_at(k * stride).pearson;
    if (pearson > highest) {
      highest = pearson;
      best = k;
    }
  }
  if (highest <= 0.0 || std::abs(best) == half) return std::nullopt;

  double a = (best - 1) * stride, b = (best + 1) * stride;
  constexpr double golden = 1.0 / std::numbers::phi;
  while (b - a > 1e-9 * search + 1e-12) {
    const double c = b - golden * (b - a), d = a + golden * (b - a);
    if (correlation_at(c).pearson > correlation_at(d).pearson) {
      b = d;
    } else {
      a = c;
    }
  }
  const double lag = 0.5 * (a + b);
  const Correlation result = correlation_at(lag);
  return Alignment{lag, result.factor, result.pearson};
}

}  // namespace sprung
