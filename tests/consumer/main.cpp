#include <iostream>

#include <brink/detector.hpp>

int main() {
  const cv::Mat1b black(64, 64, uchar{0});
  brink::Detector detector;
  const brink::Detection seen = detector.process(brink::make_frame(black, black, {60.0, 31.5, 31.5, 0.15}));
  std::cout << brink::to_string(seen.ground.state) << '\n';
  return seen.ground.state == brink::GroundState::not_visible ? 0 : 1;
}
