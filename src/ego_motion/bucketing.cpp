#include "ego_motion/bucketing.hpp"

#include <algorithm>
#include <cstddef>

#include "ego_motion/match_grid.hpp"

namespace brink {

std::vector<CircularMatch> thin_out(const std::vector<CircularMatch>& matches, double bucket_px, int per_bucket) {
  const MatchGrid grid(matches, bucket_px);
  std::vector<CircularMatch> kept;
  kept.reserve(matches.size());
  std::vector<std::size_t> bucket;
  for (int row = 0; row < grid.rows(); ++row) {
    for (int column = 0; column < grid.columns(); ++column) {
      const auto in_bucket = grid.matches(row, column, column + 1);
      bucket.assign(in_bucket.begin(), in_bucket.end());
      const auto end = bucket.begin() + std::min<std::ptrdiff_t>(per_bucket, std::ssize(bucket));
      std::partial_sort(bucket.begin(), end, bucket.end(), [&matches](std::size_t a, std::size_t b) {
        return matches[a].cost != matches[b].cost ? matches[a].cost < matches[b].cost : a < b;
      });
      for (auto match = bucket.begin(); match != end; ++match) kept.push_back(matches[*match]);
    }
  }
  return kept;
}

}  // namespace brink
