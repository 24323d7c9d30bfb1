// conav-export: a weights file in a format that other programs read.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>

#include "nhpm/model/onnx_export.h"

namespace {

int Export(const std::filesystem::path& weights, const std::filesystem::path& onnx) {
  const auto written =
      conav::nhpm::ReadWeightsFile(weights).and_then([&](const conav::nhpm::NetworkModel& model) {
        return conav::nhpm::WriteOnnxFile(onnx, model);
      });
  if (!written) fmt::print(stderr, "conav export: {}\n", written.error().text);
  return written ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Writes the network of a weights file as ONNX, for OpenCV, onnxruntime and others: input "
      "\"input\" [batch, 4, rows, columns], output \"probabilities\" [batch, 2, rows, columns] "
      "before "
      "masking. Exit codes: 0 done; 1 failed; 2 wrong use.",
      "conav export");
  std::filesystem::path weights;
  std::filesystem::path onnx;
  app.add_option("--weights", weights, "Weights file, as conav train makes it")->required();
  app.add_option("--onnx", onnx, "File to write")->required();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return Export(weights, onnx);
}
