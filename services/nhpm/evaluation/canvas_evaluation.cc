#include "nhpm/evaluation/canvas_evaluation.h"

#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "common/runtime/random.h"
#include "nhpm/model/canvas_placement.h"

namespace conav::nhpm {
namespace {

constexpr std::uint64_t kPlacements = 4;  // purpose of a seed

CanvasMap PastedMap(const Segment& segment, std::size_t index) {
  const BeliefGrid& belief = segment.query.belief;
  Random random(DeriveSeed(kPlacements, index));
  return {DrawPlacement(kPaperCanvas, belief.rows(), belief.columns(), segment.query.cell, random),
          belief.rows(), belief.columns()};
}

/// Adds the outcomes of the pixels that can be edited. `probability_at` takes whether the map has a
/// wall there, the maze's cell and the pixel.
template <class ProbabilityAt>
Result<void> AppendPixels(const Segment& segment, const CanvasMap& map,
                          ProbabilityAt probability_at, Outcomes& outcomes) {
  const BeliefGrid& before = segment.query.belief;
  const Grid<std::uint8_t> canvas(kPaperCanvas, kPaperCanvas);
  for (std::size_t pixel = 0; pixel < canvas.size(); ++pixel) {
    if (map.sources()[pixel] < 0 || canvas.OnBorder(canvas.CellAt(pixel))) continue;
    const auto cell = static_cast<std::size_t>(map.sources()[pixel]);
    if (before.OnBorder(before.CellAt(cell))) continue;
    const bool wall = before.values()[cell] >= 0.5F;
    const float probability = probability_at(wall, cell, pixel);
    if (!(probability >= 0.0F && probability <= 1.0F)) {
      return Fail(ErrorCode::kInvalidArgument, fmt::format("probability {} at {} is not in [0, 1]",
                                                           probability, canvas.CellAt(pixel)));
    }
    outcomes.values.push_back({probability, wall != (segment.belief_after.values()[cell] >= 0.5F)});
  }
  outcomes.segment_ends.push_back(outcomes.values.size());
  outcomes.outputs += 2 * canvas.size();
  return {};
}

/// The metrics of answers to the test segments, which are of the maze or, pasted, of the canvas.
template <class AppendSegment>
Result<ModelMetrics> MeasureAll(const EvaluationData& data, AppendSegment append) {
  Outcomes outcomes;
  const std::vector<const Segment*> segments = AllSegments(data.test);
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const auto appended = append(i, *segments[i], PastedMap(*segments[i], i), outcomes);
    if (!appended) return tl::unexpected(appended.error());
  }
  return Measure(outcomes);
}

Result<ModelMetrics> MeasureScaled(const EvaluationData& data,
                                   const std::vector<PerceptionAnswer>& answers) {
  return MeasureAll(
      data, [&](std::size_t i, const Segment& segment, const CanvasMap& map, Outcomes& outcomes) {
        const auto at = [&](bool wall, std::size_t cell, std::size_t) {
          return (wall ? answers[i].remove : answers[i].add).values()[cell];
        };
        return AppendPixels(segment, map, at, outcomes);
      });
}

Result<ModelMetrics> MeasureModel(const EvaluationData& data, PerceptionModel& model) {
  return MeasureAll(data,
                    [&](std::size_t, const Segment& segment, const CanvasMap& map,
                        Outcomes& outcomes) -> Result<void> {
                      const PerceptionQuery query = map.Paste(segment.query);
                      const auto answers = model.Predict({&query, 1});
                      if (!answers) return tl::unexpected(answers.error());
                      const PerceptionAnswer& answer = answers->front();
                      const auto at = [&](bool wall, std::size_t, std::size_t pixel) {
                        return (wall ? answer.remove : answer.add).values()[pixel];
                      };
                      return AppendPixels(segment, map, at, outcomes);
                    });
}

/// Share of the editable cells of the train part that were edited.
double EditedShare(const SegmentSet& set) {
  double edited = 0.0;
  double open = 0.0;
  for (const Segment* segment : AllSegments(set)) {
    const BeliefGrid& belief = segment->query.belief;
    edited += EditCount(*segment);
    open += static_cast<double>(std::max(belief.rows() - 2, 0) * std::max(belief.columns() - 2, 0));
  }
  return open > 0.0 ? edited / open : 0.0;
}

Result<ModelMetrics> MeasureConstant(const EvaluationData& data, float share) {
  return MeasureAll(
      data, [&](std::size_t, const Segment& segment, const CanvasMap& map, Outcomes& outcomes) {
        return AppendPixels(
            segment, map, [&](bool, std::size_t, std::size_t) { return share; }, outcomes);
      });
}

}  // namespace

