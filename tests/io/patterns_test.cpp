#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "brink/pictures.hpp"
#include "brink/sequence.hpp"
#include "expect_error.hpp"
#include "io/name_numbers.hpp"
#include "synthetic_pair.hpp"
#include "temporary_folder.hpp"

namespace brink::test {
namespace {

using Names = std::vector<std::string>;
using Numbers = std::vector<std::int64_t>;

TEST(NameNumbers, IsTheLastNumberThatDiffers) {
  EXPECT_EQ(find_name_numbers({"a/left_0007.png", "a/left_12.png"})->values, (Numbers{7, 12}));
  EXPECT_EQ(find_name_numbers({"7_cam0.png", "12_cam0.png"})->values, (Numbers{7, 12}));
  EXPECT_EQ(find_name_numbers({"walk3/left.5.png"})->values, (Numbers{5}));
  const auto decimals = find_name_numbers({"1305031102.175304.png", "1305031102.2.png"});
  EXPECT_EQ(decimals->values, (Numbers{1305031102175304, 1305031102200000}));
  EXPECT_EQ(decimals->decimals, 6);
}

TEST(NameNumbers, ThereAreNoneWithoutDigitsOrTwiceTheSameOrTooMany) {
  EXPECT_FALSE(find_name_numbers({}));
  EXPECT_FALSE(find_name_numbers({"left.png"}));
  EXPECT_FALSE(find_name_numbers({"a1.png", "b1.png"}));
  EXPECT_FALSE(find_name_numbers({"a1.png", "b.png"}));
  EXPECT_FALSE(find_name_numbers({"99999999999999999999.png"}));
}

// Thirty frames a second, counted in each unit.
TEST(NameTimes, UnitIsToldByTheStep) {
  for (const auto& [step, unit] : {std::pair(33333333, "ns"), std::pair(33333, "us"), std::pair(33, "ms")}) {
    const auto times = to_times({1000, 1000 + step, 1000 + 2 * step, 1000 + 300 * step}, 0);
    ASSERT_TRUE(times) << unit;
    EXPECT_EQ(times->unit, unit);
    EXPECT_EQ(times->seconds[0], 0.0);
    EXPECT_NEAR(times->seconds[2], 2.0 / 30.0, 1e-3);
  }
  EXPECT_EQ(to_times({5, 6, 7}, 0)->unit, "s");
  EXPECT_FALSE(to_times({0, 1000000000000}, 0));
}

TEST(NameTimes, NumbersWithDecimalsAreSeconds) {
  const auto times = to_times({1305031102175304, 1305031102211214}, 6);
  EXPECT_EQ(times->unit, "s");
  EXPECT_NEAR(times->seconds[1], 0.03591, 1e-9);
  EXPECT_FALSE(to_times({0, 7000000000000000000, 7000000000000000001}, 18)) << "a double does not tell the last two apart";
}

class Patterns : public ::testing::Test {
 protected:
  void add(const Names& names) const {
    for (const std::string& name : names) (void)folder_.add(name, encode_png(make_texture({64, 48}, 1)));
  }
  Sequence open(const std::string& left, const std::string& right, const TimeSource& times = {}) const {
    return open_pairs(folder_ / left, folder_ / right, {calibration_}, times);
  }
  [[nodiscard]] std::string fault(const std::string& left, const std::string& right, const TimeSource& times = {}) const {
    return error_of<std::runtime_error>([&] { open(left, right, times); });
  }
  static Numbers indices(const Sequence& sequence) {
    Numbers numbers;
    for (const FrameStamp& stamp : sequence.stamps()) numbers.push_back(stamp.index);
    return numbers;
  }
  static std::string statuses(const Sequence& sequence) {
    std::string text;
    for (int i = 0; i < sequence.size(); ++i) text += to_string(sequence.read(i).status) + " ";
    return text;
  }

