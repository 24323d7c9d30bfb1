#include <fmt/core.h>

#include <bit>

#include "nhpm/model/weights_file.h"
#include "onnx_subset.pb.h"

namespace conav::nhpm {
namespace {

static_assert(std::endian::native == std::endian::little, "raw_data is little-endian");

constexpr int kIrVersion = 8;
constexpr int kOperatorSet = 13;
constexpr int kFloat = 1;         // TensorProto.DataType
constexpr int kIntAttribute = 2;  // AttributeProto.AttributeType
constexpr int kIntsAttribute = 7;
constexpr const char* kInputName = "input";
constexpr const char* kOutputName = "probabilities";

void AddDimension(onnx::Shape& shape, int size, const char* open_name) {
  if (size > 0) {
    shape.add_dim()->set_dim_value(size);
  } else {
    shape.add_dim()->set_dim_param(open_name);
  }
}

void SetValue(onnx::Value& value, const char* name, int channels, const NetworkModel& model) {
  value.set_name(name);
  onnx::TensorType& type = *value.mutable_type()->mutable_tensor_type();
  type.set_elem_type(kFloat);
  onnx::Shape& shape = *type.mutable_shape();
  AddDimension(shape, 0, "batch");
  AddDimension(shape, channels, "channels");
  AddDimension(shape, model.rows, "rows");
  AddDimension(shape, model.columns, "columns");
}

void AddTensor(onnx::Graph& graph, const std::string& name, const std::vector<int>& dims,
               const std::vector<float>& values) {
  onnx::Tensor& tensor = *graph.add_initializer();
  tensor.set_name(name);
  tensor.set_data_type(kFloat);
  for (const int dim : dims) tensor.add_dims(dim);
  tensor.set_raw_data(values.data(), values.size() * sizeof(float));
}

/// From [ky][kx][inputs][outputs] to ONNX's [outputs][inputs][ky][kx].
std::vector<float> OutputsFirst(const std::vector<float>& weights, std::size_t inputs,
                                std::size_t outputs) {
  std::vector<float> result;
  result.reserve(weights.size());
  for (std::size_t o = 0; o < outputs; ++o) {
    for (std::size_t i = 0; i < inputs; ++i) {
      for (std::size_t tap = 0; tap < 9; ++tap) {
        result.push_back(weights[(tap * inputs + i) * outputs + o]);
      }
    }
  }
  return result;
}

void AddInts(onnx::Node& node, const char* name, std::initializer_list<int> values) {
  onnx::Attribute& attribute = *node.add_attribute();
  attribute.set_name(name);
  attribute.set_type(kIntsAttribute);
  for (const int value : values) attribute.add_ints(value);
}

onnx::Node& AddNode(onnx::Graph& graph, const char* operation, const std::string& name,
                    const std::vector<std::string>& inputs, const std::string& output) {
  onnx::Node& node = *graph.add_node();
  node.set_op_type(operation);
  node.set_name(name);
  for (const std::string& input : inputs) node.add_input(input);
  node.add_output(output);
  return node;
}

/// Adds a convolution of the value `input`; returns the name of its output.
std::string AddConvolution(onnx::Graph& graph, const NetworkWeights& weights, int layer,
                           const std::string& input) {
  const auto i = static_cast<std::size_t>(layer);
  const int inputs = weights.shape.InputsOf(layer);
  const int outputs = weights.shape.OutputsOf(layer);
  const std::string name = fmt::format("convolution{}", layer + 1);
  AddTensor(graph, name + ".weights", {outputs, inputs, 3, 3},
            OutputsFirst(weights.weights[i], static_cast<std::size_t>(inputs),
                         static_cast<std::size_t>(outputs)));
  AddTensor(graph, name + ".biases", {outputs}, weights.biases[i]);
  const std::string output = name + ".output";
  onnx::Node& node =
      AddNode(graph, "Conv", name, {input, name + ".weights", name + ".biases"}, output);
  AddInts(node, "dilations", {1, 1});
  AddInts(node, "kernel_shape", {3, 3});
  AddInts(node, "pads", {1, 1, 1, 1});
  AddInts(node, "strides", {1, 1});
  onnx::Attribute& group = *node.add_attribute();
  group.set_name("group");
  group.set_type(kIntAttribute);
  group.set_i(1);
  return output;
}

void AddMetadata(onnx::Model& message, const NetworkModel& model) {
  const auto add = [&](const char* key, const std::string& value) {
    onnx::NamedText& entry = *message.add_metadata_props();
    entry.set_key(key);
    entry.set_value(value);
  };
  add("name", model.name);
  add("version", model.version);
  add("checksum", ChecksumOf(model));
  add("data_origin", model.data_origin);
  add("sees_belief", model.inputs.belief ? "yes" : "no");
  add("sees_path", model.inputs.path ? "yes" : "no");
  add("sees_view", !model.inputs.view ? "no" : model.inputs.depth ? "yes" : "mask");
}

}  // namespace

std::string ToOnnx(const NetworkModel& model) {
  onnx::Model message;
  message.set_ir_version(kIrVersion);
  message.add_opset_import()->set_version(kOperatorSet);
  message.set_producer_name("conav");
  message.set_doc_string(
      "How a person edits the map after a picture. Channels in: x = P(wall) of the map; 1 on the "
      "path and on the camera's cell; nearness of the cells that the picture shows free; nearness "
      "of the walls that it shows; else 0. nearness = 1 - depth / 10, in [0.2, 1], rounded to "
      "1/1024; depth = distance from the camera's cell along the view axis, in cells. Channels "
      "out: P(add a wall), P(remove one), before masking: multiply add by 1 - x, remove by x, both "
      "by 0 on the border.");
  AddMetadata(message, model);
  onnx::Graph& graph = *message.mutable_graph();
  graph.set_name("nhpm");
  SetValue(*graph.add_input(), kInputName, kInputChannels, model);
  SetValue(*graph.add_output(), kOutputName, kOutputChannels, model);
  std::string value = kInputName;
  for (int layer = 0; layer < kNetworkLayers; ++layer) {
    value = AddConvolution(graph, model.weights, layer, value);
    if (layer == kNetworkLayers - 1) break;
    const std::string name = fmt::format("relu{}", layer + 1);
    AddNode(graph, "Relu", name, {value}, name + ".output");
    value = name + ".output";
  }
  AddNode(graph, "Sigmoid", "sigmoid", {value}, kOutputName);
  return BytesOf(message);
}

}  // namespace conav::nhpm
