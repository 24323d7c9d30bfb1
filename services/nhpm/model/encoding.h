#pragma once

#include <limits>
#include <span>
#include <string>
#include <utility>

#include "common/msg/planning.h"
#include "nhpm/engine/network_weights.h"

/// The network's inputs and outputs: from a query to float channels, from logits to probabilities.
namespace conav::nhpm {

/// Which inputs the network sees, for ablations. The output masks always use x.
struct InputSelection {
  bool belief = true;  // channel 0
  bool path = true;    // channel 1
  bool view = true;    // channels 2 and 3
  bool depth = true;   // they have the picture's depth; else they are plain masks, 0 or 1
  bool operator==(const InputSelection&) const = default;
};

/// The depth at which a seen cell counts least, in cells of the query's grid: of a maze, and of a
/// raster whose maze cells are about 10 pixels wide.
inline constexpr double kMazeDepthRange = 10.0;
inline constexpr double kRasterDepthRange = 100.0;

/// How near a seen cell is: 1 at the camera, falling with the depth along the view axis to 0.2.
class NearnessInView {
 public:
  NearnessInView(Cell camera, double heading_rad, double depth_range);

  float Of(Cell cell) const;

 private:
  Cell camera_;
  double east_;
  double north_;
  double depth_range_;
};

/// Writes the network's input, shape [rows][columns][kInputChannels], values in [0, 1]:
///
///   0 x_wall    P(wall) of the belief
///   1 tau_path  1 on each cell of the path, and on the camera's cell
///   2 o_free    nearness where the view shows a free cell, else 0
///   3 o_wall    nearness where the view shows a wall, else 0
///
/// nearness = 1 - depth / depth_range, in [0.2, 1], or 1 without InputSelection::depth; the depth of a cell is its distance from the
/// camera's cell along the view axis. So the masks contain the picture's depth. The shape of the
/// seen area alone does not give the view direction, along which people misjudge walls (a corridor
/// looks the same at two headings), nor, with a receptive field of 9 x 9, the distance to the
/// camera. The masks turn and mirror with the map.
///
/// `input` has rows * columns * kInputChannels values. The query passed CheckPerceptionQuery.
/// Source: paper section 4 and figure 2; the order is fixed so that weights files are portable.
void EncodeInput(const PerceptionQuery& query, const InputSelection& selection,
                 std::span<float> input, double depth_range = kMazeDepthRange);

/// Calls `set(cell, channel, value)` for all of the input that is not 0 besides x_wall. `shown` is a
/// PerceptionQuery or a ShownView.
template <class Shown, class Set>
void EncodeShown(const Shown& shown, const InputSelection& selection, double depth_range,
                 Set&& set) {
  if (selection.path) {
    for (const Cell cell : shown.path) set(cell, 1, 1.0F);
    set(shown.cell, 1, 1.0F);
  }
  if (selection.view) {
    const NearnessInView nearness(
        shown.cell, shown.heading_rad,
        selection.depth ? depth_range : std::numeric_limits<double>::infinity());
    for (const Cell cell : shown.visible.free) set(cell, 2, nearness.Of(cell));
    for (const Cell cell : shown.visible.walls) set(cell, 3, nearness.Of(cell));
  }
}

/// Of one cell that is not on the border: add, remove (MaskedAnswer).
std::pair<float, float> MaskedEdits(float wall_probability, const float* logits);

/// Probabilities from the network's logits, shape [rows][columns][kOutputChannels] with add first,
/// remove second:
///
///   add = sigmoid(logit) (1 - x)     remove = sigmoid(logit) x     both 0 on the border
///
/// The sigmoid is our own, of plain float operations: the same bits on every machine. Logits must
/// not be NaN: PerceptionNetwork returns an error for those.
PerceptionAnswer MaskedAnswer(const BeliefGrid& belief, std::span<const float> logits);

bool AreFinite(std::span<const float> logits);

/// 1 / (1 + exp(-logit)), within 3 units in the last place, in [0, 1], also for NaN.
float Sigmoid(float logit);

/// The flag of an input by the paper's letter: "x" the map, "tau" the path, "o" the view (demanded).
bool& InputOf(InputSelection& inputs, const std::string& name);

/// "x,tau,o" without the inputs left out, "nothing" if all are; with ",mask" for plain masks.
std::string SeenInputs(const InputSelection& inputs);

/// The inputs left out, in the same form; empty if there are none.
std::string MissingInputs(const InputSelection& inputs);

}  // namespace conav::nhpm
