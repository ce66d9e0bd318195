#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "brink/detections.hpp"
#include "brink/evaluation_report.hpp"
#include "brink/files.hpp"
#include "brink/overlay.hpp"
#include "brink/pictures.hpp"
#include "evaluate.hpp"

namespace brink::app {
namespace {

/// One thing that went wrong in one frame.
struct Fault {
  std::size_t pair = 0;
  std::size_t position = 0;
  int id = 0;             ///< instance that was missed, obstacle that is wrong
  std::string group;      ///< faults of one group are the same thing over several frames
  double severity = 0.0;  ///< greater is worse
  std::string title;
};

enum class Kind : std::uint8_t { miss, false_alarm, distance_error };

struct KindOfFault {
  Kind kind;
  const char* name;     // of its pictures
  const char* heading;  // of its table
};
constexpr std::array<KindOfFault, 3> kKinds{{{Kind::miss, "miss", "Misses"},
                                             {Kind::false_alarm, "false_alarm", "False alarms"},
                                             {Kind::distance_error, "distance_error", "Distance errors"}}};

// The nearer to the walker, the worse.
double nearness(double distance_m) { return 1.0 / std::max(0.1, distance_m); }

void add_faults(Kind kind, std::size_t pair, std::size_t position, const SequenceScore& sequence, std::vector<Fault>& faults) {
  const FrameScore& frame = sequence.frames[position];
  const std::string where = fmt::format("{} frame {}", sequence.name, frame.frame);
  if (kind == Kind::miss) {
    for (const InstanceScore& one : frame.instances) {
      if (!one.settled || one.settled_hit) continue;
      const double distance = one.distance_m.value_or(0.0);
      faults.push_back({pair, position, one.id, fmt::format("{}/{}", pair, one.id), nearness(distance),
                        fmt::format("{}: missed {} at {:.2f} m", where, one.id, distance)});
    }
    return;
  }
  for (const DetectionScore& one : frame.detections) {
    if (kind == Kind::false_alarm && one.settled_false) {
      // Without poses nothing tells what is the same thing: every frame stands for itself.
      const std::string group =
          one.episode ? fmt::format("{}/{}", pair, *one.episode) : fmt::format("{}/{}/{}", pair, position, one.id);
      faults.push_back({pair, position, one.id, group, nearness(one.distance_m),
                        fmt::format("{}: false alarm {} at {:.2f} m", where, one.id, one.distance_m)});
    }
    if (kind == Kind::distance_error && one.distance_error_m) {
      faults.push_back({pair, position, one.id, fmt::format("{}/{}", pair, one.hits.front()), std::abs(*one.distance_error_m),
                        fmt::format("{}: {:+.2f} m wrong, claims {:.2f} m", where, *one.distance_error_m, one.distance_m)});
    }
  }
}

std::vector<Fault> find_faults(Kind kind, const std::vector<SequenceScore>& scores) {
  std::vector<Fault> faults;
  for (std::size_t pair = 0; pair < scores.size(); ++pair) {
    for (std::size_t position = 0; position < scores[pair].frames.size(); ++position) {
      add_faults(kind, pair, position, scores[pair], faults);
    }
  }
  std::stable_sort(faults.begin(), faults.end(), [](const Fault& a, const Fault& b) { return a.severity > b.severity; });
  return faults;
}

/// The first of each group, as many as are wanted.
std::set<std::size_t> choose(const std::vector<Fault>& faults, int wanted) {
  std::set<std::string> groups;
  std::set<std::size_t> chosen;
  for (std::size_t i = 0; i < faults.size() && static_cast<int>(chosen.size()) < wanted; ++i) {
    if (groups.insert(faults[i].group).second) chosen.insert(i);
  }
  return chosen;
}

/// The detections and the truth of one pair, kept while faults of it are looked at.
class PairReader {
 public:
  explicit PairReader(const EvaluationPair& pair)
      : detections_(read_detections(pair.detections)), truth_(pair.truth), sequence_(open_sequence_of(pair)) {}
  [[nodiscard]] const Detection& detection(std::size_t position) const { return detections_.at(position); }
  [[nodiscard]] const FrameTruth& truth(std::size_t position) {
    if (frame_ != position || last_.negative.empty()) last_ = truth_.read(static_cast<int>(position));
    frame_ = position;
    return last_;
  }
  [[nodiscard]] cv::Mat1f true_disparity(std::size_t position) const {
    return truth_.read_disparity(static_cast<int>(position));
  }
  [[nodiscard]] const StereoCamera& camera() const { return sequence_.camera(); }
  [[nodiscard]] cv::Mat3b picture(std::size_t position) const {
    // By its number: a sequence may have masks for some of its frames only.
    const std::vector<FrameStamp>& stamps = sequence_.stamps();
    const int number = detections_.at(position).frame;
    const auto stamp =
        std::find_if(stamps.begin(), stamps.end(), [number](const FrameStamp& one) { return one.index == number; });
    if (stamp == stamps.end()) return {};
    const Frame frame = sequence_.read(static_cast<int>(std::distance(stamps.begin(), stamp))).frame;
    if (!frame.left_color.empty()) return frame.left_color;
    if (frame.left.empty()) return draw_disparity(frame.disparity);
    cv::Mat3b picture;
    cv::merge(std::vector<cv::Mat>(3, frame.left), picture);
    return picture;
  }

