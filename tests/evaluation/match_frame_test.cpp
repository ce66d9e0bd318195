#include <algorithm>
#include <random>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "brink/evaluation.hpp"
#include "expect_error.hpp"

namespace brink {
namespace {

using Ids = std::vector<int>;

constexpr int kWidth = 100;
constexpr int kHeight = 80;

cv::Mat1b paint(const std::vector<std::pair<int, cv::Rect>>& areas) {
  cv::Mat1b picture(kHeight, kWidth, uchar{0});
  for (const auto& [value, area] : areas) picture(area).setTo(value);
  return picture;
}

cv::Mat1b region(const cv::Rect& area) { return paint({{255, area}}); }

// One detection against truth, without dilation unless it is told.
FrameMatch match_one(const cv::Mat1b& negative, const cv::Rect& area, const Ids& counted, int dilation_px = 0) {
  return match_frame(negative, {region(area)}, counted, dilation_px);
}

TEST(MatchFrame, HitsWithExactlyHalfOfTheDetectionInTheMask) {
  // Instance 100x10, detection 10x10: rows 5..14, of which 5..9 (50 of 100 px) are in the mask. IoU = 50 / 1050, far below
  // 0.25.
  const cv::Mat1b negative = paint({{1, {0, 0, 100, 10}}});
  const FrameMatch match = match_one(negative, {20, 5, 10, 10}, {1});
  EXPECT_EQ(match.hits[0], Ids{1});
  EXPECT_FALSE(match.is_false[0]);
}

TEST(MatchFrame, DoesNotHitWithOnePixelLessThanHalf) {
  // The same with one pixel of the mask taken away under the detection: 49 of 100 px.
  cv::Mat1b negative = paint({{1, {0, 0, 100, 10}}});
  negative(9, 20) = 0;
  const FrameMatch match = match_one(negative, {20, 5, 10, 10}, {1});
  EXPECT_TRUE(match.hits[0].empty());
  EXPECT_TRUE(match.is_false[0]);
}

TEST(MatchFrame, WidensTheMaskByTheDilation) {
  // Instance rows 0..9. A detection of rows 10..19 has its rows 10..14 within 5 px of the mask: 50 of 100 px hit with 5 px, 40
  // of 100 do not with 4 px. The instance is wide, so the disc's round corners play no part.
  const cv::Mat1b negative = paint({{1, {0, 0, 100, 10}}});
  EXPECT_EQ(match_one(negative, {20, 10, 10, 10}, {1}, 5).hits[0], Ids{1});
  EXPECT_TRUE(match_one(negative, {20, 10, 10, 10}, {1}, 4).is_false[0]);
}

TEST(MatchFrame, DilatesByADisc) {
  // Of one pixel at (50, 40), a disc of radius 5 holds (3, 4) and (5, 0) away, not (4, 4) nor (6, 0). A detection of one pixel
  // is at least half inside when it is inside.
  const cv::Mat1b negative = paint({{1, {50, 40, 1, 1}}});
  EXPECT_EQ(match_one(negative, {53, 44, 1, 1}, {1}, 5).hits[0], Ids{1});
  EXPECT_EQ(match_one(negative, {45, 40, 1, 1}, {1}, 5).hits[0], Ids{1});
  EXPECT_TRUE(match_one(negative, {54, 44, 1, 1}, {1}, 5).is_false[0]);
  EXPECT_TRUE(match_one(negative, {56, 40, 1, 1}, {1}, 5).is_false[0]);
}

TEST(MatchFrame, HitsFromAnIntersectionOverUnionOfAQuarter) {
  // Instance 10x10 = 100 px all inside of a detection of 40x10 = 400 px: IoU = 100 / 400 = 0.25; half of the detection it is
  // not. 41x10: 100 / 410 < 0.25.
  const cv::Mat1b negative = paint({{1, {0, 0, 10, 10}}});
  EXPECT_EQ(match_one(negative, {0, 0, 40, 10}, {1}).hits[0], Ids{1});
  EXPECT_TRUE(match_one(negative, {0, 0, 41, 10}, {1}).is_false[0]);
}

TEST(MatchFrame, MeasuresIntersectionOverUnionWithTheMaskAsItIs) {
  // With the mask widened by 5 px, 41x10 would hold 15x10 of it: 150 / 460 > 0.25. It is the undilated one that counts.
  const cv::Mat1b negative = paint({{1, {0, 0, 10, 10}}});
  EXPECT_TRUE(match_one(negative, {0, 0, 41, 10}, {1}, 5).is_false[0]);
}

TEST(MatchFrame, LetsOneRegionHitBothStairsBesideAHandrail) {
  // Stairs 1 (columns 0..39) and 2 (columns 60..99), 20 rows each, handrail between. The region spans columns 10..79: 30
  // columns of 1, 20 of 2, 20 of neither = 600 + 400 + 400 of 1400 px. Half is 700: neither alone. IoU with 1 is 600 / 1600 =
  // 0.375, with 2 it is 400 / 1800 = 0.22. In U are 1000 >= 700, and it covers 400 of the 800 px of 2: exactly half.
  const cv::Mat1b negative = paint({{1, {0, 0, 40, 20}}, {2, {60, 0, 40, 20}}});
  const FrameMatch match = match_one(negative, {10, 0, 70, 20}, {1, 2});
  EXPECT_EQ(match.hits[0], (Ids{1, 2}));
  EXPECT_EQ(match.fragments, 0);
}

TEST(MatchFrame, DoesNotHitAnInstanceOfWhichLessThanHalfIsCovered) {
  // One column less: 19 of the 40 columns of stairs 2.
  const cv::Mat1b negative = paint({{1, {0, 0, 40, 20}}, {2, {60, 0, 40, 20}}});
  EXPECT_EQ(match_one(negative, {10, 0, 69, 20}, {1, 2}).hits[0], Ids{1});
}

TEST(MatchFrame, MeasuresCoverageOnTheMaskAsItIs) {
  // 20 of 40 columns, of the mask widened by 5 px it would be 25 of 50 and more; 19 stay too few.
  const cv::Mat1b negative = paint({{1, {0, 0, 40, 20}}, {2, {60, 0, 40, 20}}});
  EXPECT_EQ(match_one(negative, {10, 0, 70, 20}, {1, 2}, 5).hits[0], (Ids{1, 2}));
  EXPECT_EQ(match_one(negative, {10, 0, 69, 20}, {1, 2}, 5).hits[0], Ids{1});
}

TEST(MatchFrame, IsNoFalseAlarmWhenHalfLiesInTheUnionAlthoughItHitsNothing) {
  // Three instances of 100x20 px; the region of 10x50 px (500) shares 120, 100, 100 with them: 320 >= 250 lie in U, none holds
  // half of it, IoU = 120 / 2380 and less, and of each instance a twentieth is covered.
  const cv::Mat1b negative = paint({{1, {0, 0, 100, 20}}, {2, {0, 25, 100, 10}}, {3, {0, 40, 100, 20}}});
  const FrameMatch match = match_one(negative, {45, 8, 10, 42}, {1, 2, 3});
  EXPECT_TRUE(match.hits[0].empty());
  EXPECT_FALSE(match.is_false[0]);
}

TEST(MatchFrame, NeitherHitsNorBlamesWhatDoesNotCount) {
  const cv::Mat1b negative = paint({{1, {0, 0, 40, 20}}, {2, {60, 0, 40, 20}}});
  const FrameMatch match = match_one(negative, {65, 0, 20, 20}, {1});
  EXPECT_TRUE(match.hits[0].empty());
  EXPECT_FALSE(match.is_false[0]);
}

TEST(MatchFrame, BlamesWhatLiesHalfOnWhatDoesNotCountButOnePixel) {
  // Detection 10x10 over the lower edge of instance 2: rows 15..24, 50 px inside; one less when a pixel is taken away.
  cv::Mat1b negative = paint({{2, {60, 0, 40, 20}}});
  EXPECT_FALSE(match_one(negative, {70, 15, 10, 10}, {}).is_false[0]);
  negative(19, 70) = 0;
  EXPECT_TRUE(match_one(negative, {70, 15, 10, 10}, {}).is_false[0]);
  EXPECT_FALSE(match_one(negative, {70, 15, 10, 10}, {}, 1).is_false[0]);  // widened like those that count
}

TEST(MatchFrame, TakesPixelsWithoutLabelTogetherWithWhatDoesNotCount) {
  // 30 px on 255, 20 px on instance 2, of 100.
  const cv::Mat1b negative = paint({{kNotLabelled, {0, 0, 3, 10}}, {2, {3, 0, 2, 10}}});
  EXPECT_FALSE(match_one(negative, {0, 0, 10, 10}, {}).is_false[0]);
  EXPECT_TRUE(match_one(negative, {0, 0, 10, 10}, {2}).is_false[0]);  // 30 px on 255 alone, 20 px of 100 on what counts
}

TEST(MatchFrame, DoesNotWidenPixelsWithoutLabel) {
  const cv::Mat1b negative = paint({{kNotLabelled, {0, 0, 100, 10}}});
  EXPECT_FALSE(match_one(negative, {20, 5, 10, 10}, {}, 5).is_false[0]);
  EXPECT_TRUE(match_one(negative, {20, 6, 10, 10}, {}, 5).is_false[0]);  // 40 of 100
}

TEST(MatchFrame, CountsDetectionsBeyondTheFirstAsFragments) {
  // Two detections on instance 1, three on 2: 1 + 2 fragments.
  const cv::Mat1b negative = paint({{1, {0, 0, 40, 20}}, {2, {60, 0, 40, 20}}});
  const FrameMatch match = match_frame(
      negative,
      {region({0, 0, 10, 20}), region({20, 0, 10, 20}), region({60, 0, 5, 20}), region({70, 0, 5, 20}), region({80, 0, 5, 20})},
      {1, 2}, 5);
  EXPECT_EQ(match.fragments, 3);
  EXPECT_EQ(std::ranges::count(match.is_false, true), 0);
}

TEST(MatchFrame, JudgesADetectionWithoutPixelsNeitherWay) {
  const FrameMatch match = match_frame(paint({{1, {0, 0, 40, 20}}}), {cv::Mat1b(kHeight, kWidth, uchar{0})}, {1}, 5);
  EXPECT_TRUE(match.hits[0].empty());
  EXPECT_FALSE(match.is_false[0]);
}

TEST(MatchFrame, IgnoresCountedIdsThatAreNotInThePicture) {
  EXPECT_EQ(match_one(paint({{3, {0, 0, 40, 20}}}), {0, 0, 40, 20}, {0, 1, 3, 7, 255}).hits[0], Ids{3});
}

TEST(MatchFrame, AcceptsEmptyPicturesAndNoDetections) {
  EXPECT_TRUE(match_frame({}, {}, {1}, 5).hits.empty());
  const FrameMatch match = match_frame({}, {cv::Mat1b()}, {1}, 5);
  EXPECT_TRUE(match.hits[0].empty());
  EXPECT_FALSE(match.is_false[0]);
}

TEST(MatchFrame, AcceptsAPictureOfOnePixel) {
  const cv::Mat1b one(1, 1, uchar{1});
  EXPECT_EQ(match_frame(one, {cv::Mat1b(1, 1, uchar{9})}, {1}, 5).hits[0], Ids{1});
  EXPECT_TRUE(match_frame(cv::Mat1b(1, 1, uchar{0}), {one}, {1}, 5).is_false[0]);
}

TEST(MatchFrame, RefusesARegionOfAnotherSize) {
  const std::string message =
      test::error_of<std::invalid_argument>([] { match_frame(paint({}), {cv::Mat1b(3, 4, uchar{0})}, {}, 5); });
  test::expect_line_with(message, "region 0 has 4x3 px, must be 100x80 like the truth");
}

TEST(MatchFrame, RefusesANegativeDilation) {
  test::expect_line_with(test::error_of<std::invalid_argument>([] { match_frame(paint({}), {}, {}, -1); }),
                         "dilation_px = -1, must be 0 or more");
}

// The rules word by word over sets of pixels: the naive twin of match_frame.
namespace naive {

using Pixels = std::set<std::pair<int, int>>;

Pixels pixels_of(const cv::Mat1b& picture, int value) {
  Pixels pixels;
  for (int v = 0; v < picture.rows; ++v) {
    for (int u = 0; u < picture.cols; ++u) {
      if (picture(v, u) == value) pixels.emplace(u, v);
    }
  }
  return pixels;
}

Pixels widen(const Pixels& pixels, const cv::Size& size, int radius) {
  Pixels wide;
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      if (std::ranges::any_of(pixels, [&](const auto& p) {
            return (p.first - u) * (p.first - u) + (p.second - v) * (p.second - v) <= radius * radius;
          })) {
        wide.emplace(u, v);
      }
    }
  }
  return wide;
}

double common(const Pixels& a, const Pixels& b) {
  return static_cast<double>(std::ranges::count_if(a, [&](const auto& p) { return b.contains(p); }));
}

FrameMatch match_frame(const cv::Mat1b& negative, const std::vector<cv::Mat1b>& regions, const Ids& counted, int dilation_px) {
  FrameMatch match;
  std::map<int, Pixels> masks;
  std::map<int, Pixels> dilated;
  Pixels in_union;
  Pixels ignored = pixels_of(negative, 255);
  for (int id = 1; id < 255; ++id) {
    masks[id] = pixels_of(negative, id);
    dilated[id] = widen(masks[id], negative.size(), dilation_px);
    const bool counts = std::ranges::find(counted, id) != counted.end();
    (counts ? in_union : ignored).insert(dilated[id].begin(), dilated[id].end());
  }
  std::map<int, int> times_hit;
  for (const cv::Mat1b& region : regions) {
    const Pixels detection = pixels_of(region, 255);
    const double half = static_cast<double>(detection.size()) / 2.0;
    Ids hits;
    for (const int id : counted) {
      const double shared = common(detection, masks[id]);
      const auto instance_px = static_cast<double>(masks[id].size());
      if (instance_px == 0.0) continue;
      const bool inside = common(detection, dilated[id]) >= half;
      const bool overlaps = shared / (2.0 * half + instance_px - shared) >= 0.25;
      const bool covers = common(detection, in_union) >= half && shared >= instance_px / 2.0;
      if (inside || overlaps || covers) hits.push_back(id);
    }
    match.is_false.push_back(hits.empty() && common(detection, in_union) < half && common(detection, ignored) < half);
    for (const int id : hits) match.fragments += times_hit[id]++ > 0 ? 1 : 0;
    match.hits.push_back(hits);
  }
  return match;
}

}  // namespace naive

