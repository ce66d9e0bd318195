#pragma once

#include "brink/sim/scene.hpp"
#include "sim/random.hpp"

namespace brink::sim::materials {

/// What streets are made of; colours are linear reflectances, from albedo tables (asphalt 0.05-0.12, concrete 0.25-0.4, ...).
Material asphalt();
Material wet_asphalt();
Material oil();
Material concrete();
Material paving();  ///< concrete slabs with joints
Material cobbles();
Material soot();  ///< walls of deep wet shafts
Material gravel();
Material soil();
Material grass();
Material leaves();
Material bark();
Material iron();           ///< covers, rails, grates
Material painted_steel();  ///< of any colour: see colored()
Material dark_steel();     ///< handrail posts
Material rubber();         ///< black mats
Material tactile();        ///< yellow strip with bumps
Material white_paint();
Material white_wall();
Material plaster();
Material brick();
Material dark_window();
Material wood();
Material cloth();
Material skin();

/// The same with another colour; the second one keeps its ratio to the first.
Material colored(Material material, const Eigen::Vector3f& color);
/// The same a little brighter or darker, coarser or finer: two streets are never paved alike.
Material varied(Material material, Random& random);
/// A colour as clothes and painted things have.
Eigen::Vector3f random_color(Random& random);

}  // namespace brink::sim::materials