 private:
  std::vector<Detection> detections_;
  SequenceTruth truth_;
  Sequence sequence_;
  std::size_t frame_ = 0;
  FrameTruth last_;
};

std::string explain(Kind kind, const Fault& fault, PairReader& reader) {
  const Detection& detection = reader.detection(fault.position);
  if (kind == Kind::miss) return explain_miss(reader.truth(fault.position), detection, fault.id, reader.camera());
  const auto obstacle = std::find_if(detection.obstacles.begin(), detection.obstacles.end(),
                                     [&fault](const NegativeObstacle& one) { return one.id == fault.id; });
  if (!detection.ground.plane) return to_string(obstacle->candidate.type) + " without a ground";
  const GroundPose& pose = detection.ground.pose;
  const GroundPlane plane = make_ground_plane(pose.height_m, pose.pitch_deg, pose.roll_deg, reader.camera());
  return explain_false_alarm(reader.true_disparity(fault.position), *obstacle, plane, reader.camera());
}

/// What was found while going through the faults of one kind.
struct Causes {
  std::map<std::string, int> frames;
  std::map<std::string, std::set<std::string>> groups;
};

std::string table(const KindOfFault& kind, const Causes& causes, std::size_t total) {
  std::vector<std::pair<std::string, int>> sorted(causes.frames.begin(), causes.frames.end());
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  std::string text =
      fmt::format("## {}: {}\n\n| cause | frames | share % | different ones |\n|---|---|---|---|\n", kind.heading, total);
  for (const auto& [cause, frames] : sorted) {
    text += fmt::format("| {} | {} | {:.1f} | {} |\n", cause, frames, 100.0 * frames / static_cast<double>(total),
                        causes.groups.at(cause).size());
  }
  return text + "\n";
}

/// Indices of faults, pair by pair and frame by frame, so that each file is read once.
std::vector<std::size_t> in_order_of_files(const std::vector<Fault>& faults) {
  std::vector<std::size_t> order(faults.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&faults](std::size_t a, std::size_t b) {
    return std::pair(faults[a].pair, faults[a].position) < std::pair(faults[b].pair, faults[b].position);
  });
  return order;
}

/// Draws the chosen ones of a kind and explains all of them.
std::string show_kind(const KindOfFault& kind, const std::vector<EvaluationPair>& pairs,
                      const std::vector<SequenceScore>& scores, const OutputFolder& folder, int wanted) {
  const std::vector<Fault> faults = find_faults(kind.kind, scores);
  const std::set<std::size_t> chosen = choose(faults, wanted);
  Causes causes;
  std::optional<PairReader> reader;
  std::size_t open_pair = pairs.size();
  for (const std::size_t i : in_order_of_files(faults)) {
    const Fault& fault = faults[i];
    if (fault.pair != open_pair) reader.emplace(pairs[fault.pair]);
    open_pair = fault.pair;
    std::string cause;
    if (kind.kind != Kind::distance_error) {
      cause = explain(kind.kind, fault, *reader);
      ++causes.frames[cause];
      causes.groups[cause].insert(fault.group);
    }
    if (!chosen.contains(i)) continue;
    const auto rank = std::distance(chosen.begin(), chosen.find(i)) + 1;
    const cv::Mat3b picture =
        draw_evaluation(reader->picture(fault.position), reader->truth(fault.position), reader->detection(fault.position),
                        scores[fault.pair].frames[fault.position], fault.title + (cause.empty() ? "" : ", " + cause));
    write_file(folder.file(fmt::format("{}_{:02}.png", kind.name, rank)), encode_png(picture));
  }
  return kind.kind == Kind::distance_error ? "" : table(kind, causes, faults.size());
}

}  // namespace

void write_gallery(const std::vector<EvaluationPair>& pairs, const std::vector<SequenceScore>& scores,
                   const EvaluationOutputs& outputs) {
  const OutputFolder folder(outputs.gallery);
  std::string text;
  for (const KindOfFault& kind : kKinds) text += show_kind(kind, pairs, scores, folder, outputs.gallery_size);
  write_file(folder.file("causes.md"), text);
}

}  // namespace brink::app
