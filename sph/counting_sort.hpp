#pragma once
/// Sorting by small whole numbers: search cells, coarse cells.

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace sprung::sph {

/// Calls `place(i, k)` for every item i in turn, k its place in the order of the buckets; items of
/// one bucket keep their order. `begin` is filled: bucket b holds the places begin[b] to
/// begin[b + 1]. `bucket_of`: below `buckets`, one per item.
template <typename Place>
void counting_sort(std::span<const std::int32_t> bucket_of, std::size_t buckets,
                   std::vector<std::int32_t>& begin, Place&& place) {
  begin.assign(buckets + 1, 0);
  for (const std::int32_t bucket : bucket_of) ++begin[bucket + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  for (std::size_t i = 0; i < bucket_of.size(); ++i) place(i, begin[bucket_of[i]]++);
  // Every bucket's begin has moved to its end, which is the next one's begin.
  for (std::size_t bucket = buckets; bucket > 0; --bucket) begin[bucket] = begin[bucket - 1];
  begin[0] = 0;
}

}  // namespace sprung::sph