  TemporaryFolder folder_;
  std::string calibration_ = folder_.add("calib.txt", half_size_calibration());
};

TEST_F(Patterns, AreToldFromPaths) {
  add({"walk[1].png"});
  EXPECT_FALSE(is_pattern(folder_ / "walk[1].png"));  // a file of that name is that file
  EXPECT_TRUE(is_pattern("left/*.png"));
  EXPECT_TRUE(is_pattern("left_%06d.png"));
  EXPECT_TRUE(is_pattern("left_%d.png"));
  EXPECT_FALSE(is_pattern("left.png"));
  EXPECT_FALSE(is_pattern("100%.png"));
}

TEST_F(Patterns, ArePairedByTheNumbersInTheirNames) {
  add({"l/a_9.png", "l/a_10.png", "l/a_11.png", "r/b_0009.png", "r/b_0010.png", "r/b_0011.png"});
  const Sequence sequence = open("l/*.png", "r/*.png");
  EXPECT_EQ(indices(sequence), (Numbers{9, 10, 11}));
  EXPECT_EQ(statuses(sequence), "ok ok ok ");
  EXPECT_EQ(sequence.stamps()[1].time, 10.0);
  ASSERT_EQ(sequence.remarks().size(), 1U);
  EXPECT_NE(sequence.remarks()[0].find("3 frames, paired by the numbers in their names, no times; calibration: KITTI"),
            std::string::npos)
      << sequence.remarks()[0];
}

TEST_F(Patterns, MissingNumbersAreFramesWithoutPictures) {
  add({"l/1.png", "l/2.png", "l/5.png", "r/1.png", "r/5.png"});
  const Sequence sequence = open("l/*.png", "r/*.png", {.fps = 10.0});
  EXPECT_EQ(indices(sequence), (Numbers{1, 2, 3, 4, 5}));
  EXPECT_EQ(statuses(sequence), "ok no_picture no_picture no_picture ok ");
  EXPECT_EQ(sequence.stamps()[4].time, 0.5);
  EXPECT_EQ(sequence.read(1).reason, folder_ / "l/2.png: has no partner in the other eye");
  EXPECT_NE(sequence.read(2).reason.find("number 3: no such file"), std::string::npos);
  ASSERT_EQ(sequence.remarks().size(), 2U);
  EXPECT_NE(sequence.remarks()[1].find("3 left and 2 right pictures: frames without a partner: 1, the first is frame 2"),
            std::string::npos)
      << sequence.remarks()[1];
}

TEST_F(Patterns, EveryFifthPictureIsNoGap) {
  add({"l/0.png", "l/5.png", "l/15.png", "r/0.png", "r/5.png", "r/15.png"});
  EXPECT_EQ(indices(open("l/*.png", "r/*.png")), (Numbers{0, 5, 10, 15}));
}

TEST_F(Patterns, ArePairedByOrderWhereNamesShareNoNumber) {
  add({"l/100.png", "l/133.png", "r/101.png", "r/134.png", "x/b.png", "x/a.png", "y/c.png", "y/d.png"});
  const Sequence times = open("l/*.png", "r/*.png", {.names = true});
  EXPECT_EQ(statuses(times), "ok ok ");
  EXPECT_NE(times.remarks()[0].find("paired by order, times from the names, in ms"), std::string::npos) << times.remarks()[0];
  const Sequence words = open("x/*.png", "y/*.png");
  EXPECT_EQ(indices(words), (Numbers{0, 1}));
  EXPECT_EQ(statuses(words), "ok ok ");
}

TEST_F(Patterns, NumbersOfWhichMostAreMissingAreNoFrameNumbers) {
  add({"l/100.png", "l/133.png", "l/167.png", "r/100.png", "r/133.png", "r/167.png"});
  EXPECT_EQ(indices(open("l/*.png", "r/*.png")), (Numbers{0, 1, 2}));
}

TEST_F(Patterns, TimesInNamesAreNoFrameNumbers) {
  add({"l/1403636579763555584.png", "l/1403636579813555456.png", "l/1403636579913555456.png", "r/1403636579763555584.png",
       "r/1403636579913555456.png"});
  const Sequence sequence = open("l/*.png", "r/*.png", {.names = true});
  EXPECT_EQ(indices(sequence), (Numbers{0, 1, 2}));
  EXPECT_NEAR(sequence.stamps()[1].time, 0.049999872, 1e-12);
  EXPECT_EQ(statuses(sequence), "ok no_picture ok ");
  EXPECT_EQ(indices(open("l/*.png", "r/*.png")), (Numbers{0, 1, 2}));  // too far apart for frame numbers
}

TEST_F(Patterns, PlaceOfANumberTakesDigitsOnly) {
  add({"left_000001.png", "left_000002.png", "left_best.png", "left_3.png", "right_000001.png", "right_000002.png"});
  EXPECT_EQ(indices(open("left_%06d.png", "right_%06d.png")), (Numbers{1, 2}));
  add({"left_(1).png", "right_(1).png"});
  EXPECT_EQ(indices(open("left_(%d).png", "right_(%d).png")), (Numbers{1}));
}

TEST_F(Patterns, TimesFileHasALineForEachFrame) {
  add({"l/4.png", "l/5.png", "r/4.png", "r/5.png"});
  const TimeSource two{.file = folder_.add("two.txt", "7.5\n8\n")};
  EXPECT_EQ(open("l/*.png", "r/*.png", two).stamps()[1].time, 8.0);
  const TimeSource from_zero{.file = folder_.add("six.txt", "0\n1\n2\n3\n4.25\n5.5\n")};
  EXPECT_EQ(open("l/*.png", "r/*.png", from_zero).stamps()[0].time, 4.25);
  expect_line_with(fault("l/*.png", "r/*.png", {.file = folder_.add("three.txt", "0\n1\n2\n")}),
                   "three.txt: has 3 times, expected one for each of 2 frames");
  expect_line_with(fault("l/*.png", "r/*.png", {.file = folder_ / "none.txt"}), "none.txt: no such file");
}

TEST_F(Patterns, ThatCannotBeUsedAreRefused) {
  add({"l/1.png", "l/2.png", "l/a.png", "r/1.png", "r/3.png"});
  expect_line_with(fault("l/*.jpg", "r/*.png"), "l/*.jpg: no such file, and no file matches it as a pattern");
  expect_line_with(fault("l/*.png", "r/*.png"),
                   "3 left and 2 right pictures, and their names share no numbers to pair them by");
  expect_line_with(fault("l/?.png", "r/?.png", {.names = true}), "share no numbers");
  add({"x/a.png", "y/b.png"});
  expect_line_with(fault("x/*.png", "y/*.png", {.names = true}), "the names tell no times");
  expect_line_with(error_of<std::invalid_argument>([&] { open("l/%d_*.png", "r/*.png"); }),
                   "must have one %d and no *, ? or [");
  expect_line_with(error_of<std::invalid_argument>([&] { open("l/?.png", "r/?.png", {.fps = 15.0, .names = true}); }),
                   "times = names, must not be given together with fps = 15");
}

TEST_F(Patterns, OfSideBySidePicturesAreFrames) {
  add({"s/img_3.png", "s/img_4.png"});
  const Sequence sequence = open_side_by_side(folder_ / "s/*.png", {calibration_}, {.fps = 2.0});
  EXPECT_EQ(indices(sequence), (Numbers{3, 4}));
  EXPECT_EQ(sequence.stamps()[1].time, 2.0);
  EXPECT_EQ(sequence.read(0).frame.left.size(), cv::Size(32, 48));
}

}  // namespace
}  // namespace brink::test
