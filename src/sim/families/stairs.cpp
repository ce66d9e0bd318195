#include "sim/families/common.hpp"

namespace brink::sim {

void build_stairs(Site& site) { build_manholes(site); }

}  // namespace brink::sim
