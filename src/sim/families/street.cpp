#include "sim/families/common.hpp"

namespace brink::sim {

void build_street(Site& site) { build_manholes(site); }

}  // namespace brink::sim
