#pragma once

#include <filesystem>
#include <string>

#include "common/runtime/result.h"
#include "nhpm/model/weights_file.h"

// One user: main; OpenCV reads what it writes in a test.

namespace conav::nhpm {

/// The network as an ONNX model: 3x3 convolutions, ReLU between them, a sigmoid at the end.
///
///   input          "input"          float [batch, kInputChannels, rows, columns], as EncodeInput
///                                   has it, but channels before rows; channels 2 and 3 hold
///                                   nearness, 1 - depth / 10 cells in [0.2, 1], not 0 or 1
///   output         "probabilities"  float [batch, kOutputChannels, rows, columns]: add, remove
///
/// The model does not contain the masks: its user multiplies add by (1 - x), remove by x, and both
/// by 0 on the border. Rows and columns are open if the network fits any size; the batch always is.
/// The model's metadata has name, version, checksum, origin of the data and inputs.
std::string ToOnnx(const NetworkModel& model);

/// Errors: kIo with path and cause.
[[nodiscard]] Result<void> WriteOnnxFile(const std::filesystem::path& path,
                                         const NetworkModel& model);

}  // namespace conav::nhpm
