#include <array>
#include <concepts>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <type_traits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "brink/evaluation.hpp"
#include "brink/files.hpp"

namespace brink {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "brink-scores-1";

template <typename Possible, typename Plain>
concept IsA = std::same_as<std::remove_const_t<Possible>, Plain>;

// The fields of each structure stand here once, for writing and for reading: `archive` is a Writer or a Reader.

void describe(auto& archive, IsA<EvaluationParams> auto& params) {
  archive("min_depth_m", params.min_depth_m);
  archive("max_range_m", params.max_range_m);
  archive("first_range_m", params.first_range_m);
  archive("min_visible_px", params.min_visible_px);
  archive("dilation_px", params.dilation_px);
  archive("settle_s", params.settle_s);
  archive("gone_s", params.gone_s);
  archive("validation_sightings", params.validation_sightings);
  archive("event_range_m", params.event_range_m);
  archive("warn_range_m", params.warn_range_m);
  archive("warn_delay_s", params.warn_delay_s);
  archive("episode_radius_m", params.episode_radius_m);
  archive("episode_gap_s", params.episode_gap_s);
  archive("block_frames", params.block_frames);
  archive("resamplings", params.resamplings);
  archive("seed", params.seed);
  archive.later("ahead_range_m", params.ahead_range_m);
  archive.later("ahead_deg", params.ahead_deg);
  archive.later("claim_error_m", params.claim_error_m);
  archive.later("dropped_s", params.dropped_s);
}

void describe(auto& archive, IsA<InstanceScore> auto& instance) {
  archive("id", instance.id);
  archive("visible_px", instance.visible_px);
  archive("distance_m", instance.distance_m);
  archive("raw", instance.raw);
  archive("settled", instance.settled);
  archive("reachable", instance.reachable);
  archive("hit", instance.hit);
  archive("settled_hit", instance.settled_hit);
  archive.later("depth_m", instance.depth_m);
  archive.later("expected", instance.expected);
}

void describe(auto& archive, IsA<DetectionScore> auto& detection) {
  archive("id", detection.id);
  archive("hits", detection.hits);
  archive("raw_false", detection.raw_false);
  archive("settled_false", detection.settled_false);
  archive("distance_m", detection.distance_m);
  archive("distance_error_m", detection.distance_error_m);
  archive("bearing_error_deg", detection.bearing_error_deg);
  archive("probability", detection.probability);
  archive("episode", detection.episode);
  archive.later("kind", detection.kind);
  archive.later("true_kind", detection.true_kind);
}

void describe(auto& archive, IsA<EdgeAhead> auto& edge) {
  archive("id", edge.id);
  archive("distance_m", edge.distance_m);
  archive("settled", edge.settled);
  archive("reported", edge.reported);
  archive("warned", edge.warned);
  archive("dropped", edge.dropped);
}

void describe(auto& archive, IsA<FrameScore> auto& frame) {
  archive("frame", frame.frame);
  archive("time", frame.time);
  archive("status", frame.status);
  archive("ground", frame.ground);
  archive("instances", frame.instances);
  archive("detections", frame.detections);
  archive("fragments", frame.fragments);
  archive.later("edges_ahead", frame.edges_ahead);
}

void describe(auto& archive, IsA<ApproachEvent> auto& event) {
  archive("id", event.id);
  archive("first_frame", event.first_frame);
  archive("first_distance_m", event.first_distance_m);
  archive("nearest_m", event.nearest_m);
  archive("warned_frame", event.warned_frame);
  archive("warned_distance_m", event.warned_distance_m);
  archive("lead_time_s", event.lead_time_s);
  archive("in_time", event.in_time);
  archive.later("held", event.held);
}

void describe(auto& archive, IsA<Episode> auto& episode) {
  archive("first_frame", episode.first_frame);
  archive("last_frame", episode.last_frame);
  archive("detections", episode.detections);
  archive("place", episode.place);
}

void describe(auto& archive, IsA<SequenceScore> auto& sequence) {
  archive("name", sequence.name);
  archive("duration_s", sequence.duration_s);
  archive("walked_m", sequence.walked_m);
  archive("frames", sequence.frames);
  archive("events", sequence.events);
  archive("episodes", sequence.episodes);
}

void describe(auto& archive, IsA<StoredScores> auto& scores) {
  archive("params", scores.params);
  archive("sequences", scores.sequences);
}

/// Structures to JSON.
class Writer {
 public:
  template <typename Value>
  void operator()(const char* name, const Value& value) {
    json_[name] = to_json(value);
  }

