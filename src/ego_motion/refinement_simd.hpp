#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "ego_motion/refinement.hpp"

namespace brink {

/// Patches are aligned so many at a time, each in a lane of its own.
inline constexpr std::size_t kPatchLanes = 8;
using PatchLanes = std::array<float, kPatchLanes>;

/// What is sought, pixel by pixel, row by row.
struct PatchPixels {
  PatchLanes level{};
  PatchLanes gradient_u{};
  PatchLanes gradient_v{};
};

/// Where the picture is looked at, px: pixel (x, y) of a patch, from its centre, lies at u + u_by_x x + u_by_y y, ...
struct PatchPlaces {
  PatchLanes u{}, v{};
  PatchLanes u_by_x{}, u_by_y{}, v_by_x{}, v_by_y{};
};

/// A picture of at least 2x2 pixels.
struct PicturePixels {
  const std::uint8_t* levels;
  int columns, rows;
  int stride;  ///< pixels from row to row
};

/// Sums over the pixels of patches; difference = level found, less the mean of those found, less that of the patch.
struct PatchComparison {
  PatchLanes gradient_u{};  ///< of difference times gradient
  PatchLanes gradient_v{};
  PatchLanes squares{};      ///< of difference^2
  PatchLanes correlation{};  ///< of level found times that of the patch
  PatchLanes contrast{};     ///< of level found^2
};

/// Compares patches with what a picture shows at their places, bilinear. Equal to the plain twin in
/// tests/reference/refinement.hpp for every target. @param patches kPatchPixels of them.
PatchComparison compare_patches(const PatchPixels* patches, const PatchPlaces& places, const PicturePixels& picture);

}  // namespace brink
