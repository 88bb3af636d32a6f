#pragma once
/// One reference record against one particle record: every measure of measures.hpp, judged.

#include "scene/problem.hpp"
#include "scene/record.hpp"
#include "validation/acceptance.hpp"
#include "validation/error_bar.hpp"

#include <optional>
#include <string>
#include <vector>

namespace sprung {

/// pass: value + reference error <= limit. fail: value - reference error > limit. not_judged:
/// neither can be said (the limit lies within the reference's error bar, the error is unknown, or
/// there is no value). reported: no limit stands.
enum class Verdict { pass, fail, not_judged, reported };
const char* to_string(Verdict verdict);

struct Measurement {
  std::string measure;          ///< a name of measures()
  std::string subject;          ///< probe or ledger
  std::optional<double> time;   ///< s, if it belongs to one
  std::optional<double> value;  ///< in the measure's unit; none if it could not be taken
  std::optional<double> candidate, reference;  ///< what was compared, where that is one number
  std::string sides_unit;                      ///< of those two
  std::optional<double> reference_error;       ///< in the measure's unit
  std::optional<double> limit;
  std::string because;  ///< the limit's reason
  Verdict verdict = Verdict::reported;
  std::string remark;  ///< why there is no value or no verdict
};

/// Sets limit, reference error (if none is set) and verdict of a measurement from the plan.
void judge(Measurement& measurement, const Acceptance& acceptance, const PlannedRun* plan);

/// A record with the problem that it answers.
struct Answer {
  RecordReader record;
  Problem problem;
  /// Reads the record in `folder`. Throws std::runtime_error if there is none or it has no
  /// manifest.
  static Answer read(const std::filesystem::path& folder);
};

struct RunComparison {
  std::string run;
  std::filesystem::path folder;
  std::string outcome;
  double reached = 0.0;  ///< s, how far the run came
  std::vector<Measurement> measurements;
  /// Whether every measurement that has a limit passes it.
  bool accepted() const;
};

/// Takes and judges every measure. `run` names the row of the acceptance whose limits hold; a run
/// that it does not name is reported only. Throws std::runtime_error if the two records do not
/// answer the same problem or the reference did not finish.
RunComparison compare(const Answer& reference, const Answer& candidate, const ErrorBar& error_bar,
                      const Acceptance& acceptance, const std::string& run);

}  // namespace sprung
