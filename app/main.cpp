#include <array>
#include <csignal>
#include <exception>
#include <map>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <opencv2/core/utils/logger.hpp>

#include "common.hpp"

namespace brink::app {
namespace {

struct Command {
  const char* name;
  const char* summary;
  Run (*add)(CLI::App&);
};

constexpr std::array<Command, 9> kCommands{{
    {"detect", "Find where the ground goes down, in one stereo pair or a sequence", add_detect},
    {"disparity", "Compute the disparity image of one stereo pair", add_disparity},
    {"odometry", "Compute the path of the camera through a sequence", add_odometry},
    {"params", "List every parameter with its value, unit and meaning", add_params},
    {"envelope", "Tell how small a drop a camera can see, and how far", add_envelope},
    {"bench", "Measure how long each stage takes on this machine", add_bench},
    {"simulate", "Make a virtual walk with exact truth", add_simulate},
    {"evaluate", "Compare detections, trajectories or disparities with the truth", add_evaluate},
    {"compare", "Tell whether one evaluation is worse than another, beyond chance", add_compare},
}};

/// Help as sentences, one line for each option: a screen reader reads it from left to right, columns would tear it apart.
class PlainFormatter : public CLI::Formatter {
 public:
  PlainFormatter() {
    label("Positionals", "Input");
    label("SUBCOMMAND", "COMMAND");
  }
  std::string make_option(const CLI::Option* option, bool is_positional) const override {
    std::string line = "  " + make_option_name(option, is_positional);
    if (!is_positional && !option->get_type_name().empty()) line += " " + option->get_type_name();
    line += ": " + option->get_description() + ".";
    if (option->get_required()) line += " Required.";
    if (!option->get_default_str().empty()) line += " Default: " + option->get_default_str() + ".";
    return line + "\n";
  }
  std::string make_subcommand(const CLI::App* command) const override {
    return fmt::format("  {}: {}.\n", command->get_name(), command->get_description());
  }
};

int run(int argc, char** argv) {
  CLI::App app("brink finds where the ground goes down (holes, stairs, platform edges) in the pictures of a stereo camera",
               "brink");
  app.formatter(std::make_shared<PlainFormatter>());
  app.set_version_flag("--version", "brink " BRINK_VERSION, "Print the version");
  app.set_help_flag("-h,--help", "Print this help");
  app.require_subcommand(0, 1);  // checked below: CLI11's own message does not name a mistyped command
  app.footer(
      "brink COMMAND --help tells more about a command.\n"
      "Exit codes: 0 done, 1 the input cannot be used, 2 wrong use of the command.\n"
      "brink is an aid beside cane or dog, not a certified safety function.");
  std::map<const CLI::App*, Run> runs;
  for (const Command& command : kCommands) {
    CLI::App* subcommand = app.add_subcommand(command.name, command.summary)->group("Commands");
    runs[subcommand] = command.add(*subcommand);
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ExtrasError&) {
    const std::string word = app.remaining(true).front();
    if (word.starts_with('-')) {
      say(word + ": no such option (brink COMMAND --help lists them)");
    } else if (app.get_subcommands().empty()) {
      say(word + ": no such command (brink --help lists them)");
    } else {
      say(word + " was not expected here: a pattern such as 'left/*.png' must stand in quotes");
    }
    return kExitUsage;
  } catch (const CLI::ParseError& error) {
    say(fmt::format("{} (brink --help tells more)", error.what()));
    return kExitUsage;
  }
  if (app.get_subcommands().empty()) {
    say("no command given (brink --help lists them)");
    return kExitUsage;
  }
  return runs.at(app.get_subcommands().front())();
}

}  // namespace
}  // namespace brink::app

int main(int argc, char** argv) {
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
  std::signal(SIGXFSZ, SIG_IGN);  // a file that grows too large becomes an error that is told, not the end of the process
  try {
    return brink::app::run(argc, argv);
  } catch (const std::bad_alloc&) {
    brink::app::say("not enough memory");
    return brink::app::kExitData;
  } catch (const std::invalid_argument& error) {
    brink::app::say(error.what());
    return brink::app::kExitUsage;
  } catch (const std::exception& error) {
    brink::app::say(error.what());
    return brink::app::kExitData;
  }
}
