#include <algorithm>

#include "sim/families/common.hpp"

namespace brink::sim {

void build_motion(Site& site) {
  Random& random = site.random;
  constexpr double kCourse = 26.0;  // m: 376 frames at 15 fps and 1 m/s, and a little to spare
  const double side = random.sign();
  Line approach{{0.0, 0.0}};
  for (int i = 1; approach.back().x() < kCourse; ++i) {
    const double sway = i % 2 == 0 ? -side : side;
    approach.emplace_back(approach.back().x() + random.uniform(3.5, 5.0), sway * random.uniform(0.6, 1.6));
  }
  build_open_place(site, {.approach = approach, .solids = 14, .flats = 10, .people = 3});
}

}  // namespace brink::sim
