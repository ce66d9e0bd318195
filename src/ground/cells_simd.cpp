#include "ground/cells_simd.hpp"

#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "ground/cells_simd.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace brink::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// Points, one in each lane.
template <class V>
struct Points {
  V x;
  V y;
  V z;
};

template <class D, class V>
HWY_INLINE V dot(D doubles, const Eigen::Vector3d& axis, const Points<V>& points) {
  const auto in_picture = hn::Add(hn::Mul(hn::Set(doubles, axis.x()), points.x), hn::Mul(hn::Set(doubles, axis.y()), points.y));
  return hn::Add(in_picture, hn::Mul(hn::Set(doubles, axis.z()), points.z));
}

/// Pixels [i, i + lanes of the tag) of the row.
template <class D>
HWY_INLINE void place_pixels(D doubles, const PixelRow& row, int i, const StereoCamera& camera, const GroundPose& pose,
                             const CellGrid& grid, double highest_m, int* cells, float* elevation_m) {
  using V = hn::VFromD<D>;
  const hn::Rebind<std::int32_t, D> ints;
  const hn::Rebind<float, D> floats;
  const auto columns = hn::Add(hn::Mul(hn::Iota(ints, i), hn::Set(ints, row.step)), hn::Set(ints, row.first));
  const V d = hn::PromoteTo(doubles, hn::LoadU(floats, row.disparity + i));
  const V focal = hn::Set(doubles, camera.focal);
  const V z = hn::Div(hn::Set(doubles, camera.focal * camera.baseline), d);
  const V u = hn::Sub(hn::PromoteTo(doubles, columns), hn::Set(doubles, camera.cx));
  const Points<V> points{hn::Div(hn::Mul(u, z), focal), hn::Div(hn::Mul(hn::Set(doubles, row.v - camera.cy), z), focal), z};

  const V elevation = hn::Sub(hn::Set(doubles, pose.height_m), dot(doubles, pose.down, points));
  const V cell_m = hn::Set(doubles, grid.cell_m);
  const V half = hn::Set(doubles, 0.5);
  const V across = hn::Sub(dot(doubles, pose.right, points), hn::Set(doubles, grid.left_m));
  const V column = hn::Round(hn::Sub(hn::Div(across, cell_m), half));
  const V line = hn::Round(hn::Sub(hn::Div(dot(doubles, pose.forward, points), cell_m), half));

  const V zero = hn::Zero(doubles);
  const V all_columns = hn::Set(doubles, grid.columns);
  const auto in_columns = hn::And(hn::Ge(column, zero), hn::Lt(column, all_columns));
  const auto in_rows = hn::And(hn::Ge(line, zero), hn::Lt(line, hn::Set(doubles, grid.rows)));
  const auto is_near = hn::And(hn::Gt(d, zero), hn::Lt(hn::Abs(elevation), hn::Set(doubles, highest_m)));
  const auto is_told = hn::And(is_near, hn::And(in_columns, in_rows));
  const V cell = hn::IfThenElse(is_told, hn::Add(hn::Mul(line, all_columns), column), hn::Set(doubles, -1.0));
  hn::StoreU(hn::DemoteTo(ints, cell), ints, cells + i);
  hn::StoreU(hn::DemoteTo(floats, elevation), floats, elevation_m + i);
}

void place_row(const PixelRow& row, const StereoCamera& camera, const GroundPose& pose, const CellGrid& grid, double highest_m,
               int* cells, float* elevation_m) {
  const hn::CappedTag<double, 4> doubles;
  const auto lanes = static_cast<int>(hn::Lanes(doubles));
  int i = 0;
  for (; i + lanes <= row.count; i += lanes) {
    place_pixels(doubles, row, i, camera, pose, grid, highest_m, cells, elevation_m);
  }
  for (; i < row.count; ++i) {
    place_pixels(hn::CappedTag<double, 1>(), row, i, camera, pose, grid, highest_m, cells, elevation_m);
  }
}

}  // namespace
}  // namespace brink::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace brink {

HWY_EXPORT(place_row);

void place_in_cells(const PixelRow& row, const StereoCamera& camera, const GroundPose& pose, const CellGrid& grid,
                    double highest_m, int* cells, float* elevation_m) {
  HWY_DYNAMIC_DISPATCH(place_row)(row, camera, pose, grid, highest_m, cells, elevation_m);
}

}  // namespace brink
#endif  // HWY_ONCE
