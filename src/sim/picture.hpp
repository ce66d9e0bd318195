#pragma once

#include <opencv2/core.hpp>

#include "brink/sim/render.hpp"
#include "lighting.hpp"
#include "tracer.hpp"

namespace brink::sim {

/// Renderer::render on a tracer whose shutter is open for [time - shutter_s / 2, time + shutter_s / 2].
cv::Mat3f render_picture(const Scene& scene, const Tracer& tracer, const Lighting& lighting, const StereoCamera& camera,
                         const cv::Size& size, const CameraMotion& world_from_camera, double time, int eye,
                         const RenderParams& params, unsigned seed);

}  // namespace brink::sim
