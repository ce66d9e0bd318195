#include "sim/families/common.hpp"

namespace brink::sim {

void build_platform(Site& site) { build_manholes(site); }

}  // namespace brink::sim
