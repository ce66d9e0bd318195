// Parameters, YAML: what is accepted is valid, and stays the same when it is written and read again.
#include "brink/parameters.hpp"

#include "input_files.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace brink;
  const std::string path = fuzz::put("parameters.yaml", fuzz::text_of(data, size));
  const auto params = fuzz::result_of([&] { return read_parameters(path); });
  if (!params) return 0;
  params->validate();
  const std::string yaml = to_yaml(*params);
  fuzz::require(to_yaml(read_parameters(fuzz::put("again.yaml", yaml))) == yaml, "parameters change when they are read again");
  return 0;
}
