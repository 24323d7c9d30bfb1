#pragma once

#include <string>
#include <vector>

#include "common/protocol/supervision.h"
#include "operator/attention/attention_options.h"

/// In which order matters are put before the operator.
///
///   priority          the tier first, then the c-mu index: value lost per second over the expected
///                     interaction time. In a queue with linear waiting costs and one server, this
///                     order has the least expected cost (D. R. Cox and W. L. Smith, "Queues", 1961,
///                     section 3.3). Robots that stop asking while they wait make the source finite,
///                     for which it is a heuristic.
///   fifo              in the order asked.
///   nearest_deadline  what gives up first comes first (Jackson's rule, 1955). Questions that wait
///                     for ever have a deadline default_deadline_s after they were asked; notices
///                     come last. Where a robot waits by the wall clock, its seconds are taken for
///                     those of the operator's time.
namespace conav::operators {

/// The names above.
const std::vector<std::string>& AttentionOrders();

/// 1 = first: the robot stands for want of a command that works; 2 link lost; 3 blocked or without
/// a path, and asking; 4 a picture, which shows where the maps differ; 5 for information.
std::uint8_t TierOf(AttentionReason reason);
/// Whether the robot itself waits for an answer.
bool IsQuestion(AttentionReason reason);

/// Whether `a` comes before `b`; ties go to the older one, then to the name. `options.order` is one
/// of AttentionOrders().
bool ComesBefore(const AttentionItem& a, const AttentionItem& b, const AttentionOptions& options);

/// Sorts by ComesBefore.
void SortItems(std::vector<AttentionItem>& items, const AttentionOptions& options);

}  // namespace conav::operators