Result<std::vector<CanvasRow>> EvaluateOnCanvas(const EvaluationData& data,
                                                const std::vector<ModelRow>& mazes,
                                                PerceptionModel& model) {
  std::vector<CanvasRow> rows;
  const auto add = [&](const RowLabel& label, const ModelIdentity& identity,
                       const Result<ModelMetrics>& metrics) -> Result<void> {
    if (!metrics) {
      return Fail(metrics.error().code, fmt::format("{}: {}", label.title, metrics.error().text));
    }
    rows.push_back({label, identity, *metrics});
    return {};
  };
  Result<void> added;
  if (!data.train.trajectories.empty()) {
    const double share = EditedShare(data.train);
    added = add({"constant", "Constant", fmt::format("{:.4g} everywhere", share)}, {},
                MeasureConstant(data, static_cast<float>(share)));
  }
  for (const ModelRow& row : mazes) {
    RowLabel label = row.label;
    label.title += ", scaled";
    added =
        added.and_then([&] { return add(label, row.identity, MeasureScaled(data, row.answers)); });
  }
  added = added.and_then([&] {
    return add({"encoder_decoder", "Encoder-decoder", model.identity().version}, model.identity(),
               MeasureModel(data, model));
  });
  if (!added) return tl::unexpected(added.error());
  return rows;
}

std::string CanvasTable(const std::vector<CanvasRow>& rows) {
  constexpr int kTitle = 22;
  std::string text = fmt::format(
      "pasted on canvases of {0} x {0} pixels; edits in pixels\n\n{1:<{2}}"
      "{3:>10}{4:>10}{5:>16}{6:>11}{7:>9}{8:>10}{9:>9}{10:>9}\n",
      kPaperCanvas, "model", kTitle, "MBCE test", "unmasked", "IoU @ best", "IoU @ 0.5", "ECE",
      "expected", "edits", "correl.");
  for (const auto& [label, identity, test] : rows) {
    text += fmt::format(
        "{:<{}}{:>10.5f}{:>10.5f}{:>9.3f} @ {:.2f}{:>11.3f}{:>9.4f}{:>10.1f}{:>9.1f}{:>9}\n",
        label.title, kTitle, test.loss.all, test.loss.unmasked, test.best.iou, test.best.boundary,
        test.iou_fixed, test.calibration.error, test.edits.mean_expected, test.edits.mean_true,
        test.edits.correlation ? fmt::format("{:.2f}", *test.edits.correlation) : "-");
  }
  text += '\n';
  for (const CanvasRow& row : rows) {
    text += fmt::format("{:<{}}{}\n", row.label.title, kTitle, row.label.about);
  }
  return text;
}

nlohmann::ordered_json CanvasJson(const EvaluationData& data, const std::vector<CanvasRow>& rows) {
  nlohmann::ordered_json models;
  for (const auto& [label, identity, test] : rows) {
    nlohmann::ordered_json& model = models[label.key];
    model = {{"title", label.title},
             {"about", label.about},
             {"version", identity.version},
             {"checksum", identity.checksum},
             {"mbce_all", test.loss.all},
             {"mbce_unmasked", test.loss.unmasked},
             {"iou_best", test.best.iou},
             {"iou_best_boundary", test.best.boundary},
             {"iou_fixed", test.iou_fixed},
             {"ece", test.calibration.error},
             {"expected_edits_mean", test.edits.mean_expected},
             {"true_edits_mean", test.edits.mean_true},
             {"edits_correlation", nullptr}};
    if (test.edits.correlation) model["edits_correlation"] = *test.edits.correlation;
  }
  return {{"data",
           {{"origin", OriginText(data.test)},
            {"file", data.file},
            {"sha256", data.checksum},
            {"test_segments", SegmentCount(data.test)}}},
          {"models", models}};
}

}  // namespace conav::nhpm
