#include "sim/families/common.hpp"

namespace brink::sim {

void build_motion(Site& site) { build_manholes(site); }

}  // namespace brink::sim
