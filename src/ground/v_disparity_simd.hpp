#pragma once

namespace brink {

/// Counts of disparities in rows, summed up bin by bin: bin b of row r at [b * rows + r] holds the number in all bins before
/// it.
struct CumulativeCounts {
  const int* counts;
  int rows;
  int bins;  ///< one less than are held
  double bins_per_px;
};

/// The line d = slope v + offset, and the disparities around it.
struct LineBand {
  double slope;
  double offset;
  double relative_tolerance;  ///< share of the disparity
  double tolerance_px;        ///< never less than this
};

/// How many disparities of each of the rows [begin, end) lie in the band, bins that it touches counted whole; none where the
/// line is not above 0. Equal to the plain twin in tests/reference/v_disparity.hpp for every target.
/// @param row_v v of all rows. @param band_counts of all rows.
void count_rows_in_band(const CumulativeCounts& histogram, const double* row_v, int begin, int end, const LineBand& band,
                        int* band_counts);

}  // namespace brink
