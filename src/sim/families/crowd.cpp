#include <array>
#include <cmath>
#include <numbers>

#include "sim/families/common.hpp"
#include "sim/families/decoys.hpp"

namespace brink::sim {
namespace {

/// People who walk the same way just ahead, slowly changing places: what is near moves with the camera, the worst case for
/// ego-motion.
void add_companions(Site& site) {
  Random& random = site.random;
  const double duration = site.duration_s;
  const Eigen::Vector2d start = site.position_on_path(0.0);
  const Eigen::Vector2d way = site.position_on_path(duration) - start;
  const Eigen::Vector2d ahead = way.normalized();
  const Eigen::Vector2d aside(-ahead.y(), ahead.x());
  constexpr double kDrift = 0.35;  // m in all, each way
  for (const double place : {-1.0, -0.33, 0.33, 1.0}) {
    const Eigen::Vector2d offset = random.uniform(1.5, 1.9) * ahead + (0.9 * place + random.uniform(-0.08, 0.08)) * aside;
    const Eigen::Vector2d drift(random.uniform(0.0, kDrift), random.uniform(-kDrift, kDrift));
    const Eigen::Vector2d velocity = (way + drift.x() * ahead + drift.y() * place * aside) / duration;
    const int body = site.add_body({velocity.x(), velocity.y(), 0.0});
    site.passers_by.push_back({.start = start + offset, .velocity = velocity});
    add_person(site, start + offset, std::atan2(velocity.y(), velocity.x()), body);
  }
}

}  // namespace

void build_crowd(Site& site) {
  Random& random = site.random;
  Line approach{{0.0, 0.0}};
  while (approach.back().x() < site.path_length() + 1.0) {
    approach.emplace_back(approach.back().x() + random.uniform(4.0, 6.0), random.uniform(-0.15, 0.15));
  }
  build_open_place(site, {.approach = approach, .solids = 10, .flats = 8, .people = 2, .ramps = false});
  add_companions(site);
  constexpr int kStrangers = 10;
  for (int i = 0; i < kStrangers; ++i) add_passer_by(site);
}

}  // namespace brink::sim