  /// A field that older files lack.
  template <typename Value>
  void later(const char* name, const Value& value) {
    (*this)(name, value);
  }

  template <typename Value>
  static Json to_json(const Value& value) {
    if constexpr (std::is_arithmetic_v<Value> || std::same_as<Value, std::string>) {
      return value;
    } else if constexpr (std::is_enum_v<Value>) {
      return to_string(value);
    } else {
      Writer writer;
      describe(writer, value);
      return writer.json_;
    }
  }
  template <typename Value>
  static Json to_json(const std::optional<Value>& value) {
    return value ? to_json(*value) : Json();
  }
  template <typename Value>
  static Json to_json(const std::vector<Value>& values) {
    Json json = Json::array();
    for (const Value& value : values) json.push_back(to_json(value));
    return json;
  }
  static Json to_json(const Eigen::Vector3d& point) { return {point.x(), point.y(), point.z()}; }

 private:
  Json json_ = Json::object();
};

/// JSON to structures, with an eye on every type.
class Reader {
 public:
  /// @param where the field that `json` is, for messages; "" = the whole file. @param file for messages.
  Reader(const Json& json, std::string where, const std::string& file) : json_(json), where_(std::move(where)), file_(file) {}

  template <typename Value>
  void operator()(const char* name, Value& value) const {
    value = member(name).template as<Value>();
  }

  template <typename Value>
  void later(const char* name, Value& value) const {
    require(json_.is_object(), "an object");
    if (json_.contains(name)) (*this)(name, value);
  }

  template <typename Value>
  [[nodiscard]] Value as() const {
    if constexpr (std::same_as<Value, bool>) {
      require(json_.is_boolean(), "true or false");
      return json_.get<bool>();
    } else if constexpr (std::same_as<Value, int>) {
      require(json_.is_number_integer() && json_.get<double>() >= std::numeric_limits<int>::min() &&
                  json_.get<double>() <= std::numeric_limits<int>::max(),
              "an integer");
      return json_.get<int>();
    } else if constexpr (std::same_as<Value, double>) {
      require(json_.is_number(), "a number");
      return json_.get<double>();
    } else if constexpr (std::same_as<Value, std::string>) {
      require(json_.is_string(), "a text");
      return json_.get<std::string>();
    } else if constexpr (std::same_as<Value, FrameStatus>) {
      return as_enumerator(std::array{FrameStatus::ok, FrameStatus::no_picture, FrameStatus::bad_frame});
    } else if constexpr (std::same_as<Value, GroundState>) {
      return as_enumerator(std::array{GroundState::seen, GroundState::uncertain, GroundState::not_visible});
    } else if constexpr (std::same_as<Value, ObstacleKind>) {
      return as_enumerator(
          std::array{ObstacleKind::unknown, ObstacleKind::stairs_down, ObstacleKind::edge, ObstacleKind::hole});
    } else if constexpr (std::same_as<Value, Eigen::Vector3d>) {
      const auto numbers = as<std::vector<double>>();
      require(numbers.size() == 3, "three numbers");
      return {numbers[0], numbers[1], numbers[2]};
    } else {
      return as_compound(Value{});
    }
  }

  [[noreturn]] void fail(std::string_view expected) const {
    const std::string value = json_.is_structured() ? (json_.is_array() ? "[...]" : "{...}") : json_.dump();
    throw std::runtime_error(
        fmt::format("{}: {} = {}, expected {}", file_, where_.empty() ? "the whole" : where_, value, expected));
  }

