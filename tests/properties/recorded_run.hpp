#pragma once
/// A run whose record is looked at byte by byte.

#include "sph/run.hpp"
#include "tests/unit/scene/temporary_folder.hpp"
#include "tests/unit/sph/channel_scene.hpp"

#include <gtest/gtest.h>
#include <omp.h>

namespace sprung::sph::test {

/// Runs a plane scene into `out`.
inline Outcome run_scene(Document document, const std::filesystem::path& out, int threads = 1,
                         double until = 0.0, bool resume = false) {
  const sprung::test::TemporaryFolder folder;
  omp_set_num_threads(threads);
  const Outcome outcome =
      run<2>(document, plane_modulus_table(folder.path() / "table.csv"),
             {.out = out, .resume = resume, .overwrite = false, .until = until});
  omp_set_num_threads(1);
  return outcome;
}

/// Every probe, ledger and field of two records, byte by byte.
inline void expect_same_bytes(const std::filesystem::path& a, const std::filesystem::path& b) {
  for (const char* folder : {"probes", "fields"}) {
    const auto left = sprung::test::all_files(a / folder);
    const auto right = sprung::test::all_files(b / folder);
    EXPECT_FALSE(left.empty());
    ASSERT_EQ(left.size(), right.size()) << folder;
    for (const auto& [name, content] : left) {
      ASSERT_TRUE(right.contains(name)) << name;
      EXPECT_TRUE(content == right.at(name)) << folder << '/' << name << " differs";
    }
  }
}

}  // namespace sprung::sph::test
