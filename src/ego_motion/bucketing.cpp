#include "ego_motion/bucketing.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

namespace brink {

std::vector<CircularMatch> thin_out(const std::vector<CircularMatch>& matches, double bucket_px, int per_bucket) {
  std::map<std::pair<int, int>, std::vector<CircularMatch>> buckets;
  for (const CircularMatch& match : matches) {
    const int row = static_cast<int>(std::floor(match.current_left.y / bucket_px));
    const int column = static_cast<int>(std::floor(match.current_left.x / bucket_px));
    buckets[{row, column}].push_back(match);
  }
  std::vector<CircularMatch> kept;
  for (auto& [place, bucket] : buckets) {
    std::stable_sort(bucket.begin(), bucket.end(),
                     [](const CircularMatch& a, const CircularMatch& b) { return a.cost < b.cost; });
    kept.insert(kept.end(), bucket.begin(), bucket.begin() + std::min<std::ptrdiff_t>(per_bucket, std::ssize(bucket)));
  }
  return kept;
}

}  // namespace brink