TEST(MatchFrame, EqualsItsNaiveTwinOnRandomPictures) {
  std::mt19937 random(7);
  const auto draw = [&random](int from, int to) {
    return from + static_cast<int>(random() % static_cast<unsigned>(to - from));
  };
  int hits = 0;
  int false_alarms = 0;
  for (int round = 0; round < 60; ++round) {
    const cv::Size size(draw(1, 31), draw(1, 27));
    const auto draw_box = [&] {
      const cv::Point corner(draw(0, size.width), draw(0, size.height));
      return cv::Rect(corner, cv::Size(draw(1, size.width - corner.x + 1), draw(1, size.height - corner.y + 1)));
    };
    cv::Mat1b negative(size, uchar{0});
    for (const int id : {1, 2, 3, 255}) negative(draw_box()).setTo(id);
    std::vector<cv::Mat1b> regions(4);
    for (cv::Mat1b& mask : regions) {
      mask = cv::Mat1b(size, uchar{0});
      mask(draw_box()).setTo(255);
    }
    const int dilation_px = draw(0, 4);
    const FrameMatch fast = match_frame(negative, regions, {1, 3}, dilation_px);
    const FrameMatch slow = naive::match_frame(negative, regions, {1, 3}, dilation_px);
    EXPECT_EQ(fast.hits, slow.hits) << "round " << round;
    EXPECT_EQ(fast.is_false, slow.is_false) << "round " << round;
    EXPECT_EQ(fast.fragments, slow.fragments) << "round " << round;
    for (const Ids& ids : fast.hits) hits += static_cast<int>(ids.size());
    false_alarms += static_cast<int>(std::ranges::count(fast.is_false, true));
  }
  EXPECT_GT(hits, 50);  // the pictures do try both
  EXPECT_GT(false_alarms, 20);
}

TEST(FillContour, FillsWithItsBorder) {
  const cv::Mat1b mask = fill_contour({{2, 1}, {5, 1}, {5, 3}, {2, 3}}, {9, 7});
  EXPECT_EQ(cv::countNonZero(mask), 12);
  EXPECT_EQ(cv::countNonZero(mask(cv::Rect(2, 1, 4, 3))), 12);
}

TEST(FillContour, CutsOffWhatIsOutsideOfThePicture) {
  EXPECT_EQ(cv::countNonZero(fill_contour({{-5, -5}, {3, -5}, {3, 2}, {-5, 2}}, {9, 7})), 12);
  EXPECT_EQ(cv::countNonZero(fill_contour({{20, 20}, {30, 20}, {30, 30}}, {9, 7})), 0);
}

TEST(FillContour, FillsNothingWithoutPointsOrPicture) {
  EXPECT_EQ(cv::countNonZero(fill_contour({}, {9, 7})), 0);
  EXPECT_TRUE(fill_contour({{0, 0}, {1, 1}}, {}).empty());
  EXPECT_EQ(cv::countNonZero(fill_contour({{0, 0}}, {1, 1})), 1);
}

}  // namespace
}  // namespace brink
