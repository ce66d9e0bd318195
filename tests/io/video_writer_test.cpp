#include <csignal>
#include <filesystem>
#include <limits>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "brink/video.hpp"
#include "expect_error.hpp"
#include "temporary_folder.hpp"

namespace brink {
namespace {

const cv::Size kSize(320, 180);

// Noise: it cannot be compressed, so the file grows.
cv::Mat3b noise(int seed) {
  cv::Mat3b picture(kSize);
  cv::RNG random(static_cast<std::uint64_t>(seed) + 1);
  random.fill(picture, cv::RNG::UNIFORM, 0, 256);
  return picture;
}

// No file of this process can grow beyond a size, as on a full disk; errors instead of the signal that ends the process.
class SizeLimit {
 public:
  explicit SizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  SizeLimit(const SizeLimit&) = delete;
  SizeLimit& operator=(const SizeLimit&) = delete;
  ~SizeLimit() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int);
};

TEST(VideoWriter, WritesVideosThatAreReadBackWhole) {
  for (const char* name : {"walk.mp4", "walk.avi", "walk.mkv", "WALK.MP4"}) {
    const test::TemporaryFolder folder;
    VideoWriter video(folder / name, kSize, 15.0);
    for (int shade = 0; shade < 7; ++shade)
      video.write(cv::Mat3b(kSize, cv::Vec3b(0, 0, cv::saturate_cast<uchar>(30 * shade))));
    video.commit();
    EXPECT_EQ(folder.list(), std::set<std::string>{name});
    cv::VideoCapture reader(folder / name, cv::CAP_FFMPEG);
    EXPECT_NEAR(reader.get(cv::CAP_PROP_FPS), 15.0, 0.01) << name;
    int frames = 0;
    for (cv::Mat picture; reader.read(picture); ++frames) {
      EXPECT_EQ(picture.size(), kSize);
      EXPECT_NEAR(cv::mean(picture)[2], 30 * frames, 6) << name << " frame " << frames;
    }
    EXPECT_EQ(frames, 7) << name;
  }
}

TEST(VideoWriter, LeavesNothingWithoutCommitAndKeepsWhatWasThere) {
  const test::TemporaryFolder folder;
  const std::string path = folder.add("walk.mp4", "old");
  {
    VideoWriter video(path, kSize, 15.0);
    video.write(noise(0));
    EXPECT_EQ(folder.list().size(), 2U);
  }
  EXPECT_EQ(folder.list(), std::set<std::string>{"walk.mp4"});
  EXPECT_EQ(read_file(path), "old");
}

TEST(VideoWriter, RefusesOtherEndings) {
  for (const char* name : {"walk.mov", "walk.webm", "walk.txt", "walk", "mp4"}) {
    const test::TemporaryFolder folder;
    const auto open = [&] { VideoWriter(folder / name, kSize, 15.0); };
    test::expect_line_with(test::error_of<std::invalid_argument>(open), "a video must be named .mp4, .avi or .mkv");
    EXPECT_TRUE(folder.list().empty());
  }
}

TEST(VideoWriter, RefusesSizesAndRatesThatNoVideoHas) {
  const test::TemporaryFolder folder;
  const auto error = [&](const cv::Size& size, double fps) {
    return test::error_of<std::invalid_argument>([&] { VideoWriter(folder / "walk.mp4", size, fps); });
  };
  test::expect_line_with(error({321, 180}, 15.0), "size = 321x180, must be even");
  test::expect_line_with(error({0, 0}, 15.0), "size = 0x0");
  test::expect_line_with(error({320, 9000}, 15.0), "size = 320x9000");
  test::expect_line_with(error(kSize, 0.0), "fps = 0, must be");
  test::expect_line_with(error(kSize, std::numeric_limits<double>::quiet_NaN()), "fps = nan");
  EXPECT_TRUE(folder.list().empty());
}

TEST(VideoWriter, RefusesPicturesOfAnotherSize) {
  const test::TemporaryFolder folder;
  VideoWriter video(folder / "walk.mp4", kSize, 15.0);
  const auto write = [&] { video.write(cv::Mat3b(10, 10)); };
  test::expect_line_with(test::error_of<std::invalid_argument>(write), "picture of 10x10 px, the video has 320x180");
}

TEST(VideoWriter, RefusesAVideoWithoutFrames) {
  const test::TemporaryFolder folder;
  const auto commit = [&] { VideoWriter(folder / "walk.mp4", kSize, 15.0).commit(); };
  test::expect_line_with(test::error_of<std::runtime_error>(commit), "walk.mp4: cannot be written: there is no frame");
  EXPECT_TRUE(folder.list().empty());
}

TEST(VideoWriter, TellsWhereNothingCanBeWritten) {
  const test::TemporaryFolder folder;
  const auto error = [](const std::string& path) {
    return test::error_of<std::runtime_error>([&] { VideoWriter(path, kSize, 15.0); });
  };
  test::expect_line_with(error(folder / "none/walk.mp4"), "none/walk.mp4: cannot be written: No such file");
  std::filesystem::create_symlink("/dev/full", folder / "full.mp4");
  test::expect_line_with(error(folder / "full.mp4"), "full.mp4: cannot be written: a video needs a regular file");
}

TEST(VideoWriter, TellsAFullDiskAtOnceAndLeavesNothing) {
  for (const char* name : {"walk.mp4", "walk.avi", "walk.mkv"}) {
    const test::TemporaryFolder folder;
    int written = 0;
    const auto write_all = [&] {
      constexpr rlim_t kLimit = 400000;
      const SizeLimit limit(kLimit);
      VideoWriter video(folder / name, kSize, 15.0);
      for (; written < 1000; ++written) video.write(noise(written));
    };
    test::expect_line_with(test::error_of<std::runtime_error>(write_all),
                           std::string(name) + ": cannot be written: File too large");
    EXPECT_LT(written, 200);
    EXPECT_TRUE(folder.list().empty());
  }
}

TEST(VideoWriter, TellsThatNothingFitsAtAll) {
  const test::TemporaryFolder folder;
  const auto open = [&] {
    const SizeLimit limit(0);
    VideoWriter video(folder / "walk.mp4", kSize, 15.0);
  };
  test::expect_line_with(test::error_of<std::runtime_error>(open), "walk.mp4: cannot be written: File too large");
  EXPECT_TRUE(folder.list().empty());
}

TEST(VideoWriter, NoticesAtCommitWhatDidNotFitForAWhile) {
  for (const char* name : {"walk.mp4", "walk.avi", "walk.mkv"}) {
    const test::TemporaryFolder folder;
    const auto write_all = [&] {
      VideoWriter video(folder / name, kSize, 15.0);
      {
        const SizeLimit limit(0);
        for (int i = 0; i < 80; ++i) {
          try {
            video.write(noise(i));
          } catch (const std::runtime_error&) {
            continue;  // as if the room came back unseen
          }
        }
      }
      video.write(noise(0));
      video.commit();
    };
    test::expect_line_with(test::error_of<std::runtime_error>(write_all), "cannot be written: the video came out incomplete");
    EXPECT_TRUE(folder.list().empty());
  }
}

TEST(VideoName, IsToldByItsEnding) {
  EXPECT_TRUE(is_video_name("walk.mp4"));
  EXPECT_TRUE(is_video_name("a.b/walk.AVI"));
  EXPECT_TRUE(is_video_name("walk.webm"));  // refused later, not taken for a folder
  EXPECT_FALSE(is_video_name("pictures"));
  EXPECT_FALSE(is_video_name("pictures.d/"));
  EXPECT_FALSE(is_video_name("mp4"));
}

TEST(VideoFps, IsThatOfTheMedianStep) {
  EXPECT_DOUBLE_EQ(compute_video_fps({0.0, 0.1, 0.2, 0.3, 5.0}), 1.0 / (0.2 - 0.1));
  EXPECT_DOUBLE_EQ(compute_video_fps({0.0, 1.0, 2.0}), 1.0);
  EXPECT_DOUBLE_EQ(compute_video_fps({0.0, 0.001, 0.002}), 60.0);
  EXPECT_DOUBLE_EQ(compute_video_fps({0.0, 100.0}), 1.0);
}

TEST(VideoFps, IsOneWhereTimesTellNothing) {
  EXPECT_DOUBLE_EQ(compute_video_fps({}), 1.0);
  EXPECT_DOUBLE_EQ(compute_video_fps({3.0}), 1.0);
  EXPECT_DOUBLE_EQ(compute_video_fps({3.0, 3.0, 3.0}), 1.0);
}

}  // namespace
}  // namespace brink
