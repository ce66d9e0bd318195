#include "brink/parameters.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "count_fields.hpp"
#include "expect_error.hpp"
#include "temporary_folder.hpp"

namespace brink {
namespace {

std::size_t count_keys(const std::string& group) {
  const auto parameters = list_parameters();
  return static_cast<std::size_t>(
      std::count_if(parameters.begin(), parameters.end(), [&group](const auto& p) { return p.key.starts_with(group + "."); }));
}

// Another value of the same type, within the parameter's limits for all but a few.
std::string other_value(const Parameter& parameter) {
  if (parameter.key == "disparity.matcher") return parameter.value == "sgbm-wls" ? "bm" : "sgbm-wls";
  if (parameter.value == "true") return "false";
  if (parameter.value == "false") return "true";
  return parameter.value.find('.') == std::string::npos ? std::to_string(std::stoi(parameter.value) + 2) : "0.3125";
}

std::string refusal(const std::string& key, const std::string& value) {
  return test::error_of<std::invalid_argument>([&] { with_settings({}, {{key, value}}); });
}

std::string fault(const std::string& yaml) {
  const test::TemporaryFolder folder;
  return test::error_of<std::runtime_error>([&] { read_parameters(folder.add("p.yaml", yaml)); });
}

TEST(Parameters, AreAsManyAsTheStructuresHaveFields) {
  EXPECT_EQ(count_keys("elas"), test::count_fields<ElasParams>());
  EXPECT_EQ(count_keys("bm"), test::count_fields<BmParams>());
  EXPECT_EQ(count_keys("sgbm"), test::count_fields<SgbmParams>());
  EXPECT_EQ(count_keys("ground"), test::count_fields<GroundParams>());
  EXPECT_EQ(count_keys("candidates"), test::count_fields<CandidateParams>());
  EXPECT_EQ(count_keys("ego_motion"), test::count_fields<EgoMotionParams>());
  EXPECT_EQ(count_keys("tracking"), test::count_fields<TrackingParams>());
  EXPECT_EQ(count_keys("disparity"), test::count_fields<DisparityParams>() - 3);  // elas, bm and sgbm are groups of their own
  EXPECT_EQ(count_keys("detector"), test::count_fields<DetectorParams>() - 5);    // so are the stages
}

TEST(Parameters, EachHasItsOwnKeyAndAMeaning) {
  std::set<std::string> keys;
  for (const Parameter& parameter : list_parameters()) {
    EXPECT_TRUE(keys.insert(parameter.key).second) << parameter.key;
    EXPECT_GT(parameter.meaning.size(), 5U) << parameter.key;
  }
}

TEST(Parameters, SettingOneChangesThatOneOnly) {
  for (const Parameter& parameter : list_parameters()) {
    const std::string value = other_value(parameter);
    const auto changed = list_parameters(with_settings({}, {{parameter.key, value}}));
    const auto before = list_parameters();
    for (std::size_t i = 0; i < before.size(); ++i) {
      EXPECT_EQ(changed[i].value, before[i].key == parameter.key ? value : before[i].value) << before[i].key;
    }
  }
}

TEST(Parameters, ComeBackFromTheYamlThatWasWritten) {
  const test::TemporaryFolder folder;
  for (const DetectorParams& params : {DetectorParams::brink(), DetectorParams::paper()}) {
    const std::string yaml = to_yaml(params);
    EXPECT_EQ(to_yaml(read_parameters(folder.add("p.yaml", yaml))), yaml);
  }
}

TEST(Parameters, PresetsComeBeforeOtherSettingsWhereverTheyStand) {
  const DetectorParams params = with_settings({}, {{"elas.gap_width_px", "11"}, {"elas.preset", "middlebury"}});
  ElasParams expected = ElasParams::middlebury();
  EXPECT_EQ(params.disparity.elas.gap_width_px, 11);
  EXPECT_EQ(params.disparity.elas.support_threshold, expected.support_threshold);
  EXPECT_EQ(params.disparity.elas.add_corners, expected.add_corners);
  test::expect_line_with(refusal("elas.preset", "best"), "elas.preset = best, must be robotics, middlebury or paper");
}

TEST(Parameters, OfAKeyGivenTwiceTheLastOneCounts) {
  EXPECT_EQ(with_settings({}, {{"ground.seed", "5"}, {"ground.seed", "6"}}).ground.seed, 6);
}

TEST(Parameters, AnUnknownKeyIsNamedWithTheMostSimilarOne) {
  test::expect_line_with(refusal("candidates.min_dept_m", "1"),
                         "unknown parameter candidates.min_dept_m: did you mean candidates.min_depth_m?");
  test::expect_line_with(refusal("min_depth_m", "1"), "did you mean candidates.min_depth_m?");
  test::expect_line_with(refusal("", "1"), "unknown parameter ");
}

TEST(Parameters, AValueOfTheWrongTypeIsNamed) {
  test::expect_line_with(refusal("elas.max_disparity", "many"), "elas.max_disparity = many, must be a whole number");
  test::expect_line_with(refusal("elas.max_disparity", "1.5"), "elas.max_disparity = 1.5, must be a whole number");
  test::expect_line_with(refusal("elas.max_disparity", "99999999999"), "must be a whole number");
  test::expect_line_with(refusal("candidates.min_depth_m", ""), "candidates.min_depth_m = , must be a number");
  test::expect_line_with(refusal("candidates.min_depth_m", "0.1m"), "candidates.min_depth_m = 0.1m, must be a number");
  test::expect_line_with(refusal("candidates.min_depth_m", "nan"), "candidates.min_depth_m = nan, must be a number");
  test::expect_line_with(refusal("elas.subpixel", "1"), "elas.subpixel = 1, must be true or false");
  test::expect_line_with(refusal("disparity.matcher", "magic"), "matcher = magic, must be");
}

TEST(ParseSetting, SplitsAtTheFirstEqualsSign) {
  EXPECT_EQ(parse_setting("a.b=c=d"), Setting("a.b", "c=d"));
  EXPECT_EQ(parse_setting("a.b = c"), Setting("a.b", "c"));
  for (const std::string text : {"a.b", "=c", ""}) EXPECT_THROW(parse_setting(text), std::invalid_argument) << text;
}

TEST(ReadParameters, ReadsGroupsAndDottedKeysOverTheGivenValues) {
  const test::TemporaryFolder folder;
  DetectorParams base;
  base.ground.seed = 9;
  const DetectorParams params = read_parameters(
      folder.add("p.yaml", "elas: {max_disparity: 128, preset: middlebury}\ncandidates.min_depth_m: 0.01\n"), base);
  EXPECT_EQ(params.disparity.elas.max_disparity, 128);
  EXPECT_EQ(params.disparity.elas.support_threshold, ElasParams::middlebury().support_threshold);
  EXPECT_EQ(params.candidates.min_depth_m, 0.01);
  EXPECT_EQ(params.ground.seed, 9);
}

TEST(ReadParameters, NamesTheFaultOfAFile) {
  test::expect_line_with(fault("elas: {max_dsparity: 3}"),
                         "p.yaml: unknown parameter elas.max_dsparity: did you mean elas.max_disparity?");
  test::expect_line_with(fault("elas: 3"), "p.yaml: unknown parameter elas");
  test::expect_line_with(fault("elas: [1, 2]"), "p.yaml: line 1: elas has no value");
  test::expect_line_with(fault("elas:\n  max_disparity:\n"), "elas.max_disparity has no value");
  test::expect_line_with(fault("just words"), "p.yaml: holds no parameters");
  test::expect_line_with(fault(""), "p.yaml: holds no parameters");
  test::expect_line_with(fault("elas: {max_disparity: 3\n"), "p.yaml: is not YAML: line ");
  test::expect_line_with(fault("elas: {max_disparity: -3}"), "p.yaml: elas.max_disparity = -3, must be");
  test::expect_line_with(test::error_of<std::runtime_error>([] { read_parameters("/nowhere.yaml"); }),
                         "/nowhere.yaml: no such file");
}

}  // namespace
}  // namespace brink
