#pragma once

#include "sim/families/common.hpp"

namespace brink::sim {

/// Houses, walls, hedges and trees along the four sides of an area, so that no view ends in nothing.
void add_surroundings(Site& site, const Eigen::AlignedBox2d& area);
/// A row of houses along a line, facing its left.
void add_house_row(Site& site, const Eigen::Vector2d& from, const Eigen::Vector2d& to);
void add_hedge(Site& site, const Eigen::Vector2d& from, const Eigen::Vector2d& to);
/// Trunk and crown; the crown begins above the heads.
void add_tree(Site& site, const Eigen::Vector2d& foot);
/// Level ground of a material over the outer area without the inner one.
void add_ground_around(Site& site, const Eigen::AlignedBox2d& outer, const Eigen::AlignedBox2d& inner, int material);

}  // namespace brink::sim
