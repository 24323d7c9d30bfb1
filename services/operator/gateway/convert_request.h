#pragma once

#include "common/msg/supervision.h"
#include "common/runtime/result.h"
#include "console.pb.h"
#include "operator/gateway/page_feed.h"

namespace conav::operators {

/// What a page asks, as every other client of the operator service asks it: the page has no door of
/// its own, and the same checks apply (common/protocol/convert.h).
/// Errors: kMalformed, kRefused name the field, the value and the limit.
[[nodiscard]] Result<OperatorRequest> ToOperatorRequest(const console::Request& request,
                                                        const std::string& client, SimTime now);

/// Why a page in this role, with this connection, may not ask that now; empty = it may. `wall_s`: s
/// since 1970, as in `valid_until`. `drive_limit_s`: the longest round trip for driving.
std::string CheckNow(const PageIdentity& who, const PageAsked& asked, double wall_s,
                     double drive_limit_s);

}  // namespace conav::operators
