#include "nhpm/commands/dataset_commands.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>

#include "common/runtime/json.h"

namespace conav::nhpm {

int Failed(const Error& error) {
  fmt::print(stderr, "conav-dataset: {}\n", error.text);
  return 1;
}

int WriteTextOutput(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stdout);
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return 0;
  return Failed({ErrorCode::kIo, fmt::format("standard output: {}", std::strerror(errno))});
}

int WriteJsonOutput(const nlohmann::ordered_json& document, const std::string& file) {
  if (file == "-") return WriteTextOutput(document.dump(2) + "\n");
  const auto written = WriteJsonFile(file, document);
  return written ? 0 : Failed(written.error());
}

}  // namespace conav::nhpm
