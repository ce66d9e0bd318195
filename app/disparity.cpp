#include "brink/disparity.hpp"

#include <memory>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "brink/files.hpp"
#include "brink/pictures.hpp"
#include "common.hpp"

namespace brink::app {
namespace {

struct DisparityOptions {
  std::string left;
  std::string right;
  std::string out;
  MethodOptions method;
  int threads = 0;
};

// Disparities need no calibration: any camera will do to make a checked frame.
Frame read_pair(const DisparityOptions& options) {
  const FrameReading reading = Sequence({1.0, 0.0, 0.0, 1.0}, {{0, 0.0, options.left, options.right}}).read(0);
  if (reading.status != FrameStatus::ok) throw std::runtime_error(reading.reason);
  return reading.frame;
}

int compute(const DisparityOptions& options) {
  const DetectorParams params = make_params(options.method);
  const DisparityFormat format = disparity_format(options.out);
  const Frame frame = read_pair(options);
  const auto threads = limit_threads(options.threads);
  OutputFile out(options.out);
  const cv::Mat1f disparity = compute_disparity(frame.left, frame.right, params.disparity);
  out.write(encode_disparity(disparity, format));
  out.commit();
  const int valid = cv::countNonZero(disparity >= 0.0F);
  say(fmt::format("{}: {}x{} px, density {:.1f} %", options.out, disparity.cols, disparity.rows,
                  100.0 * valid / static_cast<double>(disparity.total())));
  return kExitOk;
}

}  // namespace

Run add_disparity(CLI::App& command) {
  const auto options = std::make_shared<DisparityOptions>();
  command.add_option("LEFT", options->left, "Left picture, PNG or JPEG, 8 bit, rectified")->required();
  command.add_option("RIGHT", options->right, "Right picture, of the same size")->required();
  command
      .add_option("--out", options->out,
                  "Write the disparities of the left picture to this file. NAME.png: 16 bit, disparity times 256, 0 = none. "
                  "NAME.pfm: 32-bit float, infinity = none")
      ->type_name("FILE")
      ->required();
  add_method_options(command, options->method);
  add_threads_option(command, options->threads);
  command.footer(
      "Examples:\n"
      "  brink disparity left.png right.png --out disparity.png\n"
      "  brink disparity left.png right.png --out disparity.pfm --matcher sgbm --set sgbm.max_disparity=127");
  return [options] { return compute(*options); };
}

}  // namespace brink::app
