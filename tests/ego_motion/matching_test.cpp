#include "ego_motion/matching.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "ego_motion/bucketing.hpp"
#include "ego_motion/outlier_removal.hpp"

namespace brink {
namespace {

const StereoCamera kCamera{100.0, 100.0, 60.0, 0.1};
const cv::Size kSize{200, 120};

Feature make_feature(float u, float v, std::uint8_t look, FeatureClass kind = FeatureClass::blob_maximum) {
  Feature feature{{u, v}, kind, 100, {}};
  feature.descriptor.fill(look);
  return feature;
}

FeatureIndex index_of(const std::vector<Feature>& features) { return {features, kSize}; }

TEST(FeatureIndex, FindsTheLikestInTheWindowOfTheSameClass) {
  const auto index = index_of({make_feature(10, 10, 90), make_feature(40, 12, 101), make_feature(60, 10, 120),
                               make_feature(41, 13, 100, FeatureClass::corner_minimum), make_feature(150, 10, 100)});
  const Feature wanted = make_feature(0, 0, 100);
  EXPECT_EQ(index.find(wanted, {{0, 0}, {100, 20}}, {}), 1);
  EXPECT_EQ(index.find(wanted, {{0, 0}, {199, 119}}, {}), 4) << "the exact one is in the window now";
  EXPECT_EQ(index.find(wanted, {{0, 30}, {100, 60}}, {}), std::nullopt) << "nothing there";
  EXPECT_EQ(index.find(wanted, {{-50, -50}, {-10, -10}}, {}), std::nullopt) << "outside the picture";
}

TEST(FeatureIndex, RefusesTwoThatLookAlikeAndOneThatLooksDifferent) {
  const Feature wanted = make_feature(0, 0, 100);
  const SearchWindow all{{0, 0}, {199, 119}};
  EXPECT_EQ(index_of({make_feature(10, 10, 110), make_feature(90, 10, 89)}).find(wanted, all, {}), std::nullopt);
  EXPECT_EQ(index_of({make_feature(10, 10, 200)}).find(wanted, all, {}), std::nullopt);
  EXPECT_EQ(index_of({}).find(wanted, all, {}), std::nullopt);
}

/// A pair of pictures with one feature at (u, v) and a disparity.
StereoFeatures make_pair(float u, float v, float disparity) {
  return {index_of({make_feature(u, v, 100)}), index_of({make_feature(u - disparity, v, 100)})};
}

TEST(MatchCircular, ClosesTheCircleByHand) {
  const auto matches =
      match_circular(make_pair(100, 50, 10), make_pair(108, 54, 12), kCamera, Eigen::Isometry3d::Identity(), 10.0, {});
  ASSERT_EQ(matches.size(), 1U);
  EXPECT_EQ(matches[0].previous_left, cv::Point2f(100, 50));
  EXPECT_EQ(matches[0].previous_right, cv::Point2f(90, 50));
  EXPECT_EQ(matches[0].current_left, cv::Point2f(108, 54));
  EXPECT_EQ(matches[0].current_right, cv::Point2f(96, 54));
  EXPECT_EQ(matches[0].cost, 0);
}

TEST(MatchCircular, NeedsTheSameRowAPositiveDisparityAndTheSearchWindow) {
  const auto count = [](const StereoFeatures& previous, const StereoFeatures& current, double radius) {
    return match_circular(previous, current, kCamera, Eigen::Isometry3d::Identity(), radius, {}).size();
  };
  EXPECT_EQ(count(make_pair(100, 50, 10), make_pair(100, 50, 10), 1.0), 1U);
  EXPECT_EQ(count(make_pair(100, 50, -10), make_pair(100, 50, -10), 1.0), 0U) << "eyes swapped";
  EXPECT_EQ(count(make_pair(100, 50, 10), make_pair(120, 50, 10), 10.0), 0U) << "too far";
  StereoFeatures shifted = make_pair(100, 50, 10);
  shifted.right = index_of({make_feature(90, 53, 100)});
  EXPECT_EQ(count(make_pair(100, 50, 10), shifted, 10.0), 0U) << "another row";
  EXPECT_EQ(count({index_of({}), index_of({})}, make_pair(100, 50, 10), 10.0), 0U);
}

TEST(MatchCircular, SearchesAroundThePrediction) {
  Eigen::Isometry3d predicted = Eigen::Isometry3d::Identity();
  predicted.translation().x() = 0.4;  // at 1 m: 40 px
  const auto matches = match_circular(make_pair(100, 50, 10), make_pair(140, 50, 10), kCamera, predicted, 2.0, {});
  EXPECT_EQ(matches.size(), 1U);
}

TEST(MatchStereo, IsMutual) {
  const StereoFeatures frame{index_of({make_feature(100, 50, 100), make_feature(120, 50, 100)}),
                             index_of({make_feature(90, 50, 100)})};
  EXPECT_TRUE(match_stereo(frame, {}).empty()) << "two left features for one on the right";
  EXPECT_EQ(match_stereo(make_pair(100, 50, 10), {}).size(), 1U);
}

CircularMatch make_match(float u, float v, float flow_u, float flow_v, int cost = 0) {
  const cv::Point2f flow(flow_u, flow_v);
  const cv::Point2f left(u, v);
  const cv::Point2f disparity(10.0F, 0.0F);
  return {left - flow, left - flow - disparity, left, left - disparity, cost};
}

TEST(RemoveOutliers, RemovesTheOneThatMovesOtherwise) {
  std::vector<CircularMatch> matches;
  matches.reserve(9);
  for (const float v : {50.0F, 60.0F, 70.0F}) {
    for (const float u : {50.0F, 60.0F, 70.0F}) matches.push_back(make_match(u, v, 5.0F, 1.0F));
  }
  matches[4] = make_match(60, 60, 25.0F, 1.0F);
  const auto kept = remove_outliers(matches, {});
  EXPECT_EQ(kept.size(), 8U);
  for (const CircularMatch& match : kept) EXPECT_NE(match.current_left, cv::Point2f(60, 60));
}

TEST(RemoveOutliers, RemovesTheLonelyAndTakesNone) {
  EXPECT_TRUE(remove_outliers({}, {}).empty());
  EXPECT_TRUE(remove_outliers({make_match(10, 10, 1, 1), make_match(150, 100, 1, 1)}, {}).empty());
}

TEST(ThinOut, KeepsTheBestOfEachSquare) {
  const auto kept = thin_out(
      {make_match(10, 10, 1, 1, 30), make_match(12, 12, 1, 1, 10), make_match(14, 14, 1, 1, 20), make_match(70, 10, 1, 1, 99)},
      50.0, 2);
  ASSERT_EQ(kept.size(), 3U);
  EXPECT_EQ(kept[0].cost, 10);
  EXPECT_EQ(kept[1].cost, 20);
  EXPECT_EQ(kept[2].cost, 99);
  EXPECT_TRUE(thin_out({}, 50.0, 2).empty());
}

TEST(ThinOut, GoesRowByRowOfSquaresAndPrefersTheEarlierOfEqualMatches) {
  const auto kept = thin_out({make_match(70, 60, 1, 1, 5), make_match(10, 60, 1, 1, 5), make_match(60, 10, 1, 1, 5),
                              make_match(12, 61, 2, 1, 5), make_match(-10, -5, 1, 1, 9)},
                             50.0, 1);
  ASSERT_EQ(kept.size(), 4U);
  EXPECT_EQ(kept[0].current_left, cv::Point2f(-10, -5));
  EXPECT_EQ(kept[1].current_left, cv::Point2f(60, 10));
  EXPECT_EQ(kept[2].current_left, cv::Point2f(10, 60));
  EXPECT_EQ(kept[3].current_left, cv::Point2f(70, 60));
}

}  // namespace
}  // namespace brink