 private:
  void require(bool valid, std::string_view expected) const {
    if (!valid) fail(expected);
  }

  [[nodiscard]] Reader member(const char* name) const {
    require(json_.is_object(), "an object");
    const std::string where = where_.empty() ? name : where_ + "." + name;
    const auto found = json_.find(name);
    if (found == json_.end()) throw std::runtime_error(fmt::format("{}: {} is missing", file_, where));
    return {*found, where, file_};
  }

  template <typename Enum, std::size_t Count>
  [[nodiscard]] Enum as_enumerator(const std::array<Enum, Count>& all) const {
    std::string names;
    for (const Enum one : all) {
      if (json_.is_string() && json_.get<std::string>() == to_string(one)) return one;
      names += (names.empty() ? "" : ", ") + to_string(one);
    }
    fail("one of " + names);
  }

  template <typename Value>
  [[nodiscard]] std::optional<Value> as_compound(const std::optional<Value>& /*type*/) const {
    if (json_.is_null()) return std::nullopt;
    return as<Value>();
  }
  template <typename Value>
  [[nodiscard]] std::vector<Value> as_compound(std::vector<Value> values) const {
    require(json_.is_array(), "a list");
    values.reserve(json_.size());
    for (std::size_t i = 0; i < json_.size(); ++i) {
      values.push_back(Reader(json_[i], fmt::format("{}[{}]", where_, i), file_).as<Value>());
    }
    return values;
  }
  template <typename Value>
  [[nodiscard]] Value as_compound(Value value) const {
    describe(*this, value);
    return value;
  }

  const Json& json_;
  std::string where_;
  const std::string& file_;
};

Json parse(const std::string& path) {
  const std::string text = read_file(path);
  if (text.empty()) throw std::runtime_error(path + ": is empty, expected scores of brink evaluate");
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    throw std::runtime_error(
        fmt::format("{}: is no JSON at byte {} of {}; is it cut off or of another kind?", path, error.byte, text.size()));
  } catch (const Json::out_of_range&) {
    throw std::runtime_error(path + ": holds a number that is too large");
  }
}

/// What later steps rely on and types do not tell.
void require_consistent(const SequenceScore& sequence, const std::string& where) {
  for (std::size_t i = 1; i < sequence.frames.size(); ++i) {
    if (sequence.frames[i].frame > sequence.frames[i - 1].frame) continue;
    throw std::runtime_error(fmt::format("{}.frames[{}].frame = {}, expected more than the one before, {}", where, i,
                                         sequence.frames[i].frame, sequence.frames[i - 1].frame));
  }
  for (std::size_t i = 0; i < sequence.episodes.size(); ++i) {
    const int first = sequence.episodes[i].first_frame;
    if (std::ranges::binary_search(sequence.frames, first, {}, &FrameScore::frame)) continue;
    throw std::runtime_error(
        fmt::format("{}.episodes[{}].first_frame = {}, expected the number of one of the frames", where, i, first));
  }
}

}  // namespace

std::string to_json(const std::vector<SequenceScore>& sequences, const EvaluationParams& params) {
  Json json = {{"format", kFormat}};
  json.update(Writer::to_json(StoredScores{sequences, params}));
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";  // names of folders may be no UTF-8
}

StoredScores read_scores(const std::string& path) {
  const Json json = parse(path);
  if (!json.is_object() || json.value("format", Json()) != kFormat) {
    const Json format = json.is_object() ? json.value("format", Json()) : Json();
    Reader(format, "format", path).fail(fmt::format("\"{}\"", kFormat));
  }
  auto scores = Reader(json, "", path).as<StoredScores>();
  try {
    scores.params.validate();
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(fmt::format("{}: {}", path, error.what()));
  }
  for (std::size_t i = 0; i < scores.sequences.size(); ++i) {
    require_consistent(scores.sequences[i], fmt::format("{}: sequences[{}]", path, i));
  }
  return scores;
}

}  // namespace brink
