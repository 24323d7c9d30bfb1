#pragma once

#include <nlohmann/json_fwd.hpp>

#include "nhpm/evaluation/report.h"

namespace conav::nhpm {

/// The report for machines:
///
///   schema    1
///   data      file, sha256, origin, split_seed (null: all is test), rows, columns
///             (null: maps of several sizes),
///             train and test: {trajectories, segments, edits}
///   models    by key (nhpm, glpf_train, glpf_test, oracle, ...): title, about, version, checksum,
///             mbce_all, mbce_unmasked, train_mbce_all, train_mbce_unmasked, iou_best,
///             iou_best_boundary, iou_best_boundary_from, iou_fixed, iou_fixed_boundary,
///             segment_iou_best, segment_iou_fixed, ece, reliability [...],
///             expected_edits_mean, true_edits_mean, edits_correlation, edits_bins [...]
///   bars      by key: value, limit, at_most, passed, low, high
///   figures   [{segment, reason}]
///
/// A figure that does not apply is null; an infinite one too.
nlohmann::ordered_json ReportJson(const EvaluationReport& report);

}  // namespace conav::nhpm
