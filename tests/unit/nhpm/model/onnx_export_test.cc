#include "nhpm/model/onnx_export.h"

#include <sys/wait.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <opencv2/dnn.hpp>

#include "common/runtime/file.h"
#include "common/runtime/random.h"
#include "nhpm/engine/training_pass.h"
#include "support/temporary_folder.h"

namespace conav::nhpm {
namespace {

NetworkModel ModelOf(int width, int rows, int columns) {
  NetworkModel model;
  model.version = "of a test";
  model.weights = InitialWeights({width}, 5, -0.5F);
  for (auto& biases : model.weights.biases) {
    for (std::size_t i = 0; i < biases.size(); ++i) biases[i] += 0.01F * static_cast<float>(i);
  }
  model.rows = rows;
  model.columns = columns;
  return model;
}

std::vector<float> RandomInput(std::size_t size, Random& random) {
  std::vector<float> input(size);
  for (float& value : input) value = static_cast<float>(random.Unit());
  return input;
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

TEST_CASE("OpenCV reads the exported network and answers as ours does", "[nhpm][model][onnx]") {
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
    const auto input =
        RandomInput(static_cast<std::size_t>(rows * columns) * kInputChannels, random);
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

TEST_CASE("A network for any size is exported with open sizes", "[nhpm][model][onnx]") {
  const std::string any = ToOnnx(ModelOf(16, 0, 0));
  const std::string one = ToOnnx(ModelOf(16, 13, 13));
  CHECK(any.find("rows") != std::string::npos);
  CHECK(one.find("rows") == std::string::npos);
}

TEST_CASE("The export says which weights it was made of", "[nhpm][model][onnx]") {
  const NetworkModel model = ModelOf(16, 13, 13);
  CHECK(ToOnnx(model).find(ChecksumOf(model)) != std::string::npos);
  CHECK(ToOnnx(model).find("nearness = 1 - depth / 10") != std::string::npos);
  CHECK(ToOnnx(model) == ToOnnx(model));
}

int RunExport(const std::string& flags) {
  return WEXITSTATUS(
      std::system((CONAV_BIN_DIR "/conav-export " + flags + " >/dev/null 2>&1").c_str()));
}

TEST_CASE("conav-export writes ONNX of a weights file, or says that it cannot",
          "[nhpm][model][onnx]") {
  const test::TemporaryFolder temporary;
  const std::string folder = temporary.path().string();
  const NetworkModel model = ModelOf(16, 13, 13);
  REQUIRE(WriteWeightsFile(folder + "/w", model));
  CHECK(RunExport("--weights " + folder + "/w --onnx " + folder + "/o") == 0);
  CHECK((ReadFile(folder + "/o").value() == ToOnnx(model)));
  CHECK(RunExport("--weights " + folder + "/missing --onnx " + folder + "/o") == 1);
  CHECK(RunExport("--weights " + folder + "/o --onnx " + folder + "/p") == 1);
  CHECK(RunExport("--weights " + folder + "/w --onnx /nonexistent/o") == 2);
  CHECK(RunExport("--weights " + folder + "/w") == 2);
}

}  // namespace
}  // namespace conav::nhpm
