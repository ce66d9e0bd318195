#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "brink/detections.hpp"
#include "brink/detector.hpp"
#include "brink/files.hpp"
#include "synthetic_pair.hpp"
#include "temporary_folder.hpp"

namespace brink::test {

inline std::string encoded(const std::string& extension, const cv::Mat& picture) {
  std::vector<uchar> bytes;
  cv::imencode(extension, picture, bytes);
  return {bytes.begin(), bytes.end()};
}

inline cv::Mat grey(int width, int height, int type = CV_8UC1) { return {height, width, type, cv::Scalar::all(120)}; }

/// A PNG of a header, no pixels and an end. @param side of the picture that it announces, px.
inline std::string png_without_pixels(std::uint32_t side) {
  std::string png = encoded(".png", cv::Mat1b(1, 1, uchar{0}));
  const std::string header = png.substr(12, 17);
  std::string large = header;
  for (const std::size_t at : {4, 8}) {
    for (std::size_t i = 0; i < 4; ++i) large[at + i] = static_cast<char>(side >> (24 - 8 * i));
  }
  std::uint32_t sum = 0xFFFFFFFF;  // CRC-32, bit by bit
  for (const char byte : large) {
    sum ^= static_cast<unsigned char>(byte);
    for (int bit = 0; bit < 8; ++bit) sum = (sum >> 1) ^ ((sum & 1) != 0 ? 0xEDB88320 : 0);
  }
  for (std::size_t i = 0; i < 4; ++i) large += static_cast<char>(~sum >> (24 - 8 * i));
  return png.replace(12, large.size(), large);
}

/// A JPEG whose header tells another size than it has.
inline std::string jpeg_of_size(std::string jpeg, int side) {
  const std::size_t header = jpeg.find("\xff\xc0");
  for (const std::size_t at : {header + 5, header + 7}) {
    jpeg[at] = static_cast<char>(side / 256);
    jpeg[at + 1] = static_cast<char>(side % 256);
  }
  return jpeg;
}

inline void add_pictures(const TemporaryFolder& folder) {
  const cv::Mat good = make_texture({160, 120}, 1);
  const std::string png = encoded(".png", good);
  const std::string jpeg = encoded(".jpg", good);
  std::string flipped = png;
  flipped[png.size() / 2] = static_cast<char>(flipped[png.size() / 2] ^ 1);
  for (const auto& [name, bytes] :
       std::vector<std::pair<const char*, std::string>>{{"good.png", png},
                                                        {"good.jpg", jpeg},
                                                        {"cut.png", png.substr(0, png.size() / 2)},
                                                        {"cut.jpg", jpeg.substr(0, jpeg.size() / 2)},
                                                        {"flipped.png", flipped},
                                                        {"text.png", "this is no picture\n"},
                                                        {"empty.png", ""},
                                                        {"picture.jpg", "GIF89a\x01\x01;"},
                                                        {"picture.tiff", encoded(".tiff", good)},
                                                        {"bomb.png", png_without_pixels(100000)},
                                                        {"huge.png", encoded(".png", cv::Mat1b(10000, 10000, uchar{0}))},
                                                        {"bomb.jpg", jpeg_of_size(jpeg, 65500)},
                                                        {"deep.png", encoded(".png", grey(160, 120, CV_16UC1))},
                                                        {"wide16.png", encoded(".png", grey(200, 120, CV_16UC1))},
                                                        {"cut.pfm", "Pf\n160 120\n-1.0\nhalf"},
                                                        {"size.pfm", "Pf\n160000 120000\n-1.0\n"},
                                                        {"color.pfm", "PF\n160 120\n-1.0\n"},
                                                        {"text.exr", "this is no picture\n"},
                                                        {"alpha.png", encoded(".png", grey(160, 120, CV_8UC4))},
                                                        {"large.png", encoded(".png", grey(200, 120))},
                                                        {"dot.png", encoded(".png", grey(1, 1))},
                                                        {"tiny.png", encoded(".png", grey(12, 9))},
                                                        {"black.png", encoded(".png", cv::Mat1b(120, 160, uchar{0}))},
                                                        {"secret.png", png},
                                                        {"s/0.png", encoded(".png", grey(320, 120))},
                                                        {"odd/0.png", encoded(".png", grey(161, 120))}}) {
    (void)folder.add(name, bytes);
  }
  const Pair ground = make_ground_pair(true);
  (void)folder.add("left.png", encoded(".png", ground.left));
  (void)folder.add("right.png", encoded(".png", ground.right));
  for (const std::string name : {"l/1", "l/2", "l/3", "r/1", "r/2", "r/3"}) (void)folder.add(name + ".png", png);
}

inline void add_calibrations(const TemporaryFolder& folder) {
  const auto projection = [](const char* name, double focal, double shift, double vertical = 0.0) {
    return fmt::format("{}: {} 0 80 {} 0 {} 60 {} 0 0 1 0\n", name, focal, shift, focal, vertical);
  };
  const std::string left = projection("P0", 350, 0);
  const std::string good = left + projection("P1", 350, -52.5);
  const std::string yaml =
      "%YAML:1.0\n---\nimage_width: 320\nimage_height: 240\n"
      "Q: !!opencv-matrix\n   rows: 4\n   cols: 4\n   dt: d\n   data: [ 1., 0., 0., -80., 0., 1., 0., -60., 0., 0., 0., 350., "
      "0., "
      "0., 6.6, 0. ]\n";
  const auto kalibr = [](const char* camera, const char* lens, const char* extrinsics) {
    return fmt::format(
        "{}:\n  camera_model: {}\n  intrinsics: [350, 350, 80, 60]\n  distortion_model: radtan\n"
        "  distortion_coeffs: [0.1, 0, 0, 0]\n  resolution: [160, 120]\n{}",
        camera, lens, extrinsics);
  };
  const char* beside = "  T_cn_cnm1: [[1, 0, 0, -0.1], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n";
  const auto ros = [](double shift) {
    return fmt::format(
        "image_width: 160\nimage_height: 120\ncamera_name: eye\ncamera_matrix: {{data: [350, 0, 80, 0, 350, 60, 0, 0, 1]}}\n"
        "distortion_model: plumb_bob\ndistortion_coefficients: {{data: [-0.1, 0.01, 0, 0, 0]}}\n"
        "rectification_matrix: {{data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}}\n"
        "projection_matrix: {{data: [350, 0, 80, {}, 0, 350, 60, 0, 0, 0, 1, 0]}}\n",
        shift);
  };
  std::string gigabytes = yaml;
  gigabytes.replace(gigabytes.find("320"), 3, "20000").replace(gigabytes.find("240"), 3, "20000");
  (void)folder.add("gigabytes.yaml", gigabytes);
  (void)folder.add("omni.yaml", kalibr("cam0", "omni", "") + kalibr("cam1", "omni", beside));
  (void)folder.add("zed.conf", "[LEFT_CAM_VGA]\nfx=350\nfy=350\ncx=336\ncy=188\n[STEREO]\nBaseline=120\n");
  (void)folder.add("sensor.yaml",
                   "T_BS:\n  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\nresolution: [160, 120]\n"
                   "camera_model: pinhole\nintrinsics: [350, 350, 80, 60]\ndistortion_model: radtan\n"
                   "distortion_coefficients: [0, 0, 0, 0]\n");
  (void)folder.add("ros.yaml", ros(0));
  (void)folder.add("ros_right.yaml", ros(-35));
  for (const auto& [name, text] :
       std::vector<std::pair<const char*, std::string>>{{"good.txt", good},
                                                        {"swapped.txt", left + projection("P1", 350, 52.5)},
                                                        {"millimetres.txt", left + projection("P1", 350, -52500)},
                                                        {"zero.txt", left + projection("P1", 350, 0)},
                                                        {"nan.txt", left + "P1: nan 0 80 -52.5 0 350 60 0 0 0 1 0\n"},
                                                        {"half.txt", left},
                                                        {"short.txt", left + "P1: 350 0 80 -52.5 0 350 60 0 0 0 1\n"},
                                                        {"vertical.txt", left + projection("P1", 350, 0, -52.5)},
                                                        {"focal.txt", left + projection("P1", 400, -52.5)},
                                                        {"prose.txt", "the cameras are 15 cm apart\n"},
                                                        {"size.yaml", yaml},
                                                        {"cut.yaml", yaml.substr(0, 120)},
                                                        {"bare.yaml", "%YAML:1.0\n---\nimage_width: 320\n"},
                                                        {"broken.yaml", "elas: {max_disparity: 3\n"},
                                                        {"unknown.yaml", "elas: {max_disparty: 3}\n"}}) {
    (void)folder.add(name, text);
  }
}

/// Folders of sequences, each with another fault.
inline void add_sequences(const TemporaryFolder& folder) {
  const std::string png = encoded(".png", make_texture({160, 120}, 1));
  const std::string calib = "P0: 350 0 80 0 0 350 60 0 0 0 1 0\nP1: 350 0 80 -52.5 0 350 60 0 0 0 1 0\n";
  const auto add = [&](const std::string& name, const std::vector<std::string>& pictures) {
    (void)folder.add(name + "/calib.txt", calib);
    for (const std::string& picture : pictures) (void)folder.add(name + "/image_0/" + picture, png);
    for (const std::string& picture : pictures) (void)folder.add(name + "/image_1/" + picture, png);
  };
  (void)folder.add("nothing/.keep", "");
  (void)folder.add("notes/notes.txt", "no pictures here\n");
  add("uncalibrated", {"0.png"});
  std::filesystem::remove(folder / "uncalibrated/calib.txt");
  add("words", {"one.png", "two.png"});
  add("jump", {"1.png", "1700000000.png"});
  add("still", {"0.png", "1.png"});
  (void)folder.add("still/times.txt", "0.5\n0.5\n");
  add("late", {"0.png", "1.png"});
  (void)folder.add("late/times.txt", "0.5\n");
  add("badpair", {"0.png"});
  (void)folder.add("badpair/image_1/0.png", "this is no picture\n");
  add("imu", {"0.png"});
  (void)folder.add("imu/imu.csv", "t,gx,gy,gz,ax,ay,az\n0,1,2,3\n");
  (void)folder.add("euroc/mav0/cam0/sensor.yaml",
                   "T_BS:\n  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\nresolution: [160, 120]\n"
                   "camera_model: pinhole\nintrinsics: [350, 350, 80, 60]\ndistortion_model: radtan\n"
                   "distortion_coefficients: [0, 0, 0, 0]\n");
  (void)folder.add("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 0\n");
  (void)folder.add("truth/negative/000000.png", encoded(".png", cv::Mat1b(120, 160, uchar{0})));
  const std::string first = to_json_line(make_failed_detection(0, 0.0, FrameStatus::no_picture, "gone"));
  (void)folder.add("one.jsonl", first);
  (void)folder.add("two.jsonl", first + to_json_line(make_failed_detection(1, 0.1, FrameStatus::no_picture, "gone")));
  (void)folder.add("cut.jsonl", R"({"frame":0,"time":0.0,"status":"ok","ground":{"state")");
}

inline void add_videos(const TemporaryFolder& folder) {
  {
    cv::VideoWriter writer(folder / "whole.mp4", cv::CAP_FFMPEG, cv::VideoWriter::fourcc('m', 'p', '4', 'v'), 15.0, {320, 120});
    for (int frame = 0; frame < 5; ++frame) writer.write(cv::Mat3b(120, 320, cv::Vec3b(90, 120, 40)));
  }
  const std::string whole = read_file(folder / "whole.mp4");
  (void)folder.add("cut.mp4", whole.substr(0, whole.size() / 2));
  (void)folder.add("video.png", whole);
  (void)folder.add("empty.mp4", "");
}

}  // namespace brink::test
