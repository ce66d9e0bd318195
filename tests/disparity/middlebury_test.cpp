#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "brink/disparity.hpp"
#include "brink/evaluation.hpp"
#include "test_data.hpp"

// Middlebury pairs with true disparities. Every pixel of known truth counts; nothing is cut off at the borders. The limits are
// what the widely used ELAS program reaches on the same pictures (algorithms.md): brink must be at least as good in each.
namespace brink {
namespace {

struct Score {
  double density = 0.0;           ///< share of the known pixels that have a disparity, %
  double bad_1 = 0.0;             ///< of the valid pixels, % further than 1 px from the truth
  double bad_2 = 0.0;             ///< 2 px
  double bad_3 = 0.0;             ///< 3 px
  double mean_error_px = 0.0;     ///< over the valid pixels
  double bad_2_or_invalid = 0.0;  ///< of all known pixels, %
};

/// @param mask where not 0 the pixel counts.
Score compute_score(const cv::Mat1f& disparity, const cv::Mat1f& truth, const cv::Mat1b& mask) {
  constexpr double kPercent = 100.0;
  const DisparityErrors errors = compute_disparity_errors(disparity, truth, mask);
  return {.density = kPercent * errors.density,
          .bad_1 = kPercent * errors.bad_1,
          .bad_2 = kPercent * errors.bad_2,
          .bad_3 = kPercent * errors.bad_3,
          .mean_error_px = errors.mean_error_px,
          .bad_2_or_invalid = kPercent * errors.bad_2_or_invalid};
}

struct Scene {
  cv::Mat1b left;
  cv::Mat1b right;
  cv::Mat1f truth;
  cv::Mat1b known;
};

Scene read_scene(const std::string& folder, const std::string& truth) {
  Scene scene;
  // Colour to grey as make_frame does it: the PNG reader's own conversion rounds differently.
  cv::cvtColor(cv::imread(folder + "/image_2/000000.png", cv::IMREAD_COLOR), scene.left, cv::COLOR_BGR2GRAY);
  cv::cvtColor(cv::imread(folder + "/image_3/000000.png", cv::IMREAD_COLOR), scene.right, cv::COLOR_BGR2GRAY);
  const cv::Mat stored = cv::imread(folder + "/" + truth + "/000000.png", cv::IMREAD_UNCHANGED);
  stored.convertTo(scene.truth, CV_32F, 1.0 / 256.0);
  cv::compare(scene.truth, 0.0, scene.known, cv::CMP_GT);
  return scene;
}

struct Method {
  std::string name;
  DisparityParams params;
};

std::vector<Method> make_methods() {
  std::vector<Method> methods = {{"elas", {}}, {"elas-paper", {}}, {"elas-middlebury", {}},
                                 {"bm", {}},   {"sgbm", {}},       {"sgbm-wls", {}}};
  methods[1].params.elas = ElasParams::paper();
  methods[2].params.elas = ElasParams::middlebury();
  for (std::size_t i = 3; i < methods.size(); ++i) methods[i].params.matcher = matcher_from_string(methods[i].name);
  return methods;
}

std::string to_row(const std::string& name, const Score& score) {
  return fmt::format("{:16} {:7.2f} {:7.2f} {:7.2f} {:7.2f} {:9.3f} {:14.2f}\n", name, score.density, score.bad_1, score.bad_2,
                     score.bad_3, score.mean_error_px, score.bad_2_or_invalid);
}

/// Prints how all methods do, over all known pixels and over those that every method fills. @return the scores over all.
std::vector<Score> compare_methods(const std::string& name, const Scene& scene) {
  const std::vector<Method> methods = make_methods();
  std::vector<cv::Mat1f> disparities;
  cv::Mat1b filled_by_all = scene.known.clone();
  for (const Method& method : methods) {
    disparities.push_back(compute_disparity(scene.left, scene.right, method.params));
    filled_by_all.setTo(0, disparities.back() == kInvalidDisparity);
  }
  const std::string header = "method           density   bad-1   bad-2   bad-3  error,px  bad-2|invalid\n";
  std::string table = fmt::format("\n{}, all known pixels, %\n{}", name, header);
  std::vector<Score> scores;
  for (std::size_t i = 0; i < methods.size(); ++i) {
    scores.push_back(compute_score(disparities[i], scene.truth, scene.known));
    table += to_row(methods[i].name, scores.back());
  }
  table += fmt::format("\n{}, the {:.1f} % of the known pixels that all methods fill\n{}", name,
                       100.0 * cv::countNonZero(filled_by_all) / cv::countNonZero(scene.known), header);
  for (std::size_t i = 0; i < methods.size(); ++i) {
    table += to_row(methods[i].name, compute_score(disparities[i], scene.truth, filled_by_all));
  }
  fmt::print("{}\n", table);
  return scores;
}

TEST(Middlebury, ElasOnConesIsAtLeastAsGoodAsTheReference) {
  BRINK_REQUIRE_DATA(folder, "cones");
  const std::vector<Score> scores = compare_methods("cones, not occluded", read_scene(folder, "disparity_noc"));
  const Score& elas = scores[0];
  EXPECT_GE(elas.density, 89.5);
  EXPECT_LE(elas.bad_2, 2.3);
  EXPECT_LE(elas.bad_2_or_invalid, 12.5);
  EXPECT_LE(elas.mean_error_px, 0.33);
  EXPECT_EQ(scores[2].density, 100.0) << "elas-middlebury";
}

TEST(Middlebury, ElasOnAloeIsAtLeastAsGoodAsTheReference) {
  BRINK_REQUIRE_DATA(folder, "aloe");
  const std::vector<Score> scores = compare_methods("aloe, occluded pixels included", read_scene(folder, "disparity"));
  const Score& elas = scores[0];
  EXPECT_GE(elas.density, 82.5);
  EXPECT_LE(elas.bad_2, 1.7);
  EXPECT_EQ(scores[2].density, 100.0) << "elas-middlebury";
}

}  // namespace
}  // namespace brink
