#include <CLI/CLI.hpp>
#include <filesystem>

#include "common/cli/cli.h"
#include "common/runtime/file.h"
#include "nhpm/model/weights_file.h"

// conav-export: writes a weights file in a format for other programs.

namespace conav::nhpm {
namespace {

constexpr const char* kProgram = "conav export";

int Export(const std::filesystem::path& weights, const std::filesystem::path& onnx) {
  const int code = CheckFiles(kProgram, {{"--weights", weights}}, {{"--onnx", onnx}});
  if (code != 0) return code;
  const auto written =
      ReadWeightsFile(weights).and_then([&](const NetworkModel& model) -> Result<void> {
        if (model.weights.shape.architecture == Architecture::kConvolutional) {
          return WriteFile(onnx, ToOnnx(model));
        }
        return Fail(ErrorCode::kInvalidArgument,
                    weights.string() + ": is an encoder-decoder; only model nhpm can be exported");
      });
  return ExitCode(kProgram, written);
}

}  // namespace
}  // namespace conav::nhpm

int main(int argc, char** argv) {
  CLI::App app(
      "Writes the network of a weights file as ONNX, for OpenCV, onnxruntime and others: input "
      "\"input\" [batch, 4, rows, columns], output \"probabilities\" [batch, 2, rows, columns] "
      "before masking. Exit codes: 0 done; 1 failed; 2 wrong usage.",
      "conav export");
  std::filesystem::path weights;
  std::filesystem::path onnx;
  app.add_option("--weights", weights, "Weights file of conav train")->required();
  app.add_option("--onnx", onnx, "File to write")->required();
  if (const auto ended = conav::Parse(app, argc, argv)) return *ended;
  return conav::nhpm::Export(weights, onnx);
}
