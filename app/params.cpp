#include <memory>
#include <string>

#include <fmt/format.h>

#include "brink/parameters.hpp"
#include "common.hpp"

namespace brink::app {
namespace {

struct ParamsOptions {
  MethodOptions method;
  bool yaml = false;
};

int list(const ParamsOptions& options) {
  const DetectorParams params = make_params(options.method);
  if (options.yaml) {
    print(to_yaml(params));
    return kExitOk;
  }
  std::string text;
  for (const Parameter& parameter : list_parameters(params)) {
    const std::string unit = parameter.unit.empty() ? "" : " " + parameter.unit;
    text += fmt::format("{} = {}{}: {}\n", parameter.key, parameter.value, unit, parameter.meaning);
  }
  text += "elas.preset = robotics, middlebury or paper: not a parameter, sets all of elas before the others\n";
  print(text);
  return kExitOk;
}

}  // namespace

Run add_params(CLI::App& command) {
  const auto options = std::make_shared<ParamsOptions>();
  command.add_flag("--yaml", options->yaml, "Print a file that --params reads");
  add_method_options(command, options->method);
  command.footer(
      "Without options the values printed are the defaults.\n"
      "Examples:\n"
      "  brink params\n"
      "  brink params --yaml --method paper > paper.yaml");
  return [options] { return list(*options); };
}

}  // namespace brink::app
