#pragma once

#include "sim/families/common.hpp"

namespace brink::sim {

/// How many things that look like obstacles and are none to strew along the path.
struct DecoyCounts {
  int solids = 5;  ///< bollards, boxes, lamp posts, trees, planters, benches
  int flats = 6;   ///< mats, covers, grates, wet and oily patches, leaves, road paint
  int people = 2;  ///< standing or walking
};

/// Where there is no room for all of them, fewer.
void add_decoys(Site& site, const Eigen::AlignedBox2d& area, const DecoyCounts& counts);

void add_lamp_post(Site& site, const Eigen::Vector2d& foot);
void add_bench(Site& site, const Eigen::Vector2d& center, double yaw);
void add_bin(Site& site, const Eigen::Vector2d& center);
/// A person; body = -1 stands.
void add_person(Site& site, const Eigen::Vector2d& foot, double yaw, int body);
/// Somebody who crosses a few metres ahead of the walker at some time, if there is a clear way.
void add_passer_by(Site& site);
/// Steps up to a platform against something, seen from -x; its size along x and y is what it takes.
void add_stairs_up(Site& site, const Eigen::Vector2d& corner, const Eigen::Vector2d& size, int steps);
/// A railing of thin dark posts with a bar on top.
void add_railing(Site& site, const Line& line, double height);

}  // namespace brink::sim
