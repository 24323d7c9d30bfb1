#include <catch2/catch.hpp>
#include <opencv2/dnn.hpp>

#include "common/runtime/file.h"
#include "common/runtime/random.h"
#include "nhpm/engine/training_pass.h"
#include "support/program_runner.h"
#include "support/test_weights.h"

namespace conav::nhpm {
namespace {

NetworkModel ModelOf(int width, int rows, int columns) {
  NetworkModel model = test::UntrainedNetwork(5, rows, columns, width);
  for (auto& biases : model.weights.biases) {
    for (std::size_t i = 0; i < biases.size(); ++i) biases[i] += 0.01F * static_cast<float>(i);
  }
  return model;
}

/// What OpenCV's DNN module says, shape [rows][columns][kOutputChannels].
std::vector<float> AskOpenCv(cv::dnn::Net& net, const std::vector<float>& input, int rows,
                             int columns) {
  const std::vector<int> shape{1, kInputChannels, rows, columns};
  cv::Mat blob(shape, CV_32F);
  const std::size_t cells = static_cast<std::size_t>(rows * columns);
  auto* values = blob.ptr<float>();
  for (std::size_t cell = 0; cell < cells; ++cell) {
    for (std::size_t c = 0; c < kInputChannels; ++c) {
      values[c * cells + cell] = input[cell * kInputChannels + c];
    }
  }
  net.setInput(blob);
  const cv::Mat output = net.forward();
  REQUIRE(output.total() == cells * kOutputChannels);
  std::vector<float> result(output.total());
  for (std::size_t cell = 0; cell < cells; ++cell) {
    for (std::size_t c = 0; c < kOutputChannels; ++c) {
      result[cell * kOutputChannels + c] = output.ptr<float>()[c * cells + cell];
    }
  }
  return result;
}

TEST_CASE("OpenCV reads the exported network and answers as ours does", "[onnx]") {
  const int width = GENERATE(16, 32, 64);
  const auto [rows, columns] = GENERATE(table<int, int>({{13, 13}, {5, 8}}));
  const bool any_size = GENERATE(false, true);
  const NetworkModel model = ModelOf(width, any_size ? 0 : rows, any_size ? 0 : columns);
  const std::string bytes = ToOnnx(model);
  cv::dnn::Net net = cv::dnn::readNetFromONNX(bytes.data(), bytes.size());
  net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
  const TrainingWeights weights(model.weights);
  TrainingPass pass(model.weights.shape, rows, columns);
  Random random(9);
  for (int sample = 0; sample < 5; ++sample) {
    std::vector<float> input(static_cast<std::size_t>(rows * columns) * kInputChannels);
    for (float& value : input) value = static_cast<float>(random.Unit());
    const auto logits = pass.Forward(weights, input);
    const std::vector<float> theirs = AskOpenCv(net, input, rows, columns);
    float difference = 0.0F;
    float lowest = 1.0F;
    float highest = 0.0F;
    for (std::size_t i = 0; i < theirs.size(); ++i) {
      difference = std::max(difference, std::abs(theirs[i] - Sigmoid(logits[i])));
      lowest = std::min(lowest, theirs[i]);
      highest = std::max(highest, theirs[i]);
    }
    CHECK(difference < 1e-6F);
    CHECK(highest - lowest > 0.05F);  // the outputs say something
  }
}

TEST_CASE("The export names the weights that it was made of, and has open sizes for any size",
          "[onnx]") {
  const NetworkModel model = ModelOf(16, 13, 13);
  CHECK(ToOnnx(model).find("rows") == std::string::npos);
  CHECK(ToOnnx(ModelOf(16, 0, 0)).find("rows") != std::string::npos);
  CHECK(ToOnnx(model).find(ChecksumOf(model)) != std::string::npos);
  CHECK(ToOnnx(model).find("nearness = 1 - depth / 10") != std::string::npos);
  CHECK(ToOnnx(model) == ToOnnx(model));
}

TEST_CASE("conav-export writes ONNX of a weights file, and not over it", "[onnx]") {
  const test::ProgramRunner program("conav-export");
  const NetworkModel model = ModelOf(16, 13, 13);
  REQUIRE(WriteWeightsFile(program / "w", model));
  CHECK(program.Run("--weights w --onnx o").exit_code == 0);
  CHECK((ReadFile(program / "o").value() == ToOnnx(model)));
  CHECK(program.Run("--weights o --onnx p").exit_code == 1);
  CHECK(program.Run("--weights w --onnx w").exit_code == 2);
  REQUIRE(WriteWeightsFile(program / "rasters", test::UntrainedEncoderDecoder(1)));
  CHECK(program.Run("--weights rasters --onnx q").exit_code == 1);
  CHECK(ReadWeightsFile(program / "w"));
}

}  // namespace
}  // namespace conav::nhpm
