// How near to an edge it is still reported, over drops, cameras and baselines: straight approaches over exact geometry,
// disparities with 0.1 px of noise, known poses. scripts/approach-grid builds and runs it; prints a table for BENCHMARKS.md.
#include <fmt/format.h>

#include "approach.hpp"

int main() {
  using brink::test::ApproachResult;
  int silent = 0;
  int cases = 0;
  int to_the_end = 0;
  fmt::print(
      "| camera height, m | pitch, degrees | baseline, cm | drop 0.3 m | 0.5 | 0.75 | 1.0 | 1.5 | silent frames | height off, "
      "m |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n");
  for (const double height_m : {0.28, 1.2, 1.6, 2.5}) {
    for (const double pitch_deg : {10.0, 25.0, 40.0}) {
      for (const double baseline_m : {0.05, 0.12, 0.15}) {
        fmt::print("| {} | {} | {:.0f} |", height_m, pitch_deg, 100.0 * baseline_m);
        int row_silent = 0;
        double off_m = 0.0;
        for (const double depth_m : {0.3, 0.5, 0.75, 1.0, 1.5}) {
          const ApproachResult result = brink::test::approach_edge(depth_m, {.height_m = height_m, .pitch_deg = pitch_deg},
                                                                   {350.0, 319.5, 179.5, baseline_m}, {640, 360});
          const bool never = result.nearest_reported_m > 100.0;
          fmt::print(" {} |", never ? std::string("never") : fmt::format("{:.1f}", result.nearest_reported_m));
          row_silent += result.silent;
          off_m = std::max(off_m, result.worst_height_error_m);
          ++cases;
          to_the_end += result.reported == result.frames ? 1 : 0;
        }
        fmt::print(" {} | {:.3f} |\n", row_silent, off_m);
        silent += row_silent;
      }
    }
  }
  fmt::print("\nReported in every frame to 0.3 m: {} of {}; frames with a ground seen and nothing reported: {}\n", to_the_end,
             cases, silent);
  return 0;
}
